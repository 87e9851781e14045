// SPDX-License-Identifier: BSD-3-Clause
//
// One geometry or scene after the other, words and numbers between blanks; doubles are hexadecimal.
#include "scene_file.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>

namespace campaign {
namespace {

constexpr char kHead[] = "fcl_artic-campaign-scenes/1";

class Writer {
 public:
  void word(const std::string& w) { text_ += w + " "; }
  void integer(std::uint64_t i) { word(std::to_string(i)); }
  void index(int i) { word(std::to_string(i)); }
  void number(double x) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%a", x);
    word(digits);
  }
  void vector(const Vec3& v) {
    for (int k = 0; k < 3; ++k) number(v[k]);
  }
  void pose(const Pose& M) {
    for (int k = 0; k < 3; ++k) vector(M.R.col(k));
    vector(M.p);
  }
  void endLine() { text_ += '\n'; }
  const std::string& text() const { return text_; }

 private:
  std::string text_ = std::string(kHead) + " \n";
};

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), in_(file) {
    std::string head;
    if (!(in_ >> head) || head != kHead) fail();
  }

  /// False at the file's end. The rest of a line after "#" is for people.
  bool next(std::string& w) {
    while (in_ >> w) {
      if (w != "#") return true;
      std::getline(in_, w);
    }
    return false;
  }
  std::string word() {
    std::string w;
    if (!next(w)) fail();
    return w;
  }
  std::uint64_t integer() {
    return parsed<std::uint64_t>([](const char* s, char** e) { return std::strtoull(s, e, 10); });
  }
  int index() {
    return static_cast<int>(parsed<long>([](const char* s, char** e) { return std::strtol(s, e, 10); }));
  }
  /// In [0, end).
  int index(std::size_t end) {
    const int i = index();
    if (i < 0 || static_cast<std::size_t>(i) >= end) fail();
    return i;
  }
  double number() {
    return parsed<double>([](const char* s, char** e) { return std::strtod(s, e); });
  }
  Vec3 vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Pose pose() {
    Pose M;
    for (int k = 0; k < 3; ++k) M.R.col(k) = vector();
    M.p = vector();
    return M;
  }
  [[noreturn]] void fail() const { throw std::runtime_error("'" + file_ + "' is no file of scenes, or cut short"); }

 private:
  template <class T, class Parse>
  T parsed(Parse parse) {
    const std::string w = word();
    char* end = nullptr;
    const T value = parse(w.c_str(), &end);
    if (end != w.c_str() + w.size()) fail();
    return value;
  }

  std::string file_;
  std::ifstream in_;
};

void write(const Geometry& g, Writer& out) {
  out.word("geometry");
  out.index(g.kind());
  if (g.isMesh()) {
    out.word(g.name());
    out.index(static_cast<int>(g.volume()));
    out.integer(g.vertices().size());
    for (const Vec3& v : g.vertices()) out.vector(v);
    out.integer(g.triangles().size());
    for (const auto& t : g.triangles())
      for (const int i : t) out.index(i);
  } else {
    out.vector(g.half());
  }
  out.endLine();
}

GeometryPtr readGeometry(Reader& in) {
  const int kind = in.index();
  if (kind == Piece::triangle) {
    std::string name = in.word();
    const auto volume = static_cast<Geometry::BV>(in.index(4));
    std::vector<Vec3> vertices;
    for (std::uint64_t n = in.integer(); n > 0; --n) vertices.push_back(in.vector());
    std::vector<std::array<int, 3>> triangles;
    for (std::uint64_t n = in.integer(); n > 0; --n) {
      std::array<int, 3> t;
      for (int& i : t) i = in.index(vertices.size());
      triangles.push_back(t);
    }
    return Geometry::mesh(std::move(name), std::move(vertices), std::move(triangles), volume);
  }
  const Vec3 half = in.vector();
  switch (kind) {
    case Piece::box:
      return Geometry::box(2 * half);
    case Piece::cylinder:
      return Geometry::cylinder(half.x(), 2 * half.z());
    case Piece::sphere:
      return Geometry::sphere(half.x());
    default:
      in.fail();
  }
}

