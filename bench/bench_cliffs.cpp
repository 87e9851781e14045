// SPDX-License-Identifier: BSD-3-Clause
//
// Searches for slow queries of two bodies: what rests, is coplanar, nested, the same twice, made of slivers, or almost
// touches. From random motions on, changes are kept that make a query dearer. Of the worst found of every family it
// prints the time, beside that of its neighbours (the same motion with the moving body 10 um aside, either way along
// each axis) and that of the motions which the search began with.
//
// What guides the search is the work of a query, as counted, so that a seed finds the same queries again.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/math/motion/interp_motion.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "fcl_artic/fcl_artic.h"
#include "files/files.h"
#include "pairs/body.h"
#include "pairs/random.h"

using namespace fcl_artic;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
using pairs::Random;
using Vertices = std::vector<Eigen::Vector3d>;
using Triangles = std::vector<std::array<int, 3>>;

constexpr double kPi = 3.14159265358979323846, kAside = 1e-5;

Geometry meshOf(const Vertices& vertices, const Triangles& triangles) {
  return pairs::makeFclMesh(vertices, triangles, pairs::Volume::obbrss);
}

/// A surface over a grid of (u, v) in [0, 1]^2, closed where its ends meet.
Geometry surface(int nu, int nv, const std::function<Eigen::Vector3d(double u, double v)>& at) {
  Vertices vertices;
  Triangles triangles;
  for (int i = 0; i <= nu; ++i) {
    for (int j = 0; j <= nv; ++j) vertices.push_back(at(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  }
  const auto index = [&](int i, int j) { return i * (nv + 1) + j; };
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return meshOf(vertices, triangles);
}

/// A flat grid in the plane z = 0, of edge 2 `half`.
Geometry plate(double half, int n) {
  return surface(n, n,
                 [half](double u, double v) { return Eigen::Vector3d(half * (2 * u - 1), half * (2 * v - 1), 0); });
}
Geometry ball(double radius, int n) {
  return surface(2 * n, n, [radius](double u, double v) {
    const double a = 2 * kPi * u, b = kPi * v;
    return Eigen::Vector3d(radius * std::sin(b) * std::cos(a), radius * std::sin(b) * std::sin(a),
                           radius * std::cos(b));
  });
}
/// A tube along z whose triangles are as long as it is.
Geometry slivers(double radius, double half, int n) {
  return surface(n, 1, [radius, half](double u, double v) {
    const double a = 2 * kPi * u;
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), half * (2 * v - 1));
  });
}
Geometry ring(double radius, double tube, int n) {
  return surface(2 * n, n, [radius, tube](double u, double v) {
    const double a = 2 * kPi * u, b = 2 * kPi * v, r = radius + tube * std::cos(b);
    return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
  });
}

/// Two bodies, of which the second moves, and how far along z their surfaces are from each other where it stands.
struct Family {
  std::string name;
  Geometry still, moving;
  double touching_z;  ///< of the moving body's origin
};

std::vector<Family> makeFamilies() {
  const auto wave = [](double u, double v) {
    return Eigen::Vector3d(u - 0.5, v - 0.5, 0.05 * std::sin(9 * u) * std::cos(7 * v));
  };
  const Geometry tooth = surface(30, 30, wave);
  return {
      {"plate on plate", plate(0.5, 24), plate(0.3, 24), 0},
      {"ball on plate", plate(0.5, 30), ball(0.2, 24), 0.2},
      {"ball in ball", ball(0.5, 30), ball(0.4, 24), 0.1},
      {"shells of one size", ball(0.4, 24), ball(0.4, 24), 0},
      {"surface on its copy", tooth, tooth, 0},
      {"slivers on slivers", slivers(0.1, 0.7, 283), slivers(0.1, 0.7, 283), 0.2},
      {"slivers on ball", slivers(0.02, 0.7, 283), ball(0.3, 52), 0.32},
      {"linked rings", ring(0.3, 0.05, 24), ring(0.3, 0.05, 24), 0},
      {"box on plate", plate(0.5, 30), std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2), 0.1},
      {"cylinder on box", std::make_shared<fcl::Boxd>(1, 1, 0.2), std::make_shared<fcl::Cylinderd>(0.1, 0.3), 0.25},
      {"capsule on capsule", std::make_shared<fcl::Capsuled>(0.1, 1), std::make_shared<fcl::Capsuled>(0.1, 1), 1.2},
      {"ball on ground", std::make_shared<fcl::Halfspaced>(Eigen::Vector3d::UnitZ(), 0), ball(0.2, 24), 0.2},
  };
}

