// SPDX-License-Identifier: BSD-3-Clause
// The formats: worlds, motions and records, read strictly. No motion is proven free here. But the data on which proofs
// rest are made here, with their bounds: axes, rotations, closed surfaces, who is ignored until when.
#include <algorithm>

#include "places.h"
#include "proof.h"

namespace verify {
namespace {

const char* const kRoles[] = {"link", "carried", "obstacle"};

constexpr std::size_t kMostLines = 200u << 20;  // numbers of lines and entries are 32 bits wide

/// Whether a proper rotation is certainly within 2^-49 of the numbers in each entry: without one, the claim would be
/// about nothing at all. With R = U diag(s) V^T, singular values s >= 0, U V^T is the nearest orthogonal matrix Q, and
/// entries of R - Q = U diag(s - 1) V^T are at most max |s - 1|. The symmetric R R^T - I has the eigenvalues s^2 - 1,
/// none of which is beyond its Frobenius norm e: |s - 1| = |s^2 - 1| / (s + 1) <= e / (2 - e). So e^2 < 2^-96 is
/// enough: in whole ulps of 2^-64 it is then at most 2^32 - 1, so e < 2^-48 (1 - 2^-34), and e / (2 - e) < 2^-49. det Q
/// is the sign of det R. Errors of the products are in the bounds.
bool isNearRotation(const double numbers[9]) {
  for (int k = 0; k < 9; ++k)
    if (!(std::fabs(numbers[k]) < 2)) return false;
  Vec row[3];
  for (std::size_t i = 0; i < 9; ++i) row[i / 3][i % 3] = exactly(numbers[i]);
  Int squares = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Fix off = bound(dot(row[i], row[j]) - constant(integer(i == j)));
      if (off > Fix{1 << 16}) return false;  // so that no square is too large
      squares += off.v * off.v;
    }
  return squares < Int{1} << 32 && sign(determinant(row[0], row[1], row[2])) > 0;
}

/// The lines of a text, each cut into words at single spaces.
class Lines {
 public:
  Lines(std::string_view text, const char* what) : text_(text), what_(what) {}

