// SPDX-License-Identifier: BSD-3-Clause
#include "writers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

namespace fcl_artic::test {
namespace {

/// A decimal number, and the double nearest to it by the C library.
struct Decimal {
  std::string text;
  double value;
};

Decimal decimalOf(double x, Random& random) {
  char text[64];
  const int digits = 1 + below(random, 19);
  std::snprintf(text, sizeof text, coin(random) ? "%.*g" : "%.*E", digits, x);
  std::string out = text;
  if (below(random, 4) == 0 && out.substr(0, 2) == "0.") out.erase(0, 1);
  if (below(random, 4) == 0 && out.substr(0, 3) == "-0.") out.erase(1, 1);
  if (below(random, 4) == 0 && out.find_first_of(".eE") == out.npos) out += '.';
  if (below(random, 8) == 0 && out[0] != '-') out = '+' + out;
  if (below(random, 60) == 0) out = coin(random) ? "1e-400" : "-4.9e-324";
  return {out, std::strtod(out.c_str(), nullptr)};
}

/// Coordinates of all sizes: parts of millimetres, and a map's.
double coordinate(Random& random, double middle) {
  return middle + (static_cast<double>(random() % 2000001) - 1e6) * 1e-6;
}

/// A mesh as corners of faces of three or four (a parallelogram).
struct Model {
  std::vector<Place> vertices;
  std::vector<std::string> texts;  ///< three a vertex
  std::vector<std::vector<std::size_t>> faces;
};

Place placeOf(const Model& m, std::size_t v) {
  return m.vertices[v];
}

/// @param as  how the format keeps a number: as its decimal, as a float, ...
Model randomModel(Random& random, const std::function<Decimal(double)>& as, bool quads) {
  Model m;
  const double middles[3] = {coin(random) ? 0 : 451237.038, coin(random) ? 0 : 5411234.492, coin(random) ? 0 : 312.537};
  const int vertices = 3 + below(random, 12), faces = 1 + below(random, 10);
  const auto add = [&](const double* x) {
    Place place;
    for (std::size_t k = 0; k < 3; ++k) {
      const Decimal d = as(x[k]);
      m.texts.push_back(d.text);
      place[k] = d.value;
    }
    m.vertices.push_back(place);
  };
  for (int v = 0; v < vertices; ++v) {
    double x[3];
    for (int k = 0; k < 3; ++k) x[k] = coordinate(random, middles[k]);
    add(x);
  }
  for (int f = 0; f < faces; ++f) {
    std::vector<std::size_t> face;
    while (face.size() < 3) {
      const auto v = static_cast<std::size_t>(below(random, vertices));
      if (std::find(face.begin(), face.end(), v) == face.end()) face.push_back(v);
    }
    if (quads && below(random, 3) == 0) {
      // A rectangle along two axes: flat and convex, whatever its coordinates are rounded to.
      const int flat = below(random, 3), u = (flat + 1) % 3, v = (flat + 2) % 3;
      Decimal low[3], high[3];
      for (int k = 0; k < 3; ++k) {
        const double x = coordinate(random, middles[k]);
        low[k] = as(x);
        high[k] = k == flat ? low[k] : as(x + 0.25 + coordinate(random, 0) * 0.1);
      }
      face.clear();
      for (int corner = 0; corner < 4; ++corner) {
        face.push_back(m.vertices.size());
        Place place;
        for (int k = 0; k < 3; ++k) {
          const Decimal& d = (k == u && (corner == 1 || corner == 2)) || (k == v && corner >= 2) ? high[k] : low[k];
          m.texts.push_back(d.text);
          place[static_cast<std::size_t>(k)] = d.value;
        }
        m.vertices.push_back(place);
      }
    }
    m.faces.push_back(face);
  }
  return m;
}

Decimal asFloat(double x) {
  const auto value = static_cast<float>(x);
  return {"", value};
}

void addFan(const std::vector<Place>& corners, WrittenFile& file) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    file.triangles.push_back({corners[0], corners[k], corners[k + 1]});
}
void addFaces(const Model& m, WrittenFile& file) {
  for (const auto& face : m.faces) {
    std::vector<Place> corners;
    for (const std::size_t v : face) corners.push_back(placeOf(m, v));
    addFan(corners, file);
  }
}

std::string vertexText(const Model& m, std::size_t v, const std::string& between = " ") {
  return m.texts[3 * v] + between + m.texts[3 * v + 1] + between + m.texts[3 * v + 2];
}

std::string lineEnd(Random& random) {
  return oneOf<std::string>(random, {"\n", "\r\n", "\r"});
}
std::string mark(Random& random) {
  return below(random, 5) == 0 ? "\xEF\xBB\xBF" : "";
}
std::string blanks(Random& random) {
  return oneOf<std::string>(random, {" ", "  ", "\t", " \t "});
}
std::string capital(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

template <class T>
void append(std::string& out, T value, bool swap = false) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if (swap) std::reverse(bytes, bytes + sizeof value);
  out.append(bytes, sizeof value);
}

// ---- STL

WrittenFile writeStl(Random& random) {
  WrittenFile file;
  file.name = "written.stl";
  if (coin(random)) {
    const Model m = randomModel(random, asFloat, false);
    std::string head = coin(random) ? "solid of bytes" : "made at random";
    head.resize(80, ' ');
    file.content = head;
    append(file.content, static_cast<std::uint32_t>(m.faces.size()));
    for (const auto& face : m.faces) {
      for (int k = 0; k < 3; ++k) append(file.content, 0.5f);
      for (const std::size_t v : face) {
        for (const double x : m.vertices[v]) append(file.content, static_cast<float>(x));
      }
      append(file.content, static_cast<std::uint16_t>(random()));
    }
    addFaces(m, file);
    return file;
  }
  const std::string end = lineEnd(random);
  const bool big = coin(random);
  const auto word = [&](const std::string& text) { return big ? capital(text) : text; };
  file.content = mark(random);
  for (int solids = 1 + below(random, 3); solids > 0; --solids) {
    const Model m = randomModel(
        random, [&](double x) { return decimalOf(x, random); }, false);
    const std::string name = oneOf<std::string>(random, {"", " part", " a part endsolidworks", " facet", " 7 0.5"});
    file.content += word("solid") + name + end;
    for (const auto& face : m.faces) {
      file.content += blanks(random) + word("facet normal") + " 0 nan -1" + end + word(" outer loop") + end;
      for (const std::size_t v : face) {
        file.content += blanks(random) + word("vertex") + blanks(random) + vertexText(m, v, blanks(random)) + end;
      }
      file.content += word("endloop") + end + word("endfacet") + (coin(random) ? end + end : end);
    }
    file.content += word("endsolid") + (coin(random) ? name : "") + end;
    addFaces(m, file);
  }
  return file;
}

// ---- OBJ

WrittenFile writeObj(Random& random) {
  WrittenFile file;
  file.name = "written.obj";
  const Model m = randomModel(
      random, [&](double x) { return decimalOf(x, random); }, true);
  const std::string end = lineEnd(random);
  const auto plain = [&] {
    return oneOf<std::string>(random, {"", "# a comment \\", "g one two", "o part", "s off", "usemtl red", "vt 0.5 0.5",
                                       "vn 0 0 1", "mtllib a b.mtl"}) +
           end;
  };
  std::string vertices, faces;
  const int extra = below(random, 4);
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    vertices += blanks(random) + "v" + blanks(random) + vertexText(m, v, blanks(random));
    vertices += extra == 1 ? " 1.0" : extra == 2 ? " 0.5 0 1" : extra == 3 ? " 1 255 0 255" : "";
    vertices += (below(random, 6) == 0 ? " # corner" : "") + end;
    if (below(random, 5) == 0) vertices += plain();
  }
  const bool first = below(random, 4) != 0;  // vertices come first
  for (const auto& face : m.faces) {
    faces += below(random, 8) == 0 ? "fo" : "f";
    for (const std::size_t v : face) {
      const bool back = first && below(random, 3) == 0;
      faces += blanks(random) + (below(random, 6) == 0 ? "\\" + end : "");
      faces += back ? "-" + std::to_string(m.vertices.size() - v) : std::to_string(v + 1);
      faces += oneOf<std::string>(random, {"", "/1", "//1", "/1/1", "/"});
    }
    faces += end;
    if (below(random, 5) == 0) faces += plain();
    if (below(random, 9) == 0) faces += "p 1" + end, ++file.points;
    if (below(random, 9) == 0) faces += "l 1 2 3" + end, ++file.lines;
    if (below(random, 9) == 0) faces += "f 1 2" + end, ++file.lines;
  }
  file.content = mark(random) + (first ? vertices + faces : faces + vertices);
  addFaces(m, file);
  return file;
}