/// A motion: from a pose to another, each a shift (m) and a rotation vector (rad), both in addition to resting.
struct Motion {
  std::array<double, 12> x{};
  Eigen::Isometry3d pose(const Family& family, int end, const Eigen::Vector3d& aside) const {
    const double* p = &x[static_cast<std::size_t>(6 * end)];
    const Eigen::Vector3d turn(p[3], p[4], p[5]);
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.translation() = Eigen::Vector3d(p[0], p[1], family.touching_z + p[2]) + aside;
    if (turn.norm() > 0) M.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    return M;
  }
};

struct Cost {
  double work = 0;  ///< about ns, by what was counted
  double us = std::numeric_limits<double>::infinity();
  CertifiedPairResult result;
};

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

class Search {
 public:
  Search(const Family& family, const CertifiedPairRequest& request) : family_(family), request_(request) {}

  Cost cost(const Motion& motion, const Eigen::Vector3d& aside, int runs) const {
    const Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // FCL's constructors without it leave it uninitialised
    const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
    const fcl::InterpMotion<double> still(upright, origin, upright, origin, origin);
    const Eigen::Isometry3d from = motion.pose(family_, 0, aside), to = motion.pose(family_, 1, aside);
    const fcl::InterpMotion<double> moving(from.linear(), from.translation(), to.linear(), to.translation(), origin);
    Cost cost;
    for (int run = 0; run < runs; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      continuousCollide(family_.still.get(), &still, family_.moving.get(), &moving, request_, cost.result);
      const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - begin;
      cost.us = std::min(cost.us, us.count());
    }
    const QueryStatistics& s = cost.result.statistics;
    cost.work = 30.0 * static_cast<double>(s.node_tests) + 100.0 * static_cast<double>(s.leaf_tests + s.certificates) +
                500.0 * static_cast<double>(s.gjk) + 2000.0 * static_cast<double>(s.contact_proofs + s.batches);
    return cost;
  }

  /// A motion at random: half of them slide or stand still as they rest, some touch almost; a quarter begin exactly
  /// where they rest, of which copies begin as one body.
  Motion draw(Random& random) const {
    Motion motion;
    const double shift = random.logUniform(1e-4, 0.3), turn = random.logUniform(1e-3, 1);
    for (std::size_t i = 0; i < 12; ++i) motion.x[i] = random.uniform(-1, 1) * (i % 6 < 3 ? shift : turn);
    if (random.below(2)) {
      for (std::size_t end = 0; end < 2; ++end) {
        motion.x[6 * end + 2] = random.below(2) ? 0 : random.logUniform(1e-15, 1e-3);
        motion.x[6 * end + 3] = motion.x[6 * end + 4] = 0;
        if (random.below(2)) motion.x[6 * end + 5] = 0;
      }
    }
    if (random.below(4) == 0) std::fill_n(motion.x.begin(), 6, 0.0);
    return motion;
  }

  Motion change(const Motion& from, Random& random) const {
    Motion motion = from;
    const double size = random.logUniform(1e-7, 0.1);
    switch (random.below(6)) {
      case 0:  // back to resting, in one coordinate
        motion.x[static_cast<std::size_t>(random.below(12))] = 0;
        break;
      case 1:  // the same coordinate at both ends
      {
        const auto k = static_cast<std::size_t>(random.below(6));
        motion.x[6 + k] = motion.x[k];
        break;
      }
      case 2:  // the other way
        for (std::size_t k = 0; k < 6; ++k) std::swap(motion.x[k], motion.x[6 + k]);
        break;
      case 3:  // shorter or longer
      {
        const double factor = random.logUniform(0.3, 3);
        for (std::size_t k = 0; k < 6; ++k) motion.x[6 + k] = motion.x[k] + factor * (motion.x[6 + k] - motion.x[k]);
        break;
      }
      case 4:  // one coordinate
        motion.x[static_cast<std::size_t>(random.below(12))] += random.uniform(-1, 1) * size;
        break;
      default:
        for (double& x : motion.x) x += random.uniform(-1, 1) * size;
    }
    return motion;
  }

  struct Found {
    Motion worst;
    double typical_us = 0;  ///< the middle one of the motions that the search began with
  };
  Found run(int restarts, int steps, Random& random) const {
    Found found;
    std::vector<double> typical;
    double most = -1;
    for (int restart = 0; restart < restarts; ++restart) {
      Motion at = draw(random);
      const Cost first = cost(at, Eigen::Vector3d::Zero(), 2);
      typical.push_back(first.us);
      double work = first.work;
      for (int step = 0; step < steps; ++step) {
        const Motion next = change(at, random);
        const double next_work = cost(next, Eigen::Vector3d::Zero(), 1).work;
        if (next_work < work) continue;
        at = next;
        work = next_work;
      }
      if (work > most) {
        most = work;
        found.worst = at;
      }
    }
    found.typical_us = medianOf(typical);
    return found;
  }

