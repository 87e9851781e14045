// SPDX-License-Identifier: BSD-3-Clause
// Roadmaps in files.
#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "certificate/sha256.h"
#include "files/files.h"
#include "hdf5/hdf5.h"
#include "roadmap/roadmap.h"
#include "text/xml.h"

namespace fcl_artic::app {
namespace {

constexpr const char* kRoadmapFormat = "fcl-artic-roadmap/1";

bool isValid(const Roadmap& roadmap, std::size_t edge) {
  return roadmap.answers.size() == 0 || roadmap.answers.status[edge] == static_cast<std::int8_t>(RowStatus::free);
}

/// Edges that are written, by number.
std::vector<std::size_t> writtenEdges(const Roadmap& roadmap, bool valid_only) {
  std::vector<std::size_t> edges;
  for (std::size_t e = 0; e < roadmap.numEdges(); ++e) {
    if (!valid_only || isValid(roadmap, e)) edges.push_back(e);
  }
  return edges;
}

/// A word of a line of comma separated values (RFC 4180).
std::string csvText(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// GraphML: vertices have a number for each joint, edges `weight`, and where they were asked `status`, `t_lower`,
/// `t_upper`, `certain` and `bodies`.
std::string graphml(const Roadmap& roadmap, const std::vector<std::size_t>& edges) {
  const bool asked = roadmap.answers.size() > 0;
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\" "
      "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://graphml.graphdrawing.org/xmlns "
      "http://graphml.graphdrawing.org/xmlns/1.0/graphml.xsd\">\n";
  const auto key = [&](const std::string& id, const char* of, const std::string& name, const char* type) {
    out += fmt::format("<key id=\"{}\" for=\"{}\" attr.name=\"{}\" attr.type=\"{}\"/>\n", id, of, text::xmlText(name),
                       type);
  };
  for (std::size_t j = 0; j < roadmap.joints.size(); ++j)
    key(fmt::format("q{}", j), "node", roadmap.joints[j], "double");
  key("w", "edge", "weight", "double");
  if (asked) {
    key("s", "edge", "status", "string");
    key("l", "edge", "t_lower", "double");
    key("u", "edge", "t_upper", "double");
    key("c", "edge", "certain", "int");
    key("b", "edge", "bodies", "string");
  }
  out += "<graph id=\"roadmap\" edgedefault=\"undirected\">\n";
  for (std::size_t i = 0; i < roadmap.numVertices(); ++i) {
    out += fmt::format("<node id=\"n{}\">", i);
    for (std::size_t j = 0; j < roadmap.joints.size(); ++j) {
      out += fmt::format("<data key=\"q{}\">{}</data>", j, roadmap.configurations[i * roadmap.joints.size() + j]);
    }
    out += "</node>\n";
  }
  for (const std::size_t e : edges) {
    out += fmt::format("<edge id=\"e{}\" source=\"n{}\" target=\"n{}\"><data key=\"w\">{}</data>", e,
                       roadmap.edges[2 * e], roadmap.edges[2 * e + 1], roadmap.length(e));
    if (asked) {
      const Columns& a = roadmap.answers;
      out += fmt::format(
          "<data key=\"s\">{}</data><data key=\"l\">{}</data><data key=\"u\">{}</data><data key=\"c\">{}</data>",
          toString(static_cast<RowStatus>(a.status[e])), a.t_lower[e], a.t_upper[e], static_cast<int>(a.certain[e]));
      out += fmt::format("<data key=\"b\">{}</data>", text::xmlText(roadmap.bodies[e]));
    }
    out += "</edge>\n";
  }
  return out + "</graph>\n</graphml>\n";
}

/// @param vertices  content of the file beside it.
std::string edgesCsv(const Roadmap& roadmap, const std::vector<std::size_t>& edges, const std::string& vertices) {
  const bool asked = roadmap.answers.size() > 0;
  const std::string hash = certificate::sha256Text(vertices);
  std::string out = "source,target,weight";
  if (asked) out += ",status,t_lower,t_upper,certain,bodies";
  out += ",vertices_sha256\n";
  for (const std::size_t e : edges) {
    out += fmt::format("{},{},{}", roadmap.edges[2 * e], roadmap.edges[2 * e + 1], roadmap.length(e));
    if (asked) {
      const Columns& a = roadmap.answers;
      out += fmt::format(",{},{},{},{},{}", toString(static_cast<RowStatus>(a.status[e])), a.t_lower[e], a.t_upper[e],
                         static_cast<int>(a.certain[e]), csvText(roadmap.bodies[e]));
    }
    out += "," + hash + "\n";
  }
  return out;
}

std::string verticesCsv(const Roadmap& roadmap) {
  std::string out;
  for (std::size_t j = 0; j < roadmap.joints.size(); ++j) out += (j ? "," : "") + csvText(roadmap.joints[j]);
  out += "\n";
  for (std::size_t i = 0; i < roadmap.configurations.size(); ++i) {
    out += fmt::format("{}{}", roadmap.configurations[i], (i + 1) % roadmap.joints.size() ? "," : "\n");
  }
  return out;
}

/// A hash of the roadmap's edges, for which `self_margin` holds.
std::string edgesHash(const std::vector<double>& configurations, const std::vector<std::int64_t>& edges) {
  const auto hashOf = [](const auto& values) {
    return certificate::sha256Text({reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]});
  };
  return certificate::sha256Text(hashOf(configurations) + hashOf(edges));
}

std::string hdf5Bytes(const Roadmap& roadmap, const std::vector<std::size_t>& edges) {
  hdf5::Image image;
  image.add("configurations", {roadmap.numVertices(), roadmap.joints.size()}, roadmap.configurations.data());
  image.attribute("configurations", "joints", roadmap.joints);
  std::vector<std::int64_t> ends;
  for (const std::size_t e : edges) ends.insert(ends.end(), {roadmap.edges[2 * e], roadmap.edges[2 * e + 1]});
  image.add("edges", {edges.size(), 2}, ends.data());
  if (roadmap.answers.size() > 0) {
    forEachColumn(roadmap.answers, [&](const char* name, hdf5::Type, const auto& values) {
      auto written = values;
      for (std::size_t i = 0; i < edges.size(); ++i) written[i] = values[edges[i]];
      image.add(name, {edges.size()}, written.data());
    });
  }
  image.attribute("", "format", kRoadmapFormat);
  image.attribute("", "robot", roadmap.robot);
  image.attribute("", "self_margin", roadmap.self_proven ? fmt::format("{}", roadmap.self_margin) : "none");
  image.attribute("", "sha256", edgesHash(roadmap.configurations, ends));
  return image.bytes();
}

std::string roadmapEndingOf(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

}  // namespace

void requireRoadmapEnding(const std::string& path) {
  const std::string ending = roadmapEndingOf(path);
  if (ending == ".h5" || ending == ".hdf5" || ending == ".graphml" || ending == ".csv") return;
  throw std::invalid_argument(fmt::format("'{}': roadmaps are written as .h5, .graphml or .csv", path));
}

Roadmap readRoadmap(const std::string& path, const KinematicTree& tree) {
  const hdf5::File file(path);
  const auto fail = [&](const std::string& why) { throw std::invalid_argument(fmt::format("'{}': {}", path, why)); };
  const auto text = [&](const char* name) {
    const std::vector<std::string> values = file.strings("", name);
    return values.size() == 1 ? values[0] : std::string();
  };
  if (text("format") != kRoadmapFormat) fail("is no roadmap that `fcl_artic roadmap make` has written");
  Roadmap roadmap;
  roadmap.joints = file.strings("configurations", "joints");
  std::vector<std::string> known;
  for (int v = 0; v < tree.dof(); ++v) known.push_back(tree.variableName(v));
  if (roadmap.joints != known) fail(fmt::format("its joints are not those of robot '{}'", tree.name()));
  const std::vector<std::size_t> vertices = file.shape("configurations"), edges = file.shape("edges");
  if (vertices.size() != 2 || vertices[1] != known.size())
    fail("dataset 'configurations' has not a column for each joint");
  if (edges.size() != 2 || edges[1] != 2) fail("dataset 'edges' has not two columns");
  file.read("configurations", 0, vertices[0], roadmap.configurations);
  file.read("edges", 0, edges[0], roadmap.edges);
  for (const std::int64_t v : roadmap.edges) {
    if (v < 0 || static_cast<std::size_t>(v) >= vertices[0])
      fail(fmt::format("an edge ends at configuration {}, of {}", v, vertices[0]));
  }
  roadmap.robot = text("robot");
  const std::string margin = text("self_margin");
  roadmap.changed = text("sha256") != edgesHash(roadmap.configurations, roadmap.edges);
  roadmap.self_proven = !roadmap.changed && !margin.empty() && margin != "none";
  if (roadmap.self_proven) roadmap.self_margin = std::stod(margin);
  return roadmap;
}

std::string verticesFileOf(const std::string& path) {
  return roadmapEndingOf(path) == ".csv" ? std::filesystem::path(path).replace_extension(".vertices.csv").string() : "";
}

void writeRoadmap(const Roadmap& roadmap, const std::string& path, bool valid_only) {
  requireRoadmapEnding(path);
  const std::vector<std::size_t> edges = writtenEdges(roadmap, valid_only);
  const std::string ending = roadmapEndingOf(path);
  if (ending == ".graphml") {
    files::write(path, graphml(roadmap, edges));
  } else if (ending == ".csv") {
    const std::string vertices = verticesCsv(roadmap), rows = edgesCsv(roadmap, edges, vertices);
    files::writeTogether({{verticesFileOf(path), vertices}, {path, rows}});
  } else {
    files::write(path, hdf5Bytes(roadmap, edges));
  }
}

}  // namespace fcl_artic::app