// ---- OFF

WrittenFile writeOff(Random& random) {
  WrittenFile file;
  file.name = "written.off";
  const Model m = randomModel(
      random, [&](double x) { return decimalOf(x, random); }, true);
  const std::string end = lineEnd(random);
  const bool texture = below(random, 4) == 0, colour = below(random, 4) == 0, normal = below(random, 4) == 0;
  const bool headless = !texture && !colour && !normal && below(random, 5) == 0;
  const auto pause = [&] { return below(random, 5) == 0 ? " # pause" + end + end : std::string(); };
  file.content = mark(random) + pause();
  if (!headless) {
    file.content += std::string(texture ? "ST" : "") + (colour ? "C" : "") + (normal ? "N" : "") + "OFF";
    file.content += coin(random) ? " " : end + pause();
  }
  std::size_t faces = m.faces.size();
  std::string body;
  for (const auto& face : m.faces) {
    body += std::to_string(face.size());
    for (const std::size_t v : face) body += blanks(random) + std::to_string(v);
    body += oneOf<std::string>(random, {"", " 7", " 255 0 0", " 0.1 0.2 0.3 1"}) + end + pause();
    if (below(random, 6) == 0) body += "2 0 1" + end, ++file.lines, ++faces;
    if (below(random, 6) == 0) body += "1 2" + end, ++file.points, ++faces;
  }
  file.content += std::to_string(m.vertices.size()) + " " + std::to_string(faces) + (coin(random) ? " 0" : "") + end;
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    file.content += pause() + blanks(random) + vertexText(m, v) + (normal ? " 0 0 1" : "");
    file.content +=
        std::string(colour ? coin(random) ? " 255 0 0 255" : " 0.5 0 0" : "") + (texture ? " 0 1" : "") + end;
  }
  file.content += body;
  addFaces(m, file);
  return file;
}

// ---- PLY

enum class Bytes { text, little, big };

