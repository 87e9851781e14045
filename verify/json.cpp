// SPDX-License-Identifier: BSD-3-Clause
// A record for people. Nothing is proven here.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "report.h"

namespace verify {
namespace {

/// A double's bits as a JSON number; as a string where JSON has none.
std::string number(std::uint64_t bits) {
  double x = 0;
  std::memcpy(&x, &bits, sizeof x);
  char text[40];
  std::snprintf(text, sizeof text, std::isfinite(x) ? "%.17g" : "\"%g\"", x);
  return text;
}

std::string vector(Bytes& bytes, int width) {
  std::string s = "[";
  for (int k = 0; k < 3; ++k) s += (k ? ", " : "") + std::to_string(bytes.signedLittle(width));
  return s + "]";
}

std::string node(Bytes& bytes, int depth) {
  if (depth > kMostDepth) throw BadInput("the proof is too deep to print");
  const std::uint8_t kind = bytes.byte();
  static const char* const kFrames[] = {"world", "own", "partner"};
  if (kind < kSepFine + 3) {
    const int width = kind < kSepFine ? 2 : 4;
    return "{\"sep\": " + vector(bytes, width) + ", \"frame\": \"" + kFrames[kind % 3] + "\"}";
  }
  const auto both = [&]() {
    const std::string first = node(bytes, depth + 1);
    return "[" + first + ", " + node(bytes, depth + 1) + "]";
  };
  const auto cut = [&](const char* name) {
    const std::string at = std::to_string(bytes.varint());
    return std::string("{\"") + name + "\": " + both() + ", \"cut\": " + at + "}";
  };
  switch (kind) {
    case kWall:
      return "{\"wall\": \"front\"}";
    case kWallOther:
      return "{\"wall\": \"back\"}";
    case kTime:
      return "{\"time\": " + both() + "}";
    case kPartners:
      return cut("partners");
    case kOwn:
      return cut("own");
    case kOther:
      return cut("other");
    case kSolid: {
      static const char* const kSides[] = {"+x", "+y", "+z", "-x", "-y", "-z"};
      std::string points;
      for (const OutsidePoint& point : bytes.outsidePoints())
        points += (points.empty() ? "[" : ", [") + std::to_string(point.piece) + ", \"" + kSides[point.side] + "\"]";
      return "{\"outside\": [" + points + "], \"solid\": " + node(bytes, depth + 1) + "}";
    }
    default:
      throw BadInput("there is no node of kind " + std::to_string(kind));
  }
}

std::string point(const World& world, std::uint32_t body, Bytes& bytes) {
  std::string s = "{\"piece\": " + std::to_string(bytes.varint());
  const Geometry& g = world.geometries[world.bodies[body].geometry];
  if (g.kind == Geometry::mesh || g.kind == Geometry::hull) {
    s += ", \"weights\": [";
    for (std::uint32_t n = bytes.varint(), k = 0; k < n; ++k) {
      const std::string vertex = std::to_string(bytes.varint());
      s += (k ? ", [" : "[") + vertex + ", " + std::to_string(bytes.little(4)) + "]";
    }
    return s + "]}";
  }
  s += ", \"at\": [";
  for (int k = 0; k < 3; ++k) {
    s += (k ? ", " : "") + number(bytes.little(8));
  }
  return s + "]}";
}

std::string contact(const World& world, Bytes& bytes) {
  bytes.byte();
  const std::uint32_t piece = bytes.varint(), a = bytes.varint(), b = bytes.varint();
  if (a >= world.bodies.size() || b >= world.bodies.size()) throw BadInput("the contact's body is not there");
  const std::string t = number(bytes.little(8));
  std::string s = "{\"piece\": " + std::to_string(piece) + ", \"bodies\": [" +
                  quotedJson(world.describe(static_cast<int>(a))) + ", " +
                  quotedJson(world.describe(static_cast<int>(b))) + "], \"t\": " + t;
  const std::uint8_t kind = bytes.byte();
  if (kind > 4) throw BadInput("there is no witness of kind " + std::to_string(kind));
  s += std::string(", \"of\": \"") + (kind % 2 == 0 || kind == 4 ? "first" : "second") + "\", ";
  if (kind <= 1) {
    const std::uint32_t triangle = bytes.varint(), edge = bytes.varint(), crossed = bytes.varint();
    return s + "\"cross\": {\"piece\": " + std::to_string(triangle) + ", \"edge\": " + std::to_string(edge) +
           ", \"other\": " + std::to_string(crossed) + "}}";
  }
  const std::string first = point(world, kind == 3 ? b : a, bytes);
  if (kind <= 3) {
    s += "\"inside\": " + first + ", \"other\": " + std::to_string(bytes.varint());
    if (world.geometries[world.bodies[kind == 3 ? a : b].geometry].kind == Geometry::hull) {
      s += ", \"vertices\": [";
      for (int k = 0; k < 4; ++k) s += (k ? ", " : "") + std::to_string(bytes.varint());
      s += "]";
    }
    return s + "}";
  }
  return s + "\"near\": [" + first + ", " + point(world, b, bytes) + "]}";
}

}  // namespace

std::string quotedJson(std::string_view text) {
  std::string s = "\"";
  for (const char c : text) {
    char escape[8];
    if (c == '"' || c == '\\') {
      s += '\\';
      s += c;
    } else if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) {
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
      s += escape;
    } else {
      s += c;
    }
  }
  return s + "\"";
}

std::string proofAsJson(const World& world, const Record& record) {
  std::string s = "{\"motion\": " + quotedJson(record.motion) + ",\n \"proof\": {";
  try {
    const Motion motion = readMotion(record.motion, world);
    Bytes bytes(record.proof);
    s += "\"motion\": \"" + hexOf(bytes.take(motion.hash.size())) + "\", \"roots\": [";
    const char* before = "\n  ";
    Budget budget{Options().work};
    for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) {
      for (std::size_t a = 0; a < world.bodies.size(); ++a) {
        budget.spend(1 + world.partners[a].size() + motion.pieces[piece].ignored.size());
        const std::vector<Opponent> partners = opponents(world, motion, piece, static_cast<int>(a));
        if (partners.empty()) continue;
        s += before;
        s += "{\"piece\": " + std::to_string(piece) + ", \"body\": " + quotedJson(world.describe(static_cast<int>(a))) +
             ", \"partners\": " + std::to_string(partners.size()) + ", \"node\": " + node(bytes, 0) + "}";
        before = ",\n  ";
      }
    }
    s += "]";
    if (!bytes.empty() && bytes.peek() == kContact) s += ", \"contact\": " + contact(world, bytes);
    if (!bytes.empty()) s += ", \"bytes_after_the_end\": " + std::to_string(bytes.left());
    return s + "}}";
  } catch (const std::runtime_error& error) {
    throw BadInput(std::string("this record can't be printed: ") + error.what());
  }
}

}  // namespace verify
