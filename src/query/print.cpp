// SPDX-License-Identifier: BSD-3-Clause
//
// Answers as text.
#include <ostream>

#include "fcl_artic/continuous_manager.h"
#include "fcl_artic/link_pairs.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/result.h"
#include "numerics/shown.h"

namespace fcl_artic {

const char* toString(Status status) {
  switch (status) {
    case Status::free:
      return "free";
    case Status::contact:
      return "contact";
    case Status::undecided:
      return "undecided";
  }
  return "?";
}

const char* toString(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::vertexVertex:
      return "vertex-vertex";
    case FeatureKind::vertexEdge:
      return "vertex-edge";
    case FeatureKind::edgeVertex:
      return "edge-vertex";
    case FeatureKind::vertexFace:
      return "vertex-face";
    case FeatureKind::faceVertex:
      return "face-vertex";
    case FeatureKind::edgeEdge:
      return "edge-edge";
    case FeatureKind::edgeFace:
      return "edge-face";
    case FeatureKind::faceEdge:
      return "face-edge";
    case FeatureKind::faceFace:
      return "face-face";
    case FeatureKind::volume:
      return "volume";
  }
  return "volume";
}

std::ostream& operator<<(std::ostream& out, Status status) {
  return out << toString(status);
}

std::ostream& operator<<(std::ostream& out, FeatureKind kind) {
  return out << toString(kind);
}

std::ostream& operator<<(std::ostream& out, const BodyRef& body) {
  return out << (body.name.empty() ? "body" : body.name);
}

std::ostream& operator<<(std::ostream& out, const Bracket& bracket) {
  switch (bracket.status) {
    case Status::free:
      return out << "free: proven";
    case Status::contact:
      return out << "contact within [" << shown(bracket.t_lower) << ", " << shown(bracket.t_upper) << "], "
                 << (bracket.certain ? "proven" : "not proven: too near to decide");
    case Status::undecided:
      return out << "undecided: free before " << shown(bracket.t_lower);
  }
  return out;
}

namespace {

/// Names what a free answer does not cover. @param ignored  number of pairs, those that never come apart included.
std::string exceptionsText(const Bracket& answer, std::size_t unproven, std::size_t ignored, std::size_t never,
                           const std::vector<std::pair<std::string, std::string>>* neighbours = nullptr) {
  std::string text;
  if (!answer.isFree()) return text;
  const auto pairs = [](std::size_t n, const char* kind) {
    return std::to_string(n) + kind + (n == 1 ? " pair" : " pairs");
  };
  const auto add = [&](const std::string& more) { text += (text.empty() ? "but for " : ", and for ") + more; };
  const std::size_t num_neighbours = neighbours ? neighbours->size() : 0;
  if (unproven > num_neighbours) add(pairs(unproven - num_neighbours, " allowed") + " not proven apart");
  if (num_neighbours > 0) {
    add(pairs(num_neighbours, "") + " of neighbours not proven apart: ");
    for (const auto& [a, b] : *neighbours) text += (&a == &neighbours->front().first ? "" : "; ") + a + ", " + b;
  }
  if (ignored > never) add("the initial contact of " + pairs(ignored - never, ""));
  if (never > 0) add(pairs(never, "") + (never == 1 ? " that never comes apart" : " that never come apart"));
  return text;
}

template <class Result>
std::ostream& printExceptions(std::ostream& out, const Result& result) {
  const std::string exceptions = exceptionsOf(result);
  return exceptions.empty() ? out : out << ", " << exceptions;
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const CertifiedResult& result) {
  if (result.nothingChecked()) {
    out << "nothing was checked, there is no pair of bodies";
  } else {
    out << static_cast<const Bracket&>(result);
  }
  return printExceptions(out, result);
}

std::ostream& operator<<(std::ostream& out, const CertifiedPairResult& result) {
  return printExceptions(out << static_cast<const Bracket&>(result), result);
}

std::ostream& operator<<(std::ostream& out, const CertifiedPairsResult& result) {
  return printExceptions(out << static_cast<const Bracket&>(result), result);
}

std::string exceptionsOf(const CertifiedResult& result) {
  return exceptionsText(result, result.unproven_allowed_pairs, result.ignored_initial_contacts.size(),
                        result.never_apart_pairs, result.unproven_neighbours.get());
}

std::string exceptionsOf(const CertifiedPairResult& result) {
  return exceptionsText(result, 0, result.ignored_initial_contact, result.never_apart);
}

std::string exceptionsOf(const CertifiedPairsResult& result) {
  return exceptionsText(result, 0, result.ignored_initial_contacts.size(), result.never_apart_pairs);
}

const char* toString(LinkPairKind kind) {
  switch (kind) {
    case LinkPairKind::never:
      return "never";
    case LinkPairKind::always:
      return "always";
    case LinkPairKind::sometimes:
      return "sometimes";
    case LinkPairKind::unproven:
      return "unproven";
  }
  return "?";
}

std::ostream& operator<<(std::ostream& out, LinkPairKind kind) {
  return out << toString(kind);
}

std::ostream& operator<<(std::ostream& out, const LinkPairFinding& finding) {
  out << finding.link1 << " and " << finding.link2 << ": " << finding.kind;
  if (finding.tried > 0) out << ", " << finding.touching << " of " << finding.tried << " configurations tried touch";
  if (finding.proven) out << ", proven";
  if (finding.neighbours) out << ", neighbours";
  return out;
}

std::ostream& operator<<(std::ostream& out, const CertifiedContact& contact) {
  const Eigen::Vector3d& p = contact.point;
  return out << contact.body1 << " and " << contact.body2 << " (" << contact.feature << ") within ["
             << shown(contact.t_lower) << ", " << shown(contact.t_upper) << "] at " << shown(p.x()) << ", "
             << shown(p.y()) << ", " << shown(p.z()) << (contact.certain ? "" : ", not proven");
}

}  // namespace fcl_artic