void appendNumber(std::string& out, const std::string& type, double value, const std::string& text, Bytes bytes) {
  if (bytes == Bytes::text) {
    out += text + " ";
    return;
  }
  const bool swap = bytes == Bytes::big;
  if (type == "char" || type == "int8") append(out, static_cast<std::int8_t>(value), swap);
  if (type == "uchar" || type == "uint8") append(out, static_cast<std::uint8_t>(value), swap);
  if (type == "short" || type == "int16") append(out, static_cast<std::int16_t>(value), swap);
  if (type == "ushort" || type == "uint16") append(out, static_cast<std::uint16_t>(value), swap);
  if (type == "int" || type == "int32") append(out, static_cast<std::int32_t>(value), swap);
  if (type == "uint" || type == "uint32") append(out, static_cast<std::uint32_t>(value), swap);
  if (type == "float" || type == "float32") append(out, static_cast<float>(value), swap);
  if (type == "double" || type == "float64") append(out, value, swap);
}

WrittenFile writePly(Random& random, bool cloud) {
  WrittenFile file;
  file.name = "written.ply";
  const Bytes bytes = oneOf<Bytes>(random, {Bytes::text, Bytes::little, Bytes::big});
  const std::string type = oneOf<std::string>(random, {"float", "float32", "double", "float64"});
  const bool single = bytes != Bytes::text && type[0] == 'f' && type.back() != '4';
  const Model m = randomModel(
      random,
      [&](double x) {
        return bytes == Bytes::text ? decimalOf(x, random) : single ? asFloat(x) : Decimal{"", x};
      },
      bytes == Bytes::text);
  const std::string end = bytes == Bytes::text && coin(random) ? "\r\n" : "\n";
  const auto endOfLine = [&] { return bytes == Bytes::text ? end : std::string(); };
  const std::vector<std::string> counts{"char", "uchar", "int16", "uint16", "int", "uint32"};
  const std::string count_type = oneOf(random, counts), index_type = oneOf(random, counts);

  struct Column {
    std::string type, name;
    int axis;
  };
  std::vector<Column> columns{{type, "x", 0}, {type, "y", 1}, {type, "z", 2}};
  if (coin(random)) columns.push_back({"uchar", "red", -1});
  if (coin(random)) columns.push_back({"double", "nx", -1});
  if (coin(random)) columns.push_back({"int16", "quality", -1});
  std::shuffle(columns.begin(), columns.end(), random);

  std::string head = "element vertex " + std::to_string(m.vertices.size()) + end, body;
  for (const Column& c : columns) head += "property " + c.type + " " + c.name + end;
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    for (const Column& c : columns) {
      const auto k = static_cast<std::size_t>(std::max(c.axis, 0));
      appendNumber(body, c.type, c.axis < 0 ? 7 : m.vertices[v][k], c.axis < 0 ? "7" : m.texts[3 * v + k], bytes);
    }
    body += endOfLine();
  }
  if (cloud) {
    file.cloud = m.vertices;
  } else {
    addFaces(m, file);
    std::string face_head = "element face ", face_body;
    const bool colour = coin(random), before = coin(random);
    std::size_t faces = m.faces.size();
    const auto number = [&](const std::string& t, std::size_t n) {
      appendNumber(face_body, t, static_cast<double>(n), std::to_string(n), bytes);
    };
    const auto addFace = [&](const std::vector<std::size_t>& face) {
      if (colour && before) number("uchar", 9);
      number(count_type, face.size());
      for (const std::size_t v : face) number(index_type, v);
      if (colour && !before) number("uchar", 9);
      face_body += endOfLine();
    };
    for (const auto& face : m.faces) addFace(face);
    if (below(random, 4) == 0) addFace({0, 1}), ++faces, ++file.lines;
    if (below(random, 4) == 0) addFace({2}), ++faces, ++file.points;
    face_head += std::to_string(faces) + end;
    if (colour && before) face_head += "property uchar red" + end;
    face_head +=
        "property list " + count_type + " " + index_type + " vertex_ind" + (coin(random) ? "ex" : "ices") + end;
    if (colour && !before) face_head += "property uchar red" + end;
    if (below(random, 4) == 0) {
      head = face_head + head;
      body = face_body + body;
    } else {
      head += face_head;
      body += face_body;
    }
    if (below(random, 4) == 0) {
      head += "element edge 1" + end + "property int vertex1" + end + "property int vertex2" + end;
      for (int k = 0; k < 2; ++k) appendNumber(body, "int", k, std::to_string(k), bytes);
      body += endOfLine();
      ++file.lines;
    }
  }
  if (below(random, 4) == 0) {
    head += "element camera 1" + end + "property float view_px" + end + "property list uchar int rest" + end;
    appendNumber(body, "float", 1, "1", bytes);
    appendNumber(body, "uchar", 1, "1", bytes);
    appendNumber(body, "int", 5, "5", bytes);
    body += endOfLine();
  }
  const char* const format[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  file.content = "ply" + end + "format " + format[static_cast<int>(bytes)] + " 1.0" + end;
  if (coin(random)) file.content += "comment element face 7" + end + "obj_info made at random" + end;
  file.content += head + "end_header" + end + body;
  return file;
}

// ---- places of nodes, in numbers of more digits than the readers'

