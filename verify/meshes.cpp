// SPDX-License-Identifier: BSD-3-Clause
#include "meshes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>

#include "readers.h"
#include "xml.h"

namespace verify {
namespace {

// ---- STL

std::uint32_t little32(const std::string& bytes, std::size_t at) {
  std::uint32_t x = 0;
  for (std::size_t k = 0; k < 4; ++k)
    x |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + k])) << 8 * k;
  return x;
}

/// A head of 80 bytes, a count, and for each triangle a normal, three corners and two bytes: nothing after it.
bool isBinaryStl(const std::string& bytes) {
  return bytes.size() > 84 && bytes.size() == 84 + 50 * static_cast<std::uint64_t>(little32(bytes, 80));
}

void addTriangle(MeshFile& mesh) {
  const auto n = static_cast<std::uint32_t>(mesh.points.size() / 3);
  mesh.corners.insert(mesh.corners.end(), {n - 3, n - 2, n - 1});
  mesh.ends.push_back(mesh.corners.size());
}

MeshFile readBinaryStl(const std::string& bytes) {
  MeshFile mesh;
  for (std::size_t at = 84; at < bytes.size(); at += 50) {
    for (std::size_t k = 0; k < 9; ++k) {
      const std::uint32_t bits = little32(bytes, at + 12 + 4 * k);
      float x = 0;
      std::memcpy(&x, &bits, sizeof x);
      if (!std::isfinite(x)) throw BadInput("an STL file has a number that is not finite");
      mesh.points.push_back(x);
    }
    addTriangle(mesh);
  }
  return mesh;
}

class Words {
 public:
  explicit Words(const std::string& text) : text_(text) {}
  /// Empty at the end.
  std::string next() {
    const std::size_t begin = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
    at_ = std::min(text_.find_first_of(kBlanks, begin), text_.size());
    return text_.substr(begin, at_ - begin);
  }
  std::string keyword() {
    std::string word = next();
    for (char& c : word)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return word;
  }
  /// The rest of a line, the name of a solid. @throws BadInput where facets or solids may stand in it.
  void passName() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    for (std::string last, word = keywordBefore(end); !word.empty(); last = word, word = keywordBefore(end))
      if (word == "solid" || word == "endsolid" || (last == "facet" && word == "normal"))
        throw BadInput("an STL file has '" + word + "' within the name of a solid");
  }

 private:
  std::string keywordBefore(std::size_t end) {
    const bool more = text_.find_first_not_of(kBlanks, at_) < end;
    if (!more) at_ = end;
    return more ? keyword() : std::string();
  }

  static constexpr const char* kBlanks = " \t\r\n\v\f";
  const std::string& text_;
  std::size_t at_ = 0;
};

/// @throws BadInput for anything else than solids of facets of one loop of three corners.
MeshFile readTextStl(const std::string& text) {
  MeshFile mesh;
  Words words(text);
  if (words.keyword() != "solid") throw BadInput("an STL file is neither binary nor text, or is cut short");
  words.passName();
  bool open = true;
  const auto expect = [&](const char* what) {
    if (words.keyword() != what) throw BadInput(std::string("an STL file has no '") + what + "' where it must");
  };
  for (std::string word = words.keyword(); !word.empty(); word = words.keyword()) {
    if (word == (open ? "endsolid" : "solid")) {
      open = !open;
      words.passName();
      continue;
    }
    if (word != "facet" || !open) throw BadInput("an STL file has something between its facets or solids");
    expect("normal");
    for (int k = 0; k < 3; ++k) words.next();
    expect("outer");
    expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      for (int k = 0; k < 3; ++k) mesh.points.push_back(decimal(words.next()));
    }
    expect("endloop");
    expect("endfacet");
    addTriangle(mesh);
  }
  if (open) throw BadInput("an STL file has no 'endsolid'");
  return mesh;
}