  /// The middle one of the neighbours' times, us.
  double neighbours(const Motion& motion, int runs) const {
    std::vector<double> us;
    for (int k = 0; k < 3; ++k) {
      for (const double way : {kAside, -kAside}) us.push_back(cost(motion, way * Eigen::Vector3d::Unit(k), runs).us);
    }
    return medianOf(us);
  }

 private:
  const Family& family_;
  const CertifiedPairRequest& request_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Searches for slow queries of two bodies, and compares them with their neighbours 10 um away");
  int restarts = 40, steps = 150, runs = 5;
  std::uint64_t seed = 1;
  double most_us = 0;
  bool verbose = false;
  std::vector<double> motion;
  std::string mode = "first", csv_file;
  std::vector<std::string> wanted;
  app.add_option("--restarts", restarts, "random motions to begin with, each family")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", steps, "changes tried of each")->check(CLI::NonNegativeNumber)->capture_default_str();
  app.add_option("--runs", runs, "runs of the worst query; the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "the same seed searches the same way")->capture_default_str();
  app.add_option("--mode", mode, "which contact is asked for")
      ->check(CLI::IsMember({"first", "any"}))
      ->capture_default_str();
  app.add_option("--family", wanted, "only families whose name holds this");
  app.add_option("--motion", motion, "time this motion instead of searching, as the table's CSV has it")->expected(12);
  app.add_option("--most-us", most_us, "fail where a query takes longer; 0: don't");
  app.add_flag("--verbose", verbose, "print what the worst query does, and how to ask it again");
  app.add_option("--csv", csv_file, "write the table as CSV");
  CLI11_PARSE(app, argc, argv);

  CertifiedPairRequest request;
  request.mode = mode == "any" ? ContactMode::any : ContactMode::first;
  const auto isWanted = [&](const Family& family) {
    return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
             return family.name.find(name) != std::string::npos;
           });
  };
  const auto describe = [](const Cost& cost) {
    const QueryStatistics& s = cost.result.statistics;
    return fmt::format(
        "{}, t in [{:.9g}, {:.9g}]{}; {} batches, {} node tests, {} leaf tests, {} certificates, {} GJK, {} proofs",
        toString(cost.result.status), cost.result.t_lower, cost.result.t_upper,
        cost.result.certain ? "" : " (not certain)", s.batches, s.node_tests, s.leaf_tests, s.certificates, s.gjk,
        s.contact_proofs);
  };
  std::string csv = "family,mode,seed,status,worst_us,neighbours_us,typical_us,motion\n";
  fmt::print("{:<20} {:>9} {:>10} {:>14} {:>10}\n", "family, " + mode, "status", "worst us", "neighbours us",
             "typical us");
  bool failed = false;
  std::uint64_t number = 0, looked_at = 0;
  for (const Family& family : makeFamilies()) {
    Random random(Random::mix(seed, number++));
    if (!isWanted(family)) continue;
    ++looked_at;
    const Search search(family, request);
    Search::Found found;
    if (motion.empty()) {
      found = search.run(restarts, steps, random);
    } else {
      std::copy(motion.begin(), motion.end(), found.worst.x.begin());
    }
    const Cost cost = search.cost(found.worst, Eigen::Vector3d::Zero(), runs);
    const double beside = search.neighbours(found.worst, runs);
    fmt::print("{:<20} {:>9} {:>10.1f} {:>14.1f} {:>10.1f}\n", family.name, toString(cost.result.status), cost.us,
               beside, found.typical_us);
    const std::string numbers = fmt::format("{:.17g}", fmt::join(found.worst.x, " "));
    if (verbose || !motion.empty())
      fmt::print("    {}\n    --family '{}' --motion {}\n", describe(cost), family.name, numbers);
    std::cout << std::flush;
    csv += fmt::format("{},{},{},{},{:.2f},{:.2f},{:.2f},{}\n", family.name, mode, seed, toString(cost.result.status),
                       cost.us, beside, found.typical_us, numbers);
    failed = failed || (most_us > 0 && cost.us > most_us);
  }
  if (looked_at == 0) {
    std::cerr << "bench_cliffs: no family of that name\n";
    return 2;
  }
  if (!csv_file.empty()) files::write(csv_file, csv);
  return failed ? 1 : 0;
}