using Real = long double;
struct Matrix {
  Real at[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      out.at[i][j] = j == 3 ? a.at[i][3] : 0;
      for (int k = 0; k < 3; ++k) out.at[i][j] += a.at[i][k] * b.at[k][j];
    }
  }
  return out;
}
Place image(const Matrix& m, const Place& x) {
  Place out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = static_cast<double>(m.at[i][0] * x[0] + m.at[i][1] * x[1] + m.at[i][2] * x[2] + m.at[i][3]);
  }
  return out;
}
Matrix scaling(Real x, Real y, Real z) {
  Matrix m;
  m.at[0][0] = x, m.at[1][1] = y, m.at[2][2] = z;
  return m;
}
Matrix shift(Real x, Real y, Real z) {
  Matrix m;
  m.at[0][3] = x, m.at[1][3] = y, m.at[2][3] = z;
  return m;
}
/// The rotation of a quaternion of any length above 0.
Matrix turned(Real x, Real y, Real z, Real w) {
  const Real n = std::sqrt(x * x + y * y + z * z + w * w);
  x /= n, y /= n, z /= n, w /= n;
  Matrix m;
  m.at[0][0] = 1 - 2 * (y * y + z * z), m.at[0][1] = 2 * (x * y - z * w), m.at[0][2] = 2 * (x * z + y * w);
  m.at[1][0] = 2 * (x * y + z * w), m.at[1][1] = 1 - 2 * (x * x + z * z), m.at[1][2] = 2 * (y * z - x * w);
  m.at[2][0] = 2 * (x * z - y * w), m.at[2][1] = 2 * (y * z + x * w), m.at[2][2] = 1 - 2 * (x * x + y * y);
  return m;
}
bool mirrors(const Matrix& m) {
  const auto& a = m.at;
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
             a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]) <
         0;
}
Matrix upward(char axis) {
  Matrix m;
  if (axis == 'y') m = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
  if (axis == 'x') m = {{{0, -1, 0, 0}, {0, 0, -1, 0}, {1, 0, 0, 0}}};
  return m;
}

using Faces = std::vector<std::vector<Place>>;

void addPlaced(const Faces& faces, const Matrix& m, WrittenFile& file) {
  for (std::vector<Place> corners : faces) {
    for (Place& x : corners) x = image(m, x);
    if (mirrors(m)) std::reverse(corners.begin() + 1, corners.end());
    addFan(corners, file);
  }
}