  /// Goes to the next line that is no comment. @return false at the end.
  bool next() {
    while (at_ < text_.size()) {
      std::size_t end = text_.find('\n', at_);
      if (end == std::string_view::npos) fail("the last line has no end");
      line_ = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      if (line_.empty() || line_[0] != '#') {
        rest_ = line_;
        more_ = true;
        return true;
      }
    }
    return false;
  }
  bool more() const { return more_; }
  std::string_view word() {
    if (!more_) fail("a word is missing");
    const std::size_t space = rest_.find(' ');
    const std::string_view word = rest_.substr(0, space);
    more_ = space != std::string_view::npos;
    rest_ = more_ ? rest_.substr(space + 1) : std::string_view();
    if (word.empty()) fail("words are separated by one space");
    return word;
  }
  /// Takes back a word of this line.
  void back(std::string_view word) {
    const char* const end = line_.data() + line_.size();
    rest_ = std::string_view(word.data(), static_cast<std::size_t>(end - word.data()));
    more_ = true;
  }
  void end() {
    if (more_) fail("there are too many words");
  }
  /// An integer from 0 to `below` - 1.
  std::size_t integer(std::size_t below) {
    const std::string_view text = word();
    std::size_t value = 0;
    for (const char c : text) {
      if (c < '0' || c > '9' || text.size() > 9) fail("'" + std::string(text.substr(0, 40)) + "' is no number here");
      value = 10 * value + static_cast<std::size_t>(c - '0');
    }
    if (value >= below) fail("the number " + std::string(text) + " is not below " + std::to_string(below));
    return value;
  }
  /// A count of lines to come: at least `shortest` bytes each, so that memory is bounded by the text's length.
  std::size_t count(std::size_t shortest) {
    const std::size_t n = integer(kMostLines);
    if (n == 0) fail("the count is 0");
    if (n > (text_.size() - at_) / shortest) fail("the text has fewer lines than the count says");
    return n;
  }
  /// A hexadecimal floating-point constant that is a double exactly and in the verifier's range.
  double number() {
    const std::string_view all = word();
    std::string_view text = all;
    const auto wrong = [&]() {
      fail("'" + std::string(all.substr(0, 60)) + "' is no hexadecimal constant of a double");
    };
    const bool negative = !text.empty() && text[0] == '-';
    if (negative) text.remove_prefix(1);
    if (text.size() < 3 || text[0] != '0' || text[1] != 'x') wrong();
    text.remove_prefix(2);
    std::uint64_t mantissa = 0;
    int exponent = 0, digits = 0;
    bool point = false;
    while (!text.empty() && text[0] != 'p') {
      const char c = text[0];
      text.remove_prefix(1);
      if (c == '.' && !point) {
        point = true;
        continue;
      }
      const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
      if (digit < 0 || ++digits > 15) wrong();
      mantissa = mantissa << 4 | static_cast<std::uint64_t>(digit);
      if (point) exponent -= 4;
    }
    if (digits == 0) wrong();
    if (!text.empty()) {
      text.remove_prefix(1);
      const bool down = !text.empty() && text[0] == '-';
      if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
      if (text.empty() || text.size() > 4) wrong();
      int p = 0;
      for (const char c : text) {
        if (c < '0' || c > '9') wrong();
        p = 10 * p + (c - '0');
      }
      exponent += down ? -p : p;
    }
    while (mantissa != 0 && (mantissa & 1) == 0) {
      mantissa >>= 1;
      ++exponent;
    }
    if (mantissa >= std::uint64_t{1} << 53) wrong();
    const double value = std::ldexp(static_cast<double>(mantissa), exponent);
    if (std::ldexp(value, -exponent) != static_cast<double>(mantissa)) wrong();  // it left the doubles
    if (value > 1099511627776.0) fail("the number " + std::string(all.substr(0, 40)) + " is beyond 2^40");
    return negative ? -value : value;
  }
  /// Nine numbers near a rotation.
  void rotation(double numbers[9]) {
    for (int k = 0; k < 9; ++k) numbers[k] = number();
    if (!isNearRotation(numbers))
      fail("the nine numbers are not known to be a rotation's: R R^T is 2^-48 off the identity, or det R not above 0");
  }
  double notNegative() {
    const double value = number();
    if (value < 0) fail("a number is negative");
    return value;
  }
  /// A name, with its escapes resolved.
  std::string name() {
    const std::string_view text = word();
    std::string name;
    for (std::size_t k = 0; k < text.size(); ++k) {
      const auto c = static_cast<unsigned char>(text[k]);
      if (c < 33 || c > 126) fail("a name has a byte that is not escaped");
      if (c != '%') {
        name += static_cast<char>(c);
        continue;
      }
      const auto digit = [&](std::size_t at) {
        const char h = at < text.size() ? text[at] : 0;
        if (h >= '0' && h <= '9') return h - '0';
        if (h >= 'a' && h <= 'f') return h - 'a' + 10;
        if (h >= 'A' && h <= 'F') return h - 'A' + 10;
        fail("a name has a % without two digits after it");
      };
      name += static_cast<char>(16 * digit(k + 1) + digit(k + 2));
      k += 2;
    }
    return name;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw BadInput(std::string(what_) + ", line " + std::to_string(number_) + ": " + why);
  }

