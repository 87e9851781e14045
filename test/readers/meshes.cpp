// SPDX-License-Identifier: BSD-3-Clause
// Meshes and points, by the writers of test/meshes.
#include "harness.h"
#include "meshes/readers.h"

namespace fcl_artic::test {
namespace {

Item itemOf(const std::string& what, std::initializer_list<const double*> places) {
  Item item{what, {}};
  for (const double* x : places) {
    for (int k = 0; k < 3; ++k) item.numbers.push_back(x[k]);
  }
  return item;
}

bool isCloud(const std::string& format) {
  return format == "pcd" || format == "xyz" || format == "cloud.ply";
}

RandomFile write(const std::string& format, Random& random) {
  const WrittenFile written = writeRandomFile(format, random);
  RandomFile file{written.name, written.content, written.more, {}, written.tolerance, written.turn};
  for (const auto& t : written.triangles)
    file.reading.push_back(itemOf("triangle", {t[0].data(), t[1].data(), t[2].data()}));
  for (const auto& x : written.cloud) file.reading.push_back(itemOf("point", {x.data()}));
  if (!isCloud(format)) {
    file.reading.push_back({"left out", {static_cast<double>(written.points), static_cast<double>(written.lines)}});
  }
  return file;
}

Reading read(const std::string& format, const RandomFile& file, const std::string& path) {
  using namespace meshes;
  const Source source{path, file.content, file.name, nullptr};
  Reading out;
  if (isCloud(format)) {
    const Points points = format == "pcd" ? readPcd(source) : format == "xyz" ? readXyz(source) : readPlyPoints(source);
    for (const Eigen::Vector3d& x : points) out.push_back(itemOf("point", {x.data()}));
    return out;
  }
  const TriangleSoup soup = format == "stl"   ? readStl(source)
                            : format == "obj" ? readObj(source)
                            : format == "off" ? readOff(source)
                            : format == "ply" ? readPly(source)
                            : format == "dae" ? readCollada(source, file.turn)
                                              : readGltf(source, file.turn);
  const auto corner = [&](const fcl::Triangle& t, int k) { return soup.vertices.at(t[k]).data(); };
  for (const fcl::Triangle& t : soup.triangles)
    out.push_back(itemOf("triangle", {corner(t, 0), corner(t, 1), corner(t, 2)}));
  out.push_back({"left out", {static_cast<double>(soup.points), static_cast<double>(soup.lines)}});
  return out;
}

}  // namespace

void addMeshFormats(std::vector<FileFormat>& formats) {
  static const std::map<std::string, std::vector<std::pair<std::string, std::string>>> kFaults{
      {"stl", {{"skips a vertex", "vertex[^\n\r]*"}}},
      {"obj", {{"skips a face", "[\n\r]f [^\\\\\n\r]*"}, {"skips a vertex", "[\n\r][ \t]*v [^\n\r]*"}}},
      {"dae",
       {{"forgets a translation", "<translate>[^<]*</translate>"},
        {"forgets a rotation", "<rotate>[^<]*</rotate>"},
        {"forgets a scale", "<scale[^>]*>[^<]*</scale>"},
        {"forgets a matrix", "<matrix>[^<]*</matrix>"},
        {"skips an instance", "<instance_geometry[^>]*(/>|[^/]>.*?</instance_geometry>)"}}},
      {"gltf",
       {{"forgets a translation", ",\"translation\":\\[[^\\]]*\\]"},
        {"forgets a rotation", ",\"rotation\":\\[[^\\]]*\\]"},
        {"forgets a scale", ",\"scale\":\\[[^\\]]*\\]"},
        {"forgets a matrix", "\"matrix\":\\[[^\\]]*\\],"}}}};
  for (const std::string& format : writtenFormats()) {
    const auto faults = kFaults.find(format);
    formats.push_back({format, [format](Random& random) { return write(format, random); },
                       [format](const RandomFile& file, const std::string& path) { return read(format, file, path); },
                       faults == kFaults.end() ? FileFormat().faults : faults->second});
  }
}

}  // namespace fcl_artic::test