MeshFile readStl(const std::string& bytes) {
  if (!isBinaryStl(bytes)) return readTextStl(bytes);
  bool both = true;
  try {
    readTextStl(bytes);
  } catch (const BadInput&) {
    both = false;
  }
  if (both) throw BadInput("an STL file can be read as text and as binary");
  return readBinaryStl(bytes);
}

// ---- OBJ

/// Lines cut into words. One that ends in a backslash goes on in the next one, unless it has a comment.
class ObjLines {
 public:
  explicit ObjLines(const std::string& text) : text_(text) {}
  bool next(std::vector<std::string>& words) {
    words.clear();
    if (at_ >= text_.size()) return false;
    std::string line = take();
    while (goesOn(line)) {
      line.resize(line.find_last_of('\\'));
      const std::string more = take(), blanks = " \t\r\\";
      const std::size_t k = std::min(more.find_first_not_of(blanks), more.size());
      // Readers differ on whether a vertex or a face goes on with the name before it, or is one.
      if ((more[k] == 'v' || more[k] == 'f') && k + 1 < more.size() && blanks.find(more[k + 1]) != blanks.npos)
        throw BadInput(where() + "it goes on a line that ends in a backslash, and may be one by itself");
      line += ' ' + more;
    }
    line.resize(commentOf(line));
    for (std::size_t k = line.find_first_not_of(" \t\r"), to; k != line.npos; k = line.find_first_not_of(" \t\r", to)) {
      to = std::min(line.find_first_of(" \t\r", k), line.size());
      words.push_back(line.substr(k, to - k));
    }
    return true;
  }
  std::string where() const { return "an OBJ file, line " + std::to_string(number_) + ": "; }

 private:
  std::string take() {
    const std::size_t to = std::min(text_.find_first_of("\r\n", at_), text_.size());
    std::string line = text_.substr(at_, to - at_);
    at_ = to + (text_.compare(to, 2, "\r\n") == 0 ? 2 : 1);
    ++number_;
    return line;
  }
  bool goesOn(const std::string& line) const {
    const std::size_t last = line.find_last_not_of(" \t\r");
    return last != line.npos && line[last] == '\\' && at_ < text_.size() && commentOf(line) == line.size();
  }
  /// Where a comment begins: at a # that begins the line or follows a blank; within a word it is part of that (1.#INF).
  static std::size_t commentOf(const std::string& line) {
    std::size_t at = line.find('#');
    while (at != line.npos && at > 0 && line[at - 1] != ' ' && line[at - 1] != '\t') at = line.find('#', at + 1);
    return std::min(at, line.size());
  }
  const std::string& text_;
  std::size_t at_ = 0, number_ = 0;
};

std::uint32_t objIndex(const std::string& word, std::size_t before, std::size_t count, const std::string& where) {
  const std::string digits = word.substr(0, word.find('/'));
  const bool back = !digits.empty() && digits[0] == '-';
  std::size_t n = 0;
  bool good = digits.size() > (back ? 1u : 0u) && digits.size() < 12;
  for (std::size_t k = back ? 1 : 0; good && k < digits.size(); ++k) {
    good = digits[k] >= '0' && digits[k] <= '9';
    n = 10 * n + static_cast<std::size_t>(digits[k] - '0');
  }
  if (!good || n == 0 || n > (back ? before : count))
    throw BadInput(where + "'" + word.substr(0, 40) + "' names no vertex");
  return static_cast<std::uint32_t>(back ? before - n : n - 1);
}