 private:
  std::string_view text_, line_, rest_;
  const char* what_;
  std::size_t at_ = 0, number_ = 0;
  bool more_ = false;
};

void readGeometry(Lines& lines, Geometry& g) {
  const std::string_view kind = lines.word();
  const auto numbers = [&](Geometry::Kind k, int n, bool sizes) {
    g.kind = k;
    for (int i = 0; i < n; ++i) g.numbers.push_back(sizes ? lines.notNegative() : lines.number());
  };
  if (kind == "mesh") {
    g.kind = Geometry::mesh;
    const std::string_view what = lines.word();
    if (what != "surface" && what != "solid") lines.fail("a mesh is 'surface' or 'solid'");
    g.solid = what == "solid";
  } else if (kind == "boxes") {
    g.kind = Geometry::boxes;
  } else if (kind == "hull") {
    g.kind = Geometry::hull;
  } else if (kind == "box") {
    numbers(Geometry::box, 3, true);
  } else if (kind == "sphere") {
    numbers(Geometry::sphere, 1, true);
  } else if (kind == "ellipsoid") {
    numbers(Geometry::ellipsoid, 3, true);
  } else if (kind == "capsule") {
    numbers(Geometry::capsule, 2, true);
  } else if (kind == "cylinder") {
    numbers(Geometry::cylinder, 2, true);
  } else if (kind == "cone") {
    numbers(Geometry::cone, 2, true);
  } else if (kind == "halfspace" || kind == "plane") {
    numbers(kind == "plane" ? Geometry::plane : Geometry::halfspace, 4, false);
    if (g.numbers[0] == 0 && g.numbers[1] == 0 && g.numbers[2] == 0) lines.fail("the normal is the zero vector");
  } else {
    lines.fail("there is no geometry '" + std::string(kind.substr(0, 40)) + "'");
  }
  lines.end();
  const auto list = [&](const char* what, std::size_t shortest) {
    if (!lines.next() || lines.word() != what) lines.fail(std::string("'") + what + "' is missing");
    const std::size_t n = lines.count(shortest);
    lines.end();
    return n;
  };
  const auto rows = [&](std::size_t n, std::size_t width, std::vector<double>& into) {
    into.reserve(n * width);
    for (std::size_t i = 0; i < n; ++i) {
      if (!lines.next()) lines.fail("a line is missing");
      for (std::size_t k = 0; k < width; ++k) into.push_back(k < 3 ? lines.number() : lines.notNegative());
      lines.end();
    }
  };
  if (g.kind == Geometry::mesh || g.kind == Geometry::hull) rows(list("vertices", 12), 3, g.vertices);
  if (g.kind == Geometry::mesh) {
    const std::size_t n = list("triangles", 6);
    g.triangles.reserve(3 * n);
    for (std::size_t i = 0; i < n; ++i) {
      if (!lines.next()) lines.fail("a line is missing");
      for (int k = 0; k < 3; ++k)
        g.triangles.push_back(static_cast<std::uint32_t>(lines.integer(g.vertices.size() / 3)));
      lines.end();
    }
    std::vector<char> used(g.vertices.size() / 3, 0);
    for (const std::uint32_t v : g.triangles) used[v] = 1;
    if (std::count(used.begin(), used.end(), 0) > 0) lines.fail("a vertex of this mesh is that of no triangle");
  }
  if (g.kind == Geometry::boxes) rows(list("cells", 24), 6, g.cells);
  g.prepare();
  if (g.solid && !g.joinSurfaces())
    lines.fail("the surface of this 'mesh solid' is not closed, or its triangles do not face the same way");
}

void readElement(Lines& lines, std::string_view kind, std::size_t variables, Frame& frame) {
  Element e{};
  if (kind == "rotate") {
    e.kind = Element::rotate;
    e.variable = static_cast<int>(lines.integer(variables));
    if (static_cast<std::size_t>(e.variable) + 2 >= variables) lines.fail("'rotate' takes three variables");
  } else {
    e.kind = kind == "turn" ? Element::turn : Element::slide;
    for (double& x : e.axis) x = lines.number();
    e.variable = static_cast<int>(lines.integer(variables));
    e.multiplier = lines.number();
    e.offset = lines.number();
    Fix unit[3];
    unitVector(e.axis, unit);
    const bool coordinate = isCoordinateAxis(e.axis);
    for (int k = 0; k < 3; ++k)
      e.unit[k] = coordinate ? constant(integer((e.axis[k] > 0) - (e.axis[k] < 0)))
                             : constant(unit[k], ulps(2) + Fix{kOne >> kAxisBits});
    for (int k = 0; k < 9; ++k) e.products[k] = e.unit[k / 3] * e.unit[k % 3];
  }
  lines.end();
  frame.elements.push_back(e);
}

/// Refuses lines without a meaning: whoever wrote them meant something else.
void refuseUnused(const World& world) {
  std::vector<char> there(world.names.size(), 0), used(world.geometries.size(), 0);
  for (const Body& body : world.bodies) {
    there[static_cast<std::size_t>(body.name_id)] = 1;
    used[static_cast<std::size_t>(body.geometry)] = 1;
  }
  for (std::size_t k = 0; k < there.size(); ++k)
    if (!there[k])
      throw BadInput("world: 'margin', 'tolerance' or 'unchecked' names " + inQuotes(world.names[k]) +
                     ": no body is called so");
  for (std::size_t k = 0; k < used.size(); ++k)
    if (!used[k]) throw BadInput("world: no body has the geometry " + std::to_string(k));
  for (const auto& [pair, listed] : world.unchecked)
    if (listed.pairs == 0)
      throw BadInput("world: 'unchecked' of " + inQuotes(world.names[static_cast<std::size_t>(pair.first)]) + " and " +
                     inQuotes(world.names[static_cast<std::size_t>(pair.second)]) +
                     ": no two bodies of these names would be checked");
}

/// A line `tolerance` after its first word. @param idOf  the number of a name.
template <class IdOf>
void readTolerance(Lines& lines, const IdOf& idOf, World& world) {
  const std::string_view kind = lines.word();
  bool is_new = false;
  double most = 0;
  const auto number = [&](std::map<int, double>& list) {
    const int variable = static_cast<int>(lines.integer(world.variables.size()));
    is_new = list.emplace(variable, most = lines.notNegative()).second;
  };
  const auto pose = [&](std::map<int, PoseTolerance>& list, int of) {
    PoseTolerance t{lines.notNegative(), lines.notNegative(), {}};
    for (double& x : t.pivot) x = lines.number();
    most = std::max(t.length, t.angle);
    is_new = list.emplace(of, t).second;
  };
  if (kind == "variable") {
    number(world.variable_tolerances);
  } else if (kind == "vector") {
    const int variable = static_cast<int>(lines.integer(world.variables.size()));
    const int count = static_cast<int>(lines.integer(4));
    if (count < 2) lines.fail("a vector has two or three variables");
    is_new = world.vector_tolerances.emplace(variable, VectorTolerance{count, most = lines.notNegative()}).second;
  } else if (kind == "rotation") {
    number(world.rotation_tolerances);
  } else if (kind == "frame") {
    const int frame = static_cast<int>(lines.integer(world.frames.size()));
    if (frame == 0) lines.fail("frame 0 is the world");
    pose(world.frame_tolerances, frame);
  } else if (kind == "body") {
    const int name = idOf(lines.name());
    pose(world.body_tolerances, name);
  } else if (kind == "speed") {
    const int name = idOf(lines.name());
    const Speed speed{most = lines.notNegative(), lines.number()};
    is_new = world.speeds.emplace(name, speed).second;
  } else {
    lines.fail("a tolerance is of a variable, vector, rotation, frame, body or speed");
  }
  if (!is_new) lines.fail("the tolerance is there already");
  if (most == 0) lines.fail("a tolerance is above 0");
}

World readWorldText(std::string_view text) {
  World world;
  world.hash = sha256(text);
  Lines lines(text, "world");
  if (!lines.next() || text.substr(0, 18) != "fcl_artic world 1\n")
    lines.fail("the first line is not 'fcl_artic world 1'");
  Frame ground{};
  ground.name = "world";
  world.frames.push_back(ground);
  std::map<std::string, int> ids;
  const auto idOf = [&](std::string name) {
    const auto added = ids.emplace(std::move(name), static_cast<int>(world.names.size()));
    if (added.second) world.names.push_back(added.first->first);
    return added.first->second;
  };
  while (lines.next()) {
    const std::string_view kind = lines.word();
    if (kind == "variable") {
      world.variables.push_back(lines.name());
    } else if (kind == "frame") {
      Frame frame{};
      frame.name = lines.name();
      frame.parent = static_cast<int>(lines.integer(world.frames.size()));
      frame.depth = world.frames[frame.parent].depth + 1;
      if (frame.depth > 1000) lines.fail("a chain of more than 1000 frames is not read");
      lines.rotation(frame.numbers);
      for (int k = 9; k < 12; ++k) frame.numbers[k] = lines.number();
      frame.origin = statedPose(frame.numbers);
      world.frames.push_back(std::move(frame));
    } else if (kind == "turn" || kind == "slide" || kind == "rotate") {
      if (world.frames.size() == 1) lines.fail("an element comes after its frame");
      readElement(lines, kind, world.variables.size(), world.frames.back());
      continue;
    } else if (kind == "geometry") {
      world.geometries.emplace_back();
      readGeometry(lines, world.geometries.back());
      continue;
    } else if (kind == "body") {
      Body body{};
      const std::string_view role = lines.word();
      const auto* const known = std::find(std::begin(kRoles), std::end(kRoles), role);
      if (known == std::end(kRoles)) lines.fail("a body's role is link, carried or obstacle");
      body.role = static_cast<Role>(known - kRoles);
      body.name = lines.name();
      body.name_id = idOf(body.name);
      body.frame = static_cast<int>(lines.integer(world.frames.size()));
      body.geometry = static_cast<int>(lines.integer(world.geometries.size()));
      lines.rotation(body.numbers);
      for (int k = 9; k < 12; ++k) body.numbers[k] = lines.number();
      body.pose = statedPose(body.numbers);
      world.bodies.push_back(std::move(body));
    } else if (kind == "margin") {
      const int a = idOf(lines.name());
      std::string_view second = lines.word();
      if (lines.more()) {
        lines.back(second);
        const int b = idOf(lines.name());
        if (!world.pair_margins.emplace(std::minmax(a, b), lines.notNegative()).second)
          lines.fail("the pair has a margin already");
      } else {
        lines.back(second);
        if (!world.margins.emplace(a, lines.notNegative()).second) lines.fail("the name has a margin already");
      }
    } else if (kind == "tolerance") {
      readTolerance(lines, idOf, world);
    } else if (kind == "unchecked") {
      const std::string_view reason = lines.word();
      Reason why = Reason::allowed;
      if (reason == "neighbours") {
        why = Reason::neighbours;
      } else if (reason == "still") {
        why = Reason::still;
      } else if (reason == "touch-link") {
        why = Reason::touch_link;
      } else if (reason != "allowed") {
        lines.fail("the reason is still, neighbours, allowed or touch-link");
      }
      const int a = idOf(lines.name()), b = idOf(lines.name());
      if (!world.unchecked.emplace(std::minmax(a, b), Unchecked{why}).second) lines.fail("the pair is listed already");
    } else {
      lines.fail("there is no item '" + std::string(kind.substr(0, 40)) + "'");
    }
    lines.end();
  }
  world.moves.assign(world.variables.size(), 0);
  world.turns = world.moves;
  for (const Frame& frame : world.frames)
    for (const Element& e : frame.elements) {
      const auto v = static_cast<std::size_t>(e.variable);
      for (std::size_t k = 0; k < (e.kind == Element::rotate ? 3 : 1); ++k) world.moves[v + k] = 1;
      if (e.kind == Element::rotate) world.turns[v] = 1;
    }
  const auto solid = [](const Geometry& g) { return g.solid; };
  if (std::any_of(world.geometries.begin(), world.geometries.end(), solid))
    for (Geometry& g : world.geometries)
      if (!g.solid) g.joinSurfaces();
  deriveGives(world);
  derivePairs(world);
  refuseUnused(world);
  return world;
}

/// The rest of a line `clock` of the last piece. The clock goes on where it was at the end of the piece before.
void readClock(Lines& lines, const World& world, Motion& motion) {
  Piece& piece = motion.pieces.back();
  if (world.speeds.empty()) lines.fail("no body has a speed: a clock means nothing");
  if (piece.has_clock) lines.fail("a piece has one clock");
  piece.has_clock = true;
  for (double& x : piece.clock) x = lines.number();
  const bool first = motion.pieces.size() == 1;
  const double before = first ? 0 : motion.pieces[motion.pieces.size() - 2].clock[1];
  if (piece.clock[0] != before)
    lines.fail(first ? "the motion's clock begins at 0"
                     : "the clock is another one than at the end of the piece before");
  if (piece.clock[1] < piece.clock[0]) lines.fail("the clock goes back");
}

}  // namespace

