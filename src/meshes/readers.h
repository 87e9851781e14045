// SPDX-License-Identifier: BSD-3-Clause
// Readers of mesh files and of point clouds, one for each format. Each understands all of a file that could be geometry
// or its place, notes what has no surface (points, lines), and refuses by name what it does not understand. Decimals
// become the nearest doubles. All throw std::runtime_error naming the source.
#pragma once

#include <Eigen/Core>

#include <vector>

#include "meshes/source.h"
#include "meshes/triangle_soup.h"

namespace fcl_artic::meshes {

TriangleSoup readStl(const Source& source);
TriangleSoup readObj(const Source& source);
TriangleSoup readOff(const Source& source);
TriangleSoup readPly(const Source& source);
/// @param turn  whether what the file says is up (y, if it says nothing) becomes z; if not, and it is not z, a note
/// says so. The unit counts always.
TriangleSoup readCollada(const Source& source, bool turn);
/// glTF 2.0, as text or binary (.glb), with the buffers that it names.
/// @param turn  whether y, which is up in glTF, becomes z; if not, a note says so.
TriangleSoup readGltf(const Source& source, bool turn);

/// Coordinates are NaN or infinite where the file has them so.
using Points = std::vector<Eigen::Vector3d>;
/// ascii, binary, binary_compressed.
Points readPcd(const Source& source);
/// A point a line, each with as many columns, between blanks, commas or semicolons: the first three are read.
Points readXyz(const Source& source);
/// The vertices of a PLY file.
Points readPlyPoints(const Source& source);
/// Whether a PLY file has faces.
bool plyHasFaces(const Source& source);

}  // namespace fcl_artic::meshes
