// SPDX-License-Identifier: BSD-3-Clause
//
// Roadmaps: configurations of a robot and straight motions between them, made once and certified again for each scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edges/columns.h"
#include "fcl_artic/manager.h"

namespace fcl_artic::app {

struct Roadmap {
  std::vector<std::string> joints;     ///< names of the columns of configurations: all of the robot's variables
  std::vector<double> configurations;  ///< rows, rad or m
  std::vector<std::int64_t> edges;     ///< two row numbers each, the lower one first
  std::string robot;                   ///< hash of robot and allowed pairs that it was made for
  double self_margin = 0;              ///< links are proven farther apart than this on all edges, m
  bool self_proven = false;            ///< they are
  bool changed = false;                ///< somebody has edited the file that it was read from

  Columns answers;                  ///< of each edge; none: nobody has asked
  std::vector<std::string> bodies;  ///< of each edge's first contact, "link, obstacle"; empty: there is none

  std::size_t numVertices() const { return configurations.size() / joints.size(); }
  std::size_t numEdges() const { return edges.size() / 2; }
  Eigen::VectorXd configuration(std::size_t i) const {
    const auto n = static_cast<Eigen::Index>(joints.size());
    return Eigen::VectorXd::Map(configurations.data() + i * joints.size(), n);
  }
  /// Length of an edge in joint space, rad and m alike.
  double length(std::size_t edge) const;
};

struct RoadmapOptions {
  std::size_t vertices = 1000, neighbours = 10;
  std::uint64_t seed = 1;
  std::vector<Eigen::VectorXd> given;  ///< configurations that are to be vertices, the first ones
  int threads = 0;
};

/// Draws configurations that are proven free, within the joints' limits, or within ±pi for joints that turn forever.
/// Joins each with its nearest ones, and leaves out edges that are not proven free.
/// @param manager  of the robot, and of what always stands around it.
/// @param request  must not ignore contact at the start: a vertex is to be free, and edges are gone along both ways.
/// @param[out] tried  edges that were asked.
/// @throws std::invalid_argument for joints that a roadmap has no distance for (planar, floating, spherical), lengths
///   without limits, a given configuration that is not proven free; std::runtime_error where hardly
///   any configuration is free.
Roadmap makeRoadmap(const ArticulatedCollisionManager& manager, const CertifiedRequest& request,
                    const RoadmapOptions& options, std::size_t& tried);

/// Asks all edges again.
/// @return whether there is a pair of bodies that was checked.
bool certifyRoadmap(const ArticulatedCollisionManager& manager, const CertifiedRequest& request, int threads,
                    Roadmap& roadmap);

/// Reads what writeRoadmap() has written as HDF5.
/// @throws std::runtime_error, std::invalid_argument naming file and dataset; a robot that has other variables.
Roadmap readRoadmap(const std::string& path, const KinematicTree& tree);

/// Writes it, as the ending says: .h5, .graphml, or .csv, a row for each edge, with PATH.vertices.csv beside it, whose
/// SHA-256 each row names.
/// @param valid_only  edges that are not proven free are left out.
/// @throws std::invalid_argument for another ending; std::runtime_error naming the file.
void writeRoadmap(const Roadmap& roadmap, const std::string& path, bool valid_only);
/// PATH.vertices.csv; empty where none is written.
std::string verticesFileOf(const std::string& path);
/// @throws std::invalid_argument unless writeRoadmap() knows the ending.
void requireRoadmapEnding(const std::string& path);

}  // namespace fcl_artic::app