MeshFile readObj(const std::string& text) {
  // Normals, textures, materials, groups, points and lines: no part of the surface.
  static const std::set<std::string> kPassedOver{"vt",     "vn",       "vp",       "g",          "s",        "o", "mg",
                                                 "usemtl", "mtllib",   "usemap",   "maplib",     "l",        "p", "lod",
                                                 "bevel",  "c_interp", "d_interp", "shadow_obj", "trace_obj"};
  MeshFile mesh;
  std::vector<std::string> words;
  for (ObjLines lines(text); lines.next(words);) {  // a face may name a vertex that comes after it
    if (words.empty() || words[0] == "f" || kPassedOver.count(words[0]) > 0) continue;
    if (words[0] != "v") throw BadInput(lines.where() + "'" + words[0].substr(0, 40) + "' is not compared");
    // x y z, x y z and the weight 1, or x y z and a colour, of which readers differ where its first entry may be a
    // weight
    if (words.size() < 4 || words.size() == 6 || words.size() > 8)
      throw BadInput(lines.where() + "a vertex has three numbers");
    if (words.size() % 3 == 2 && decimal(words[4]) != 1) throw BadInput(lines.where() + "a vertex has a weight");
    for (std::size_t k = 1; k < 4; ++k) mesh.points.push_back(decimal(words[k]));
    for (std::size_t k = 1; k < 4; ++k)
      if (!std::isfinite(mesh.points[mesh.points.size() - k])) throw BadInput(lines.where() + "a vertex is not finite");
  }
  std::size_t before = 0;
  for (ObjLines lines(text); lines.next(words);) {
    before += !words.empty() && words[0] == "v";
    if (words.size() < 4 || words[0] != "f") {
      if (words.size() == 1 && words[0] == "f") throw BadInput(lines.where() + "a face has no corner");
      continue;  // of one or two corners: no face
    }
    for (std::size_t k = 1; k < words.size(); ++k)
      mesh.corners.push_back(objIndex(words[k], before, mesh.points.size() / 3, lines.where()));
    mesh.ends.push_back(mesh.corners.size());
  }
  return mesh;
}

// ---- triangles

struct Corners {
  std::array<double, 3> x[3];
};
Corners cornersOf(const Triangle& t) {
  Corners c;
  for (std::size_t k = 0; k < 9; ++k) c.x[k / 3][k % 3] = t[k];
  return c;
}

Triangle triangle(const double* a, const double* b, const double* c) {
  const double* const from[5] = {a, b, c, a, b};
  Triangle best{};
  for (std::size_t first = 0; first < 3; ++first) {
    Triangle t;
    for (std::size_t k = 0; k < 9; ++k) t[k] = from[first + k / 3][k % 3] + 0.0;  // -0 becomes 0
    if (first == 0 || t < best) best = t;
  }
  return best;
}

/// Whether the third corner is within 2^-47 of the longest edge's length of that edge. @param longest  set to the edge
/// opposite to this corner.
bool hasNoArea(const Triangle& t, std::size_t& longest) {
  const Corners c = cornersOf(t);
  std::array<double, 3> edge[3];
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      edge[k][i] = c.x[(k + 2) % 3][i] - c.x[(k + 1) % 3][i];  // opposite to corner k
      size = std::max(size, std::fabs(edge[k][i]));
    }
  longest = 0;
  if (size == 0) return true;
  if (!std::isfinite(size)) return false;
  double most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    double square = 0;
    for (double& e : edge[k]) {
      e /= size;
      square += e * e;
    }
    if (square > most) most = square, longest = k;
  }
  // |u x v| <= 2^-48 l^2, and doubles round it by less than 2^-49 l^2.
  const std::array<double, 3>&u = edge[0], &v = edge[1];
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double entry = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    area += entry * entry;
  }
  return std::sqrt(area) <= std::ldexp(most, -48);
}

using Edge = std::array<double, 6>;
Edge edgeOf(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  Edge edge;
  std::copy(std::min(a, b).begin(), std::min(a, b).end(), edge.begin());
  std::copy(std::max(a, b).begin(), std::max(a, b).end(), edge.begin() + 3);
  return edge;
}