double small(Random& random) {
  return (static_cast<double>(random() % 4001) - 2000) / 1000;
}
std::string shown(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
Real fromShown(double x) {
  return std::strtod(shown(x).c_str(), nullptr);
}

// ---- COLLADA

class ColladaWriter {
 public:
  explicit ColladaWriter(Random& random) : random_(random) {}

  WrittenFile write() {
    file_.name = "written.dae";
    file_.turn = coin(random_);
    file_.tolerance = 1e-13;
    const std::string metre = oneOf<std::string>(random_, {"1", "0.001", "0.0254"});
    const char up = oneOf<char>(random_, {'x', 'y', 'z'});
    const bool says = up != 'y' || coin(random_);
    const int geometries = 1 + below(random_, 3);
    std::string libraries;
    for (int g = 0; g < geometries; ++g) libraries += geometry(g);
    const Real s = std::strtod(metre.c_str(), nullptr);
    const Matrix M = product(scaling(s, s, s), file_.turn ? upward(up) : Matrix());
    std::string scene = node(0, M);
    scene += node(0, M);
    file_.content =
        mark(random_) + "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" " +
        "version=\"1.4.1\">\n<asset><created/><unit name=\"u\" meter=\"" + metre + "\"/>" +
        (says ? "<up_axis>" + std::string(1, static_cast<char>(up - 'x' + 'X')) + "_UP</up_axis>" : "") + "</asset>\n" +
        "<library_effects><effect id=\"e\"><whatever/></effect></library_effects>\n<library_geometries>" + libraries +
        "</library_geometries>\n<library_nodes>" + library_nodes_ + "</library_nodes>\n" +
        "<library_visual_scenes><visual_scene id=\"other\"/><visual_scene id=\"scene\">" + scene +
        "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url=\"#scene\"/></scene>\n</COLLADA>\n";
    return file_;
  }

 private:
  struct Geometry {
    Faces faces;
    std::size_t lines = 0;
  };

  std::string geometry(int number) {
    const Model m = randomModel(
        random_, [&](double x) { return decimalOf(x, random_); }, true);
    const std::string id = "g" + std::to_string(number);
    // The accessor's columns in any order, after an offset, with a gap.
    std::vector<int> order{0, 1, 2};
    std::shuffle(order.begin(), order.end(), random_);
    const int gap = below(random_, 2), offset = below(random_, 3), stride = 3 + gap;
    std::string values, params;
    for (int k = 0; k < offset; ++k) values += "9 ";
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
      if (gap) values += "9 ";
      for (const int k : order) values += m.texts[3 * v + static_cast<std::size_t>(k)] + (coin(random_) ? " " : "\n");
      if (below(random_, 5) == 0) values += "<!-- 7 -->";
    }
    if (gap) params += "<param type=\"float\"/>";
    for (const int k : order) params += "<param name=\"" + std::string(1, "XYZ"[k]) + "\" type=\"float\"/>";
    const std::size_t count = static_cast<std::size_t>(offset) + m.vertices.size() * static_cast<std::size_t>(stride);
    std::string out =
        "<geometry id=\"" + id + "\"><mesh>\n<source id=\"" + id + "p\"><float_array id=\"" + id + "a\" count=\"" +
        std::to_string(count) + "\">" + values + "</float_array><technique_common><accessor source=\"#" + id +
        "a\" count=\"" + std::to_string(m.vertices.size()) + "\" stride=\"" + std::to_string(stride) + "\" offset=\"" +
        std::to_string(offset) + "\">" + params + "</accessor></technique_common></source>\n<vertices id=\"" + id +
        "v\"><input semantic=\"POSITION\" source=\"#" + id + "p\"/></vertices>\n";
    Geometry g;
    for (int primitives = 1 + below(random_, 3); primitives > 0; --primitives) out += primitive(id, m, g);
    geometries_.push_back(g);
    return out + "</mesh></geometry>\n";
  }

  std::string primitive(const std::string& id, const Model& m, Geometry& g) {
    const int more = below(random_, 3), at = below(random_, more + 1);
    std::string inputs;
    for (int k = 0; k <= more; ++k) {
      inputs += "<input semantic=\"" + std::string(k == at ? "VERTEX" : "TEXCOORD") + "\" source=\"#" + id +
                (k == at ? "v" : "t") + "\" offset=\"" + std::to_string(k) + "\"/>";
    }
    const auto corners = [&](const std::vector<std::size_t>& list) {
      std::string text;
      for (const std::size_t v : list) {
        for (int k = 0; k <= more; ++k) text += (k == at ? std::to_string(v) : "0") + (coin(random_) ? " " : "\n");
      }
      return text;
    };
    const auto emit = [&](std::size_t a, std::size_t b, std::size_t c) {
      g.faces.push_back({placeOf(m, a), placeOf(m, b), placeOf(m, c)});
    };
    std::string p, kind = oneOf<std::string>(
                       random_, {"triangles", "polylist", "polygons", "trifans", "tristrips", "lines", "linestrips"});
    std::size_t count = 0;
    if (kind == "triangles") {
      p = "<p>";
      for (const auto& face : m.faces) {
        for (std::size_t k = 1; k + 1 < face.size(); ++k, ++count) {
          p += corners({face[0], face[k], face[k + 1]});
          emit(face[0], face[k], face[k + 1]);
        }
      }
      p += "</p>";
    } else if (kind == "polylist" || kind == "polygons") {
      std::string counts, list;
      for (const auto& face : m.faces) {
        counts += std::to_string(face.size()) + " ";
        list += kind == "polygons" ? "<p>" + corners(face) + "</p>" : corners(face);
        std::vector<Place>& places = g.faces.emplace_back();
        for (const std::size_t v : face) places.push_back(placeOf(m, v));
      }
      count = m.faces.size();
      p = kind == "polygons" ? list : "<vcount>" + counts + "</vcount><p>" + list + "</p>";
    } else {
      for (count = 0; count < 2; ++count) {
        std::vector<std::size_t> list;
        const int length = kind == "lines" ? 2 : 3 + below(random_, 3);
        for (int k = 0; k < length; ++k)
          list.push_back(static_cast<std::size_t>(below(random_, static_cast<int>(m.vertices.size()))));
        p +=
            (kind == "lines" && count > 0 ? "" : "<p>") + corners(list) + (kind == "lines" && count == 0 ? "" : "</p>");
        g.lines += kind == "lines" || kind == "linestrips";
        for (std::size_t k = 2; k < list.size(); ++k) {
          if (kind == "trifans") emit(list[0], list[k - 1], list[k]);
          if (kind == "tristrips" && k % 2 == 0) emit(list[k - 2], list[k - 1], list[k]);
          if (kind == "tristrips" && k % 2 == 1) emit(list[k - 1], list[k - 2], list[k]);
        }
      }
    }
    return "<" + kind + " count=\"" + std::to_string(count) + "\">" + inputs + p + "</" + kind + ">\n";
  }

  std::string node(int depth, Matrix M) {
    std::string transforms, parts, children;
    for (int k = below(random_, 4); k > 0; --k) {
      const double x = small(random_), y = small(random_), z = small(random_);
      const std::string three = shown(x) + " " + shown(y) + " " + shown(z);
      const int kind = below(random_, 4);
      if (kind == 0) {
        transforms += "<translate>" + three + "</translate>";
        M = product(M, shift(fromShown(x), fromShown(y), fromShown(z)));
      } else if (kind == 1 && x != 0 && y != 0 && z != 0) {
        transforms += (coin(random_) ? "<scale>" : "<scale sid=\"s\">") + three + "</scale>";
        M = product(M, scaling(fromShown(x), fromShown(y), fromShown(z)));
      } else if (kind == 2 && (x != 0 || y != 0 || z != 0)) {
        const double angle = 90 * small(random_);
        transforms += "<rotate>" + three + " " + shown(angle) + "</rotate>";
        const Real half = fromShown(angle) * 3.14159265358979323846264338327950288L / 360,
                   n = std::sqrt(fromShown(x) * fromShown(x) + fromShown(y) * fromShown(y) +
                                 fromShown(z) * fromShown(z));
        const Real sine = std::sin(half) / n;
        M = product(M, turned(sine * fromShown(x), sine * fromShown(y), sine * fromShown(z), std::cos(half)));
      } else if (kind == 3) {
        Matrix own;
        transforms += "<matrix>";
        for (auto& row : own.at) {
          for (Real& entry : row) {
            const double value = small(random_);
            entry = fromShown(value);
            transforms += shown(value) + " ";
          }
        }
        transforms += "0 0 0 1</matrix>";
        M = product(M, own);
      }
    }
    if (coin(random_) || depth == 0) {
      const int number = below(random_, static_cast<int>(geometries_.size()));
      parts += "<instance_geometry url=\"#g" + std::to_string(number) +
               (coin(random_) ? "\"/>" : "\"><bind_material><technique_common/></bind_material></instance_geometry>");
      addPlaced(geometries_[static_cast<std::size_t>(number)].faces, M, file_);
      file_.lines += geometries_[static_cast<std::size_t>(number)].lines;
    }
    if (depth < 2) {
      // A node of the library, at this place; instances come before children.
      if (below(random_, 3) == 0) {
        const std::string id = "n" + std::to_string(nodes_++);
        std::string other = node(depth + 1, M);
        other.insert(5, " id=\"" + id + "\"");
        library_nodes_ += other;
        parts += "<instance_node url=\"#" + id + "\"/>";
      }
      if (coin(random_)) children += node(depth + 1, M);
    }
    return "<node>" + transforms + parts + "<instance_camera url=\"#c\"/>" + children + "<extra/></node>";
  }

  Random& random_;
  WrittenFile file_;
  std::vector<Geometry> geometries_;
  std::string library_nodes_;
  int nodes_ = 0;
};

