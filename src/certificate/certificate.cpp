// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/certificate.h"

#include <algorithm>
#include <utility>

#include "certificate/emitter.h"
#include "certificate/sha256.h"

namespace fcl_artic {
namespace {

std::string lengthBytes(const std::string& text) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(text.size() >> (8 * i) & 255);
  return bytes;
}

}  // namespace

std::string Certificate::record() const {
  return "FAC2" + lengthBytes(motion) + motion + lengthBytes(proof) + proof;
}

namespace certificate {
namespace {

std::string pieceText(const World& world, const Motion& motion) {
  std::string text = "piece\n";
  if (world.clocked) text += "clock " + numberText(motion.clock_begin) + " " + numberText(motion.clock_end) + "\n";
  const Eigen::MatrixXd& c = motion.coefficients;
  for (Eigen::Index v = 0; v < c.rows(); ++v) {
    Eigen::Index degree = c.cols() - 1;
    while (degree >= 0 && c(v, degree) == 0) --degree;
    if (degree < 0) continue;
    text += "q " + std::to_string(v);
    for (Eigen::Index k = 0; k <= degree; ++k) text += " " + numberText(c(v, k));
    text += "\n";
  }
  for (const Motion::Ignored& pair : motion.ignored) {
    text += "ignored " + std::to_string(pair.a) + " " + std::to_string(pair.b) + " " + numberText(pair.until) + "\n";
  }
  for (std::size_t i = 0; i < world.orientations.size(); ++i) {
    text += "orientation " + std::to_string(world.orientations[i]) + " " + rotationText(motion.orientations[i]) + "\n";
  }
  return text;
}

std::string motionText(const World& world, const Claim& claim) {
  const Motion& first = claim.pieces.front();
  std::string text = "fcl_artic motion 1\nworld " + world.hash + "\nmargin " + numberText(first.margin) + "\nadded " +
                     numberText(first.added) + "\nscope";
  if (first.self) text += " self";
  if (first.scene) text += " scene";
  text += "\n";
  text += "duration " + numberText(claim.duration) + "\nuntil " + numberText(claim.pieces.back().until) + "\n";
  for (const Motion& piece : claim.pieces) text += pieceText(world, piece);
  return text;
}

/// Whether the claim is about any pair: one that is checked, and that not every piece ignores to its end.
bool claimsAnyPair(const World& world, const Claim& claim) {
  const auto isObstacle = [&](std::size_t i) { return world.bodies[i].role == Body::Role::obstacle; };
  for (const Motion& piece : claim.pieces) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      for (const int partner : world.bodies[i].partners) {
        const bool with_scene = isObstacle(i) || isObstacle(static_cast<std::size_t>(partner));
        if (!(with_scene ? piece.scene : piece.self)) continue;
        const std::pair<int, int> pair = std::minmax(static_cast<int>(i), partner);
        const bool ignored = std::any_of(piece.ignored.begin(), piece.ignored.end(), [&](const Motion::Ignored& p) {
          return p.a == pair.first && p.b == pair.second && p.until >= piece.until;
        });
        if (!ignored) return true;
      }
    }
  }
  return false;
}

}  // namespace

Motion motionOf(const World& world, const JointMotion& motion, const TimePart& time) {
  Motion out;
  if (!motion.isPolynomial()) {
    out.missing = "angles go by a tangent half-angle law, which certificates cannot state";
  }
  const Eigen::MatrixXd moving = world.moving.rows() == 0 || time.whole() ? world.moving : partOf(world.moving, time);
  const Eigen::MatrixXd& own = motion.variables();
  out.coefficients = Eigen::MatrixXd::Zero(own.rows() + moving.rows(), std::max(own.cols(), moving.cols()));
  out.coefficients.topLeftCorner(own.rows(), own.cols()) = own;
  out.coefficients.bottomLeftCorner(moving.rows(), moving.cols()) = moving;
  const std::vector<double>& R0 = motion.orientations();
  for (std::size_t i = 0; i < world.orientations.size(); ++i) {
    out.orientations.emplace_back(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&R0[9 * i]));
  }
  return out;
}

Certificate makeCertificate(const World& world, const Claim& claim, std::uint64_t work) {
  Certificate certificate;
  certificate.missing = world.missing;
  for (const Motion& piece : claim.pieces) {
    if (certificate.missing.empty()) certificate.missing = piece.missing;
  }
  if (!claim.pieces.front().self && !claim.pieces.front().scene) {
    certificate.missing = "nothing is claimed: neither links nor obstacles are checked";
  }
  if (!(claim.duration <= kLargestNumber)) {
    certificate.missing =
        "the motion takes longer than 2^40, in its unit of time: certificates state no larger numbers";
  }
  if (!certificate.missing.empty()) return certificate;
  if (!(claim.pieces.back().until > 0)) {
    certificate.missing =
        "nothing is claimed: a certificate is about the time before a contact, and bodies may touch from the beginning "
        "on";
    return certificate;
  }
  if (!claimsAnyPair(world, claim)) {
    certificate.missing = "nothing is claimed: no pair of bodies is checked";
    return certificate;
  }
  certificate.world = world.text;
  certificate.motion = motionText(world, claim);
  const auto hash = sha256(certificate.motion);
  certificate.proof.assign(reinterpret_cast<const char*>(hash.data()), hash.size());
  std::string nodes;
  for (const Motion& piece : claim.pieces) {
    certificate.missing = findProof(world, piece, work, nodes);
    if (!certificate.missing.empty()) {
      certificate.proof.clear();
      break;
    }
    certificate.proof += nodes;
  }
  if (claim.meeting && certificate) {
    MovingWorld moving(world, claim.pieces.back());
    certificate.proof += findWitness(moving, *claim.meeting);
  }
  return certificate;
}

}  // namespace certificate
}  // namespace fcl_artic