World readWorld(std::string_view text) {
  try {
    return readWorldText(text);
  } catch (const NotProven& error) {  // a sum that leaves the range
    throw BadInput(std::string("world: ") + error.what());
  }
}

Motion readMotion(std::string_view text, const World& world) {
  Motion motion;
  motion.hash = sha256(text);
  Lines lines(text, "motion");
  if (!lines.next() || text.substr(0, 19) != "fcl_artic motion 1\n")
    lines.fail("the first line is not 'fcl_artic motion 1'");
  bool seen[6] = {};
  const auto once = [&](int item) {
    if (seen[item]) lines.fail("the item is there already");
    if (!motion.pieces.empty()) lines.fail("the item comes before the first piece");
    seen[item] = true;
  };
  while (lines.next()) {
    const std::string_view kind = lines.word();
    if (kind == "world") {
      once(0);
      motion.world = std::string(lines.word());
    } else if (kind == "margin") {
      once(1);
      motion.margin = lines.notNegative();
    } else if (kind == "added") {
      once(2);
      motion.added = lines.notNegative();
    } else if (kind == "scope") {
      once(3);
      while (lines.more()) {
        const std::string_view what = lines.word();
        bool* const flag = what == "self" ? &motion.self : what == "scene" ? &motion.scene : nullptr;
        if (flag == nullptr || *flag) lines.fail("the scope is self, scene or both");
        *flag = true;
      }
    } else if (kind == "duration") {
      once(4);
      motion.duration = lines.number();
    } else if (kind == "until") {
      once(5);
      motion.until = lines.number();
      if (!(motion.until >= 0 && motion.until <= 1)) lines.fail("'until' is in [0, 1]");
    } else if (kind == "piece") {
      motion.pieces.emplace_back();
    } else if (kind == "q" || kind == "orientation" || kind == "ignored" || kind == "clock") {
      if (motion.pieces.empty()) lines.fail("a 'piece' comes first");
      Piece& piece = motion.pieces.back();
      if (kind == "clock") {
        readClock(lines, world, motion);
        lines.end();
        continue;
      }
      if (kind == "ignored") {
        const int a = static_cast<int>(lines.integer(world.bodies.size())),
                  b = static_cast<int>(lines.integer(world.bodies.size()));
        const double until = lines.number();
        lines.end();
        if (a >= b) lines.fail("of an ignored pair the lower number comes first");
        if (!(until >= 0 && until <= 1)) lines.fail("the time is in [0, 1]");
        const std::vector<Partner>& list = world.partners[static_cast<std::size_t>(b)];
        const auto at =
            std::lower_bound(list.begin(), list.end(), a, [](const Partner& p, int body) { return p.body < body; });
        if (at == list.end() || at->body != a || !(at->self ? motion.self : motion.scene))
          lines.fail("the pair is not checked anyway");
        double& latest = piece.ignored[{a, b}];
        latest = std::max(latest, until);
        continue;
      }
      const int variable = static_cast<int>(lines.integer(world.variables.size()));
      bool is_new;
      if (kind == "q") {
        std::vector<double> q;
        while (lines.more()) q.push_back(lines.number());
        if (q.empty() || q.size() > 6) lines.fail("a polynomial has 1 to 6 coefficients");
        if (!world.moves[static_cast<std::size_t>(variable)]) lines.fail("the variable moves nothing");
        is_new = piece.polynomials.emplace(variable, std::move(q)).second;
      } else {
        std::array<double, 9> R;
        lines.rotation(R.data());
        if (!world.turns[static_cast<std::size_t>(variable)]) lines.fail("the variable is not that of a 'rotate'");
        is_new = piece.orientations.emplace(variable, R).second;
      }
      if (!is_new) lines.fail("a piece states a variable twice");
    } else {
      lines.fail("there is no item '" + std::string(kind.substr(0, 40)) + "'");
    }
    lines.end();
  }
  for (const int item : {0, 1, 3, 5})
    if (!seen[item]) lines.fail("one of world, margin, scope, until is missing");
  if (!motion.self && !motion.scene) lines.fail("the scope is empty: nothing is claimed");
  if (motion.pieces.empty()) lines.fail("there is no piece");
  for (const Piece& piece : motion.pieces)
    if (piece.has_clock == world.speeds.empty()) lines.fail("bodies have speeds, and a piece has no 'clock'");
  return motion;
}