// ---- glTF

std::string base64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    unsigned bits = 0;
    for (std::size_t b = 0; b < 3; ++b)
      bits = bits << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0);
    for (std::size_t d = 0; d < 4; ++d) out += k + d > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * d) & 63];
  }
  return out;
}

class GltfWriter {
 public:
  explicit GltfWriter(Random& random) : random_(random) {}

  WrittenFile write() {
    file_.turn = coin(random_);
    file_.tolerance = 1e-13;
    for (int k = 1 + below(random_, 3); k > 0; --k) addMesh();
    const Matrix M = file_.turn ? upward('y') : Matrix();
    std::string roots;
    for (int k = 1 + below(random_, 2); k > 0; --k) roots += (roots.empty() ? "" : ",") + std::to_string(node(0, M));
    const int kind = below(random_, 3);
    file_.name = kind == 0 ? "written.glb" : "written.gltf";
    std::string uri;
    if (kind == 1) uri = ",\"uri\":\"data:application/octet-stream;base64," + base64(bytes_) + "\"";
    if (kind == 2) {
      uri = ",\"uri\":\"my%20bytes.bin\"";
      file_.more["my bytes.bin"] = bytes_;
    }
    const std::string scene = "{\"nodes\":[" + roots + "]}";
    const bool two = coin(random_);
    std::string json = "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_materials_unlit\"]," +
                       std::string(two || coin(random_) ? "\"scene\":" + std::string(two ? "1" : "0") + "," : "") +
                       "\"scenes\":[" + (two ? "{\"name\":\"empty\"}," : "") + scene + "],\"nodes\":[" + list(nodes_) +
                       "],\"meshes\":[" + list(meshes_) + "],\"accessors\":[" + list(accessors_) +
                       "],\"bufferViews\":[" + list(views_) +
                       "],\"buffers\":[{\"byteLength\":" + std::to_string(bytes_.size()) + uri + "}]}";
    if (kind == 0) {
      while (json.size() % 4 != 0) json += ' ';
      std::string bytes = bytes_;
      while (bytes.size() % 4 != 0) bytes += '\0';
      file_.content = "glTF";
      append(file_.content, std::uint32_t{2});
      append(file_.content, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bytes.size()));
      append(file_.content, static_cast<std::uint32_t>(json.size()));
      file_.content += "JSON" + json;
      append(file_.content, static_cast<std::uint32_t>(bytes.size()));
      file_.content += std::string("BIN\0", 4) + bytes;
    } else {
      file_.content = json;
    }
    return file_;
  }

 private:
  struct Mesh {
    Faces faces;
    std::size_t points = 0, lines = 0;
  };

  static std::string list(const std::vector<std::string>& entries) {
    std::string out;
    for (const std::string& e : entries) out += (out.empty() ? "" : ",") + e;
    return out;
  }
  std::size_t view(const std::string& content, int stride) {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    views_.push_back("{\"buffer\":0,\"byteOffset\":" + std::to_string(bytes_.size()) +
                     ",\"byteLength\":" + std::to_string(content.size()) +
                     (stride ? ",\"byteStride\":" + std::to_string(stride) : "") + "}");
    bytes_ += content;
    return views_.size() - 1;
  }
  std::size_t accessor(std::size_t view, std::size_t offset, int kind, std::size_t count, const char* type) {
    accessors_.push_back("{\"bufferView\":" + std::to_string(view) +
                         (offset ? ",\"byteOffset\":" + std::to_string(offset) : "") + ",\"componentType\":" +
                         std::to_string(kind) + ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"}");
    return accessors_.size() - 1;
  }

  void addMesh() {
    Mesh mesh;
    const Model m = randomModel(random_, asFloat, false);
    const int gap = coin(random_) ? 4 * below(random_, 3) : -1;  // no stride is said
    const std::size_t offset = 4 * static_cast<std::size_t>(below(random_, 3));
    std::string places(offset, '\x7f');
    for (const Place& x : m.vertices) {
      for (const double c : x) append(places, static_cast<float>(c));
      places.append(static_cast<std::size_t>(std::max(gap, 0)), '\x7f');
    }
    const std::size_t position =
        accessor(view(places, gap < 0 ? 0 : 12 + gap), offset, 5126, m.vertices.size(), "VEC3");
    std::string primitives;
    for (int k = 1 + below(random_, 2); k > 0; --k) {
      const int mode = below(random_, 7);
      std::vector<std::size_t> corners;
      const bool plain = m.vertices.size() % 3 == 0 && m.vertices.size() % 2 == 0 && below(random_, 3) == 0;
      const int wanted = mode == 1 ? 4 : mode == 4 ? 6 : 3 + below(random_, 4);
      for (int c = 0; c < (plain ? static_cast<int>(m.vertices.size()) : wanted); ++c) {
        corners.push_back(plain ? static_cast<std::size_t>(c)
                                : static_cast<std::size_t>(below(random_, static_cast<int>(m.vertices.size()))));
      }
      std::string indices;
      if (!plain) {
        const int kind = oneOf<int>(random_, {5121, 5123, 5125});
        std::string content;
        for (const std::size_t c : corners) {
          if (kind == 5121) append(content, static_cast<std::uint8_t>(c));
          if (kind == 5123) append(content, static_cast<std::uint16_t>(c));
          if (kind == 5125) append(content, static_cast<std::uint32_t>(c));
        }
        indices = ",\"indices\":" + std::to_string(accessor(view(content, 0), 0, kind, corners.size(), "SCALAR"));
      }
      const std::string says = mode == 4 && coin(random_) ? "" : ",\"mode\":" + std::to_string(mode);
      primitives += (primitives.empty() ? "" : ",") + std::string("{\"attributes\":{\"POSITION\":") +
                    std::to_string(position) + ",\"NORMAL\":" + std::to_string(position) + "}" + indices + says +
                    ",\"material\":0}";
      const auto emit = [&](std::size_t a, std::size_t b, std::size_t c) {
        mesh.faces.push_back({m.vertices[corners[a]], m.vertices[corners[b]], m.vertices[corners[c]]});
      };
      const std::size_t n = corners.size();
      if (mode == 0) mesh.points += n;
      if (mode == 1) mesh.lines += n / 2;
      if (mode == 2 || mode == 3) ++mesh.lines;
      for (std::size_t c = 2; c < n; ++c) {
        if (mode == 4 && c % 3 == 2) emit(c - 2, c - 1, c);
        if (mode == 5) c % 2 == 0 ? emit(c - 2, c - 1, c) : emit(c - 1, c - 2, c);
        if (mode == 6) emit(0, c - 1, c);
      }
    }
    meshes_.push_back("{\"primitives\":[" + primitives + "]}");
    models_.push_back(mesh);
  }

  /// Nodes are read in the order in which the last child comes first; each has one child at most here.
  std::size_t node(int depth, Matrix M) {
    std::string text;
    const auto numbers = [&](const std::vector<double>& x) {
      std::string out;
      for (const double v : x) out += (out.empty() ? "" : ",") + shown(v);
      return "[" + out + "]";
    };
    if (below(random_, 3) == 0) {
      Matrix own;
      std::vector<double> columns;
      for (int j = 0; j < 4; ++j) {
        for (auto& row : own.at) {
          columns.push_back(small(random_));
          row[j] = fromShown(columns.back());
        }
        columns.push_back(j == 3);
      }
      text += ",\"matrix\":" + numbers(columns);
      M = product(M, own);
    } else {
      if (coin(random_)) {
        const double x[3] = {small(random_), small(random_), small(random_)};
        text += ",\"translation\":" + numbers({x[0], x[1], x[2]});
        M = product(M, shift(fromShown(x[0]), fromShown(x[1]), fromShown(x[2])));
      }
      if (coin(random_)) {
        double q[4], size = 0;
        for (double& x : q) x = small(random_) + 0.0005, size += x * x;
        for (double& x : q) x /= std::sqrt(size);
        text += ",\"rotation\":" + numbers({q[0], q[1], q[2], q[3]});
        M = product(M, turned(fromShown(q[0]), fromShown(q[1]), fromShown(q[2]), fromShown(q[3])));
      }
      if (coin(random_)) {
        const double s[3] = {small(random_) + 0.0005, small(random_) + 0.0005, small(random_) + 0.0005};
        text += ",\"scale\":" + numbers({s[0], s[1], s[2]});
        M = product(M, scaling(fromShown(s[0]), fromShown(s[1]), fromShown(s[2])));
      }
    }
    if (depth == 0 || coin(random_)) {
      const int number = below(random_, static_cast<int>(models_.size()));
      const Mesh& mesh = models_[static_cast<std::size_t>(number)];
      text += ",\"mesh\":" + std::to_string(number);
      addPlaced(mesh.faces, M, file_);
      file_.points += mesh.points;
      file_.lines += mesh.lines;
    }
    if (depth < 3 && coin(random_)) text += ",\"children\":[" + std::to_string(node(depth + 1, M)) + "]";
    nodes_.push_back("{\"name\":\"n\"" + text + "}");
    return nodes_.size() - 1;
  }

  Random& random_;
  WrittenFile file_;
  std::string bytes_;
  std::vector<std::string> views_, accessors_, meshes_, nodes_;
  std::vector<Mesh> models_;
};

