// SPDX-License-Identifier: BSD-3-Clause
#include "setup/margins.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "numerics/require.h"

namespace fcl_artic {

void NamedMargins::set(const std::string& body, double margin) {
  requireNotNegative(margin, "the margin of '" + body + "'");
  of_body_[body] = margin;
}

void NamedMargins::set(const std::string& a, const std::string& b, double margin) {
  requireNotNegative(margin, "the margin of '" + a + "' and '" + b + "'");
  of_pair_[std::minmax(a, b)] = margin;
}

void NamedMargins::clear() {
  of_body_.clear();
  of_pair_.clear();
}

void NamedMargins::keep(const std::function<bool(const std::string& body)>& isKept) {
  for (auto at = of_body_.begin(); at != of_body_.end();) at = isKept(at->first) ? std::next(at) : of_body_.erase(at);
  for (auto at = of_pair_.begin(); at != of_pair_.end();) {
    at = isKept(at->first.first) && isKept(at->first.second) ? std::next(at) : of_pair_.erase(at);
  }
}

double NamedMargins::ofBody(const std::string& name) const {
  const auto margin = of_body_.find(name);
  return margin == of_body_.end() ? -1 : margin->second;
}

double NamedMargins::of(const std::string& a, const std::string& b) const {
  const auto margin = of_pair_.find(std::minmax(a, b));
  return margin == of_pair_.end() ? std::max(ofBody(a), ofBody(b)) : margin->second;
}

PairMargins PairMargins::of(const NamedMargins& margins, const engine::Problem& problem,
                            const std::function<const std::string&(std::int32_t body)>& nameOf) {
  PairMargins of;
  if (margins.empty()) return of;
  std::vector<double> of_body;
  std::map<std::string, std::vector<std::int32_t>> bodies_named;
  for (std::int32_t i = 0; i < problem.num_bodies; ++i) {
    of_body.push_back(margins.ofBody(nameOf(i)));
    bodies_named[nameOf(i)].push_back(i);
  }
  const auto larger = [&](std::int32_t a, std::int32_t b) {
    return std::max(of_body[static_cast<std::size_t>(a)], of_body[static_cast<std::size_t>(b)]);
  };
  for (std::int32_t m = 0; m < problem.num_scene_movers; ++m) {
    for (std::int32_t o = 0; o < problem.num_obstacles; ++o) {
      of.scene_.push_back(larger(problem.movers[m], problem.obstacles[o]));
    }
  }
  for (std::int32_t i = 0; i < problem.num_link_pairs; ++i) {
    of.link_.push_back(larger(problem.link_pairs[i].a, problem.link_pairs[i].b));
  }

  const std::int32_t first_obstacle = problem.num_movers;       // links and moving obstacles come before
  std::map<std::pair<std::int32_t, std::int32_t>, double> own;  // of two that move, the lesser one first
  for (const auto& [names, margin] : margins.ofPairs()) {
    for (const std::int32_t a : bodies_named[names.first]) {
      for (const std::int32_t b : bodies_named[names.second]) {
        const auto [link, other] = std::minmax(a, b);
        if (other < first_obstacle) {
          own[{link, other}] = margin;
        } else if (link < problem.num_scene_movers) {
          const engine::PairId pair = problem.scenePair(problem.bodies[link].mover, other - first_obstacle);
          of.scene_[engine::indexOf(pair)] = margin;
        }
      }
    }
  }
  for (std::int32_t i = 0; i < problem.num_link_pairs; ++i) {
    const auto margin = own.find(std::minmax(problem.link_pairs[i].a, problem.link_pairs[i].b));
    if (margin != own.end()) of.link_[static_cast<std::size_t>(i)] = margin->second;
  }
  for (const std::vector<double>* kind : {&of.scene_, &of.link_}) {
    for (const double margin : *kind) of.largest_ = std::max(of.largest_, margin);
  }
  return of;
}

void PairMargins::putInto(engine::Margins& margins) const {
  const double* const scene = scene_.empty() ? nullptr : scene_.data();
  const double* const link = link_.empty() ? nullptr : link_.data();
  margins.setOwn(scene, static_cast<std::int32_t>(scene_.size()), link, largest_);
  if (std::isfinite(margins.largest())) return;
  throw std::invalid_argument("request.added_margin and the margin " + std::to_string(largest_) +
                              " of a pair have no finite sum");
}

}  // namespace fcl_artic
