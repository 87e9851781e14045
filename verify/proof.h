// SPDX-License-Identifier: BSD-3-Clause
// Certificates and the verdict on them.
#pragma once

#include "motion.h"

namespace verify {

struct Record {
  std::string_view motion, proof;
};
/// Cuts a file into its records. @throws BadInput
std::vector<Record> splitRecords(std::string_view file);

struct Options {
  std::uint64_t work = 2000000000;  // per record; a step is roughly 20 ns
};

struct Verdict {
  bool verified = false;
  bool bad_input = false;    // the record is not what the format says
  std::string reason;        // why not
  bool contact = false;      // the record also shows that two bodies meet: have a point in common,
  bool near = false;         // or only that they are nearer than their margin
  std::string contact_text;  // which, and when
  std::size_t pieces = 0;
  double until = 0;           // of the last piece
  std::uint64_t checked = 0;  // pairs, of some of the claim's time at least
  std::uint64_t late = 0;     // of these, not at the beginning of some piece: ignored up to a time there
  std::uint64_t not_checked[kReasons] = {};
  std::uint64_t steps = 0;
  double jump = 0;  // the largest between a piece's end and the next one's beginning, rad or m; for people
};

/// Proves a record's claim again. Never throws on account of what the record contains.
Verdict verifyRecord(const World& world, const Record& record, const Options& options = {});

// Shared by the parts of the verifier.

/// A point of a body, and a side along which another one's surface is counted from it; see SOLID.
struct OutsidePoint {
  std::uint32_t piece;
  std::uint8_t side;
};

/// The bytes of a proof, each read checked.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
  bool empty() const { return at_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(take(1)[0]); }
  std::uint8_t peek() const;
  std::string_view take(std::size_t n);
  std::uint64_t little(int n);
  /// Signed, n bytes.
  std::int64_t signedLittle(int n);
  /// LEB128, at most 32 bits and in its shortest form.
  std::uint32_t varint();
  std::vector<OutsidePoint> outsidePoints();

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

enum NodeKind : std::uint8_t {
  kSep = 0x00,
  kSepFine = 0x03,
  kWall = 0x09,
  kWallOther = 0x0a,
  kTime = 0x10,
  kPartners = 0x11,
  kOwn = 0x12,
  kOther = 0x13,
  kSolid = 0x14,
  kContact = 0x20
};

constexpr int kMostDepth = 400;  // of nodes
constexpr int kMostTimeDepth = 60;
constexpr int kMostHalvings = 14;  // of time, that the verifier adds by itself to a leaf's claim

/// Who is checked against body A in a piece of the motion, and from which time on.
struct Opponent {
  int body;
  Fix from;    // the pair is ignored up to this time or one less than 2 ulp above it; -1: not ignored
  Fix margin;  // an upper bound
};
std::vector<Opponent> opponents(const World& world, const Motion& motion, std::size_t piece, int body);

/// Whether at time t no part of either surface lies in the other body, as the points show. @throws NotProven
void checkSolid(const World& world, Poses& poses, int a, int b, Fix t, const std::vector<OutsidePoint>& points);
struct Meeting {
  bool near;         // nearer than the margin, and nothing more; else they have a point in common
  std::string text;  // who, and when
};
/// The witness of a contact. @throws NotProven, BadInput
Meeting checkContact(const World& world, const Motion& motion, Bytes& bytes, Budget& budget);

}  // namespace verify