// ---- points

/// LZF: runs, and copies of what was written where three bytes are the same.
std::string compressed(const std::string& in) {
  std::string out;
  std::size_t at = 0;
  while (at < in.size()) {
    std::size_t best = 0, back = 0;
    for (std::size_t from = at > 8000 ? at - 8000 : 0; from < at; ++from) {
      std::size_t n = 0;
      while (at + n < in.size() && in[from + n] == in[at + n] && n < 200) ++n;
      if (n > best) best = n, back = at - from;
    }
    if (best >= 3) {
      const std::size_t length = best - 2;
      if (length < 7) {
        out += static_cast<char>(length << 5 | (back - 1) >> 8);
      } else {
        out += static_cast<char>(7 << 5 | (back - 1) >> 8);
        out += static_cast<char>(length - 7);
      }
      out += static_cast<char>((back - 1) & 255);
      at += best;
      continue;
    }
    const std::size_t run = std::min<std::size_t>(2, in.size() - at);
    out += static_cast<char>(run - 1);
    out += in.substr(at, run);
    at += run;
  }
  return out;
}

WrittenFile writePcd(Random& random) {
  WrittenFile file;
  file.name = "written.pcd";
  const int kind = below(random, 3);
  const std::string size = coin(random) ? "4" : "8";
  const bool single = kind > 0 && size == "4";
  const Model m = randomModel(
      random,
      [&](double x) {
        return kind == 0 ? decimalOf(x, random) : single ? asFloat(x) : Decimal{"", x};
      },
      false);
  struct Field {
    std::string name, size, type;
    int count, axis;
  };
  std::vector<Field> fields{{"x", size, "F", 1, 0}, {"y", size, "F", 1, 1}, {"z", size, "F", 1, 2}};
  if (coin(random)) fields.push_back({"rgb", "4", "U", 1, -1});
  if (coin(random)) fields.push_back({"descriptor", "2", "I", 3, -1});
  if (coin(random)) fields.push_back({"_", "1", "U", 2, -1});
  std::shuffle(fields.begin(), fields.end(), random);
  std::string names, sizes, types, counts;
  for (const Field& f : fields) {
    names += " " + f.name, sizes += " " + f.size, types += " " + f.type, counts += " " + std::to_string(f.count);
  }
  const std::size_t n = m.vertices.size();
  const bool grid = n % 2 == 0 && coin(random);
  file.content = "# .PCD\nVERSION .7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
                 "\nWIDTH " + std::to_string(grid ? n / 2 : n) + "\nHEIGHT " + (grid ? "2" : "1") +
                 "\nVIEWPOINT 0 0 0.0 1.0 0 0 0\n" + (coin(random) ? "POINTS " + std::to_string(n) + "\n" : "") +
                 "DATA " +
                 (kind == 0   ? "ascii"
                  : kind == 1 ? "binary"
                              : "binary_compressed") +
                 "\n";
  std::string body;
  const auto value = [&](const Field& f, std::size_t v) {
    if (f.axis >= 0) {
      const double x = m.vertices[v][static_cast<std::size_t>(f.axis)];
      single ? append(body, static_cast<float>(x)) : append(body, x);
    } else {
      body.append(static_cast<std::size_t>(f.count) * static_cast<std::size_t>(std::atoi(f.size.c_str())), '\3');
    }
  };
  if (kind == 0) {
    for (std::size_t v = 0; v < n; ++v) {
      for (const Field& f : fields) {
        for (int k = 0; k < f.count; ++k)
          body += (f.axis < 0 ? "3" : m.texts[3 * v + static_cast<std::size_t>(f.axis)]) + blanks(random);
      }
      body += coin(random) ? "\n" : "\r\n";
    }
  } else if (kind == 1) {
    for (std::size_t v = 0; v < n; ++v) {
      for (const Field& f : fields) value(f, v);
    }
  } else {
    for (const Field& f : fields) {
      for (std::size_t v = 0; v < n; ++v) value(f, v);
    }
    const std::string small_body = compressed(body);
    append(file.content, static_cast<std::uint32_t>(small_body.size()));
    append(file.content, static_cast<std::uint32_t>(body.size()));
    body = small_body;
  }
  if (kind > 0 && below(random, 4) == 0) body.append(37, '\0');
  file.content += body;
  file.cloud = m.vertices;
  return file;
}