/// Whether triangles without area cover only edges, or corners, of the mesh. The longest edge of each, or both other
/// ones, must be edges of the mesh, or of another such triangle that has been found to be covered. Each step may be off
/// by 2^-47 of a length, so no more than 16 follow one after the other.
bool areEdgesOf(const std::vector<Triangle>& missing, const std::vector<Triangle>& mesh) {
  std::vector<Edge> edges;
  for (const Triangle& t : mesh) {
    const Corners c = cornersOf(t);
    for (std::size_t k = 0; k < 3; ++k) {
      edges.push_back(edgeOf(c.x[k], c.x[(k + 1) % 3]));
      edges.push_back(edgeOf(c.x[k], c.x[k]));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::map<Edge, int> more;  // and how many steps they are away
  constexpr int kMostSteps = 16, kNone = 1000;
  const auto steps = [&](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    const Edge edge = edgeOf(a, b);
    if (std::binary_search(edges.begin(), edges.end(), edge)) return 0;
    const auto found = more.find(edge);
    return found == more.end() ? kNone : found->second;
  };
  std::vector<Triangle> open = missing;
  for (int pass = 0; pass < kMostSteps && !open.empty(); ++pass) {
    std::vector<Triangle> left;
    for (const Triangle& t : open) {
      std::size_t k = 0;
      if (!hasNoArea(t, k)) return false;
      const Corners c = cornersOf(t);
      const auto &apex = c.x[k], &a = c.x[(k + 1) % 3], &b = c.x[(k + 2) % 3];
      const int n = std::min(steps(a, b), std::max(steps(a, apex), steps(apex, b))) + 1;
      if (n > kMostSteps) {
        left.push_back(t);
        continue;
      }
      for (const auto& [x, y] : {std::pair(a, b), std::pair(a, apex), std::pair(apex, b)})
        if (steps(x, y) > n) more[edgeOf(x, y)] = n;
    }
    if (left.size() == open.size()) return false;
    open = std::move(left);
  }
  return open.empty();
}

}  // namespace

MeshFile readMesh(const std::string& path) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending != ".stl" && ending != ".obj") throw BadInput("'" + path + "' is not compared: it is neither STL nor OBJ");
  try {
    MeshFile mesh = ending == ".stl" ? readStl(readFile(path)) : readObj(readFile(path));
    if (mesh.ends.empty()) throw BadInput("it has no faces");
    return mesh;
  } catch (const BadInput& error) {
    throw BadInput("'" + path + "' is not compared: " + error.what());
  }
}

MeshComparison::MeshComparison(const World& world) {
  for (const Geometry& g : world.geometries) steps_left_ += 20 * g.triangles.size();
}

void MeshComparison::spend(std::uint64_t steps) {
  if (steps > steps_left_) throw BadInput("the meshes are not compared: it would be too much work");
  steps_left_ -= steps;
}

MeshComparison::Sorted MeshComparison::inOrder(std::vector<Triangle> triangles) {
  Sorted sorted;
  std::sort(triangles.begin(), triangles.end());
  std::string bytes;
  for (const Triangle& t : triangles) {
    std::size_t longest = 0;
    if (hasNoArea(t, longest)) {
      sorted.flat.push_back(t);
    } else {
      bytes.append(reinterpret_cast<const char*>(t.data()), sizeof t);
    }
  }
  sorted.hash = sha256(bytes);
  sorted.all = std::move(triangles);
  return sorted;
}

const MeshComparison::File& MeshComparison::file(const std::string& path, const std::vector<double>& scale) {
  const auto [entry, is_new] = files_.try_emplace({path, scale});
  File& file = entry->second;
  if (!is_new) return file;
  const auto [read, first] = read_.try_emplace(path);
  if (first) read->second = readMesh(path);
  file.faces = read->second;
  spend(file.faces.corners.size());
  for (std::size_t factor = 0; factor < scale.size(); factor += 3)
    for (std::size_t k = 0; k < file.faces.points.size(); ++k) file.faces.points[k] *= scale[factor + k % 3];
  std::vector<Triangle> fans;
  std::size_t begin = 0;
  const auto point = [&](std::size_t k) {
    return &file.faces.points[3 * static_cast<std::size_t>(file.faces.corners[k])];
  };
  for (const std::size_t end : file.faces.ends) {
    file.polygons = file.polygons || end - begin > 3;
    for (std::size_t k = begin + 1; k + 1 < end; ++k) fans.push_back(triangle(point(begin), point(k), point(k + 1)));
    begin = end;
  }
  file.sorted = inOrder(std::move(fans));
  return file;
}