void write(const Scene& s, const std::map<const Geometry*, int>& numbers, Writer& out) {
  out.word("scene");
  out.word(s.family);
  out.integer(s.seed);
  for (const double x : {s.tolerance_time, s.tolerance_distance, s.margin}) out.number(x);
  for (const bool b : {s.check_scene, s.check_self, s.every_pair, s.shortest}) out.index(b);
  out.index(s.max_contacts);
  out.integer(s.links.size());
  for (const Link& l : s.links) {
    out.index(l.parent);
    out.index(static_cast<int>(l.joint));
    out.pose(l.origin);
    out.vector(l.axis);
    out.index(l.master);
    out.number(l.multiplier);
    out.number(l.offset);
  }
  out.integer(s.q0.size());
  for (std::size_t v = 0; v < s.q0.size(); ++v) {
    out.number(s.q0[v]);
    out.number(s.q1[v]);
  }
  out.integer(s.bodies.size());
  for (const Body& b : s.bodies) {
    out.index(numbers.at(b.geometry.get()));
    out.index(b.link);
    out.pose(b.pose);
  }
  out.integer(s.allowed.size());
  for (const auto& [a, b] : s.allowed) {
    out.index(a);
    out.index(b);
  }
  out.endLine();
}

Scene readScene(const std::vector<GeometryPtr>& geometries, Reader& in) {
  Scene s;
  s.family = in.word();
  s.seed = in.integer();
  for (double* x : {&s.tolerance_time, &s.tolerance_distance, &s.margin}) *x = in.number();
  for (bool* b : {&s.check_scene, &s.check_self, &s.every_pair, &s.shortest}) *b = in.index(2) != 0;
  s.max_contacts = in.index();
  for (std::uint64_t n = in.integer(); n > 0; --n) {
    Link l;
    l.parent = in.index();
    l.joint = static_cast<JointKind>(in.index(4));
    l.origin = in.pose();
    l.axis = in.vector();
    l.master = in.index();
    l.multiplier = in.number();
    l.offset = in.number();
    s.links.push_back(l);
  }
  for (std::uint64_t n = in.integer(); n > 0; --n) {
    s.q0.push_back(in.number());
    s.q1.push_back(in.number());
  }
  for (std::uint64_t n = in.integer(); n > 0; --n) {
    Body b;
    b.geometry = geometries[static_cast<std::size_t>(in.index(geometries.size()))];
    b.link = in.index();
    b.pose = in.pose();
    s.bodies.push_back(b);
  }
  for (std::uint64_t n = in.integer(); n > 0; --n) {
    const int a = in.index(s.bodies.size()), b = in.index(s.bodies.size());
    s.allowed.emplace(a, b);
  }
  return s;
}

}  // namespace

std::string toText(const std::vector<Scene>& scenes) {
  Writer out;
  std::map<const Geometry*, int> numbers;
  for (const Scene& s : scenes) {
    for (const Body& b : s.bodies) {
      if (numbers.emplace(b.geometry.get(), static_cast<int>(numbers.size())).second) write(*b.geometry, out);
    }
    write(s, numbers, out);
  }
  return out.text();
}

void writeFile(const std::string& text, const std::string& file) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  const bool written = out && std::fputs(text.c_str(), out) >= 0;
  if (!out || std::fclose(out) != 0 || !written) throw std::runtime_error("can't write '" + file + "'");
}

std::vector<Scene> readScenes(const std::string& file) {
  Reader in(file);
  std::vector<GeometryPtr> geometries;
  std::vector<Scene> scenes;
  for (std::string what; in.next(what);) {
    if (what == "geometry") {
      geometries.push_back(readGeometry(in));
    } else if (what == "scene") {
      scenes.push_back(readScene(geometries, in));
    } else {
      in.fail();
    }
  }
  return scenes;
}

}  // namespace campaign