WrittenFile writeXyz(Random& random) {
  WrittenFile file;
  file.name = "written.xyz";
  const Model m = randomModel(
      random, [&](double x) { return decimalOf(x, random); }, false);
  const std::string end = lineEnd(random), between = oneOf<std::string>(random, {" ", "\t", ",", ", ", ";", " ; "});
  const int more = below(random, 4);
  file.content = mark(random) + (coin(random) ? "# x y z" + end : "");
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    file.content += vertexText(m, v, between);
    for (int k = 0; k < more; ++k) file.content += between + "0.5";
    file.content += (below(random, 6) == 0 ? " # note" : "") + end + (below(random, 6) == 0 ? end : "");
  }
  file.cloud = m.vertices;
  return file;
}

}  // namespace

int below(Random& random, int count) {
  return static_cast<int>(random() % static_cast<unsigned>(count));
}
bool coin(Random& random) {
  return random() & 1;
}

const std::vector<std::string>& writtenFormats() {
  static const std::vector<std::string> all{"stl", "obj", "off", "ply", "dae", "pcd", "xyz", "cloud.ply",
#ifdef FCL_ARTIC_GLTF
                                            "gltf"
#endif
  };
  return all;
}

WrittenFile writeRandomFile(const std::string& format, Random& random) {
  if (format == "stl") return writeStl(random);
  if (format == "obj") return writeObj(random);
  if (format == "off") return writeOff(random);
  if (format == "ply") return writePly(random, false);
  if (format == "dae") return ColladaWriter(random).write();
  if (format == "gltf") return GltfWriter(random).write();
  if (format == "pcd") return writePcd(random);
  if (format == "xyz") return writeXyz(random);
  return writePly(random, true);
}

}  // namespace fcl_artic::test