// Whoever cuts a polygon into triangles cuts off one corner after the other, each with a triangle of the mesh. If the
// polygon is plane, the triangles that are cut off so cover it. The polygon winds once around each point inside, and
// that is the sum of the triangles' windings around the point.
bool MeshComparison::cut(const File& file, const Sorted& mesh, bool solid, std::vector<Triangle>& missing) {
  std::map<Triangle, std::size_t> left;
  for (const Triangle& t : mesh.all) ++left[t];
  spend(file.faces.corners.size() + mesh.all.size());
  const auto take = [&](const Triangle& t) {
    const auto found = left.find(t);
    if (found == left.end() || found->second == 0) return false;
    --found->second;
    return true;
  };
  const auto leaveOut = [&](const Triangle& t) {
    std::size_t longest = 0;
    if (solid || !hasNoArea(t, longest)) return false;
    missing.push_back(t);
    return true;
  };
  std::size_t begin = 0;
  for (const std::size_t end : file.faces.ends) {
    std::vector<const double*> polygon;
    for (std::size_t k = begin; k < end; ++k)
      polygon.push_back(&file.faces.points[3 * static_cast<std::size_t>(file.faces.corners[k])]);
    begin = end;
    std::size_t tried = 0;
    for (std::size_t k = 0; polygon.size() > 3;) {
      const std::size_t n = polygon.size();
      spend(1);
      k %= n;
      const Triangle t = triangle(polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]);
      if (tried < n ? take(t) : leaveOut(t)) {
        polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>((k + 1) % n));
        if ((k + 1) % n < k) --k;
        tried = 0;
        spend(n / 16);
        continue;
      }
      ++k;
      if (++tried == 2 * n) return false;
    }
    const Triangle last = triangle(polygon[0], polygon[1], polygon[2]);
    if (!take(last) && !leaveOut(last)) return false;
  }
  return std::all_of(left.begin(), left.end(), [](const auto& t) { return t.second == 0; });
}

bool MeshComparison::same(const Geometry& mesh, int number, const std::string& path, const std::vector<double>& scale,
                          std::size_t& missing) {
  const auto [entry, is_new] = meshes_.try_emplace(number);
  if (is_new) {
    std::vector<Triangle> triangles;
    const auto point = [&](std::size_t k) { return &mesh.vertices[3 * static_cast<std::size_t>(mesh.triangles[k])]; };
    for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3)
      triangles.push_back(triangle(point(t), point(t + 1), point(t + 2)));
    entry->second = inOrder(std::move(triangles));
  }
  const File& file = this->file(path, scale);
  const auto [answer, unknown] = known_.try_emplace({number, &file});
  if (unknown) answer->second.first = compare(mesh, entry->second, file, answer->second.second);
  missing = answer->second.second;
  return answer->second.first;
}

bool MeshComparison::compare(const Geometry& mesh, const Sorted& stated, const File& file, std::size_t& missing) {
  std::vector<Triangle> out;
  const std::vector<Triangle>&in_file = file.sorted.flat, &in_mesh = stated.flat;
  const bool fans = stated.hash == file.sorted.hash &&
                    std::includes(in_file.begin(), in_file.end(), in_mesh.begin(), in_mesh.end()) &&
                    (!mesh.solid || in_file.size() == in_mesh.size());
  if (fans)
    std::set_difference(in_file.begin(), in_file.end(), in_mesh.begin(), in_mesh.end(), std::back_inserter(out));
  else if (!file.polygons || !cut(file, stated, mesh.solid, out))
    return false;
  missing = out.size();
  spend(out.empty() ? 0 : stated.all.size());
  return out.empty() || areEdgesOf(out, stated.all);
}

}  // namespace verify