const char* nameOf(Role role) {
  return kRoles[static_cast<int>(role)];
}
const char* nameOf(Reason reason) {
  static const char* const kNames[kReasons] = {"same frame", "two obstacles", "still against each other",
                                               "neighbours", "allowed",       "touch-link",
                                               "scope",      "ignored"};
  return kNames[static_cast<int>(reason)];
}

std::string inQuotes(std::string_view name) {
  std::string text = "'";
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 32 || byte > 126 || c == '\'' || c == '\\') {
      const char* const digits = "0123456789abcdef";
      text += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
    } else {
      text += c;
    }
  }
  return text + "'";
}

std::string World::describe(int body) const {
  return std::string(nameOf(bodies[body].role)) + " " + inQuotes(bodies[body].name) + " (body " + std::to_string(body) +
         ")";
}

std::uint8_t Bytes::peek() const {
  if (empty()) throw BadInput("the proof ends too early");
  return static_cast<std::uint8_t>(bytes_[at_]);
}
std::string_view Bytes::take(std::size_t n) {
  if (n > left()) throw BadInput("the proof ends too early");
  at_ += n;
  return bytes_.substr(at_ - n, n);
}
std::uint64_t Bytes::little(int n) {
  const std::string_view bytes = take(static_cast<std::size_t>(n));
  std::uint64_t value = 0;
  for (int k = n; k-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(k)]);
  return value;
}
std::int64_t Bytes::signedLittle(int n) {
  const std::uint64_t value = little(n), sign = static_cast<std::uint64_t>(1) << (8 * n - 1);
  return static_cast<std::int64_t>(value & (sign - 1)) - static_cast<std::int64_t>(value & sign);
}
std::uint32_t Bytes::varint() {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    const std::uint8_t b = byte();
    value |= static_cast<std::uint64_t>(b & 127) << shift;
    if ((b & 128) == 0) {
      if (value >> 32 != 0 || (b == 0 && shift > 0)) break;
      return static_cast<std::uint32_t>(value);
    }
  }
  throw BadInput("a varint has more than 32 bits or is not in its shortest form");
}

std::vector<OutsidePoint> Bytes::outsidePoints() {
  std::vector<OutsidePoint> points;
  for (std::uint32_t n = varint(); n > 0; --n) {
    const std::uint32_t piece = varint();
    points.push_back({piece, byte()});
    if (points.back().side > 5) throw BadInput("SOLID names a side that is not there");
  }
  return points;
}

std::vector<Record> splitRecords(std::string_view file) {
  std::vector<Record> records;
  Bytes bytes(file);
  const auto text = [&]() { return bytes.take(bytes.little(4)); };
  while (!bytes.empty()) {
    const std::string_view version = bytes.take(4);
    if (version == "FAC1")
      throw BadInput("a record is of format 1, which this verifier does not read: ask for it anew");
    if (version != "FAC2") throw BadInput("a record does not begin with FAC2");
    Record record;
    record.motion = text();
    record.proof = text();
    records.push_back(record);
  }
  return records;
}

}  // namespace verify
