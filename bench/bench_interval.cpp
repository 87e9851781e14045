// SPDX-License-Identifier: BSD-3-Clause
//
// Interval kernels, the test of oriented boxes alone and in batches per instruction set, and bounds down a PUMA's
// chain. Times are of one element: a product, a pair of boxes, one interval of time for all six links.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "interval/sine_cosine.h"
#include "motion/frame_sweep.h"
#include "options.h"
#include "random.h"
#include "redon/box_batch.h"
#include "redon/chain_bounds.h"
#include "redon/overlap.h"

namespace {

using namespace fcl_artic;
using namespace fcl_artic::bench;

constexpr std::size_t kQueries = 64;
constexpr int kElements = 256, kRepeats = 20;

Interval randomInterval(Random& random) {
  const double x = random.uniform(-1, 1);
  return Interval(x, x + 0.1 * random.uniform(0, 1));
}

/// Operands of one query, and room for its results.
struct Operands {
  std::vector<IntervalTransform> a, b, product;
  std::vector<IntervalVec3> x, y;
  std::vector<Interval> angle, value, rate;
  std::vector<double> xyz;
  std::vector<ObbNode> boxes[2];
  std::vector<const ObbNode*> pointers[2];
  IntervalTransform motion;  ///< of the second boxes, by a few hundredths

  explicit Operands(Random& random)
      : a(kElements),
        b(kElements),
        product(kElements),
        x(kElements + 3),
        y(kElements + 3),
        angle(kElements),
        value(kElements),
        rate(kElements) {
    for (auto* set : {&a, &b}) {
      for (IntervalTransform& M : *set) fill(random, M);
    }
    for (IntervalVec3& v : x) {
      for (Interval& e : v.v) e = randomInterval(random);
    }
    for (Interval& e : angle) e = randomInterval(random) * 3.0;
    for (int i = 0; i < 3 * kElements; ++i) xyz.push_back(random.uniform(-1, 1));
    motion = IntervalTransform::identity();
    for (Interval& e : motion.R.m) e = e + Interval(-0.02, 0.02);
    for (Interval& e : motion.t.v) e = Interval(-0.01, 0.01);
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < kElements; ++i) boxes[side].push_back(randomBox(random));
    }
  }
  /// Two of them are apart as often as not.
  static ObbNode randomBox(Random& random) {
    ObbNode box = {};
    const Eigen::Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1));
    const Eigen::Matrix3d R = Eigen::AngleAxisd(random.uniform(-3, 3), axis.normalized()).toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) box.axis[i][k] = static_cast<float>(R(i, k));
      box.center[i] = static_cast<float>(random.uniform(-0.3, 0.3));
      box.half[i] = static_cast<float>(random.uniform(0.02, 0.2));
    }
    return box;
  }
  static void fill(Random& random, IntervalTransform& M) {
    for (Interval& e : M.R.m) e = randomInterval(random);
    for (Interval& e : M.t.v) e = randomInterval(random);
  }
};

/// A row of times per element.
/// @param run  computes query i's elements once and gives a number that depends on them.
Measured perElement(int elements, int passes, const std::function<Answer(std::size_t)>& run) {
  Measured measured = measure(kQueries, passes, [&](std::size_t i) {
    Answer answer = 0;
    for (int k = 0; k < kRepeats; ++k) answer = run(i);
    return answer;
  });
  measured.row.per_query = {{"ns_each", 1e3 * measured.row.median_us / (kRepeats * elements)}};
  return measured;
}

}  // namespace

int main(int argc, char** argv) {
  Report report("bench_interval");
  CLI::App app("Interval kernels, box tests per instruction set, and bounds down a chain");
  int passes = 5;
  std::uint64_t seed = 3;
  app.add_option("--passes", passes, "passes over the queries; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "of the operands")->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;

  Random random(seed);
  std::vector<Operands> sets;
  {
    const RoundUpward upward;
    for (std::size_t i = 0; i < kQueries; ++i) sets.emplace_back(random);
    for (Operands& o : sets) {
      for (int side = 0; side < 2; ++side) {
        for (const ObbNode& box : o.boxes[side]) o.pointers[side].push_back(&box);
      }
    }
  }
  const auto kernel = [&](const char* name, std::function<Answer(Operands&)> run) {
    report.add(name, "one by one", "Interval", [&, run] {
      return perElement(kElements, passes, [&](std::size_t i) {
        const RoundUpward upward;
        return run(sets[i]);
      });
    });
  };
  kernel("matrix * vector", [](Operands& o) {
    for (std::size_t i = 0; i < kElements; ++i) o.y[i] = o.a[i].R * o.x[i];
    return o.y[kElements / 2][1].upper();
  });
  kernel("matrix * point", [](Operands& o) {
    for (std::size_t i = 0; i < kElements; ++i) o.y[i] = o.a[i].R * &o.xyz[3 * i];
    return o.y[kElements / 2][1].upper();
  });
  kernel("matrix * matrix", [](Operands& o) {
    for (std::size_t i = 0; i < kElements; ++i) o.product[i].R = o.a[i].R * o.b[i].R;
    return o.product[kElements / 2].R.m[4].upper();
  });
  kernel("triple product", [](Operands& o) {
    for (std::size_t i = 0; i < kElements; ++i) {
      o.value[i] = tripleProduct(o.x[i] - o.x[i + 1], o.x[i + 2] - o.x[i + 1], o.x[i + 3] - o.x[i + 1]);
    }
    return o.value[kElements / 2].upper();
  });
  kernel("sine and cosine", [](Operands& o) {
    for (std::size_t i = 0; i < kElements; ++i) encloseSineCosine(o.angle[i], o.value[i], o.rate[i]);
    return o.value[kElements / 2].upper() + o.rate[0].upper();
  });
  kernel("pair of boxes", [](Operands& o) {
    Answer apart = 0;
    redon::SweptObb swept;
    for (std::size_t i = 0; i < kElements; ++i) {
      redon::sweep(o.motion, o.boxes[1][i], swept);
      apart += redon::certainlyDisjoint(o.boxes[0][i], swept, o.boxes[1][i].half);
    }
    return apart;
  });
  for (const char* name : {"portable", "sse2", "avx2", "avx512", "neon"}) {
    const redon::BoxBatch* batch = redon::boxBatchNamed(name);
    if (!batch) continue;
    for (const int n : {1, 3, redon::BoxBatch::kPairs}) {
      report.add("pair of boxes", fmt::format("batches of {}", n), name, [&, batch, n] {
        return perElement(kElements, passes, [&](std::size_t q) {
          Answer apart = 0;
          for (int i = 0; i < kElements; i += n) {
            const auto at = static_cast<std::size_t>(i);
            apart += __builtin_popcount(batch->apart(sets[q].motion, &sets[q].pointers[0][at], &sets[q].pointers[1][at],
                                                     std::min(n, kElements - i)));
          }
          return apart;
        });
      });
    }
  }

  constexpr int kJoints = 6;
  const double a[kJoints] = {0, 0, 0.4318, 0.0203, 0, 0}, d[kJoints] = {0, 0, 0, 0.15005, 0.4318, 0};
  const double twist[kJoints] = {0, M_PI_2, 0, -M_PI_2, M_PI_2, -M_PI_2};
  KinematicTree tree;
  tree.addLink("base");
  for (int i = 0; i < kJoints; ++i) {
    Joint joint;
    joint.name = fmt::format("joint{}", i);
    joint.parent = i == 0 ? "base" : fmt::format("link{}", i - 1);
    joint.child = fmt::format("link{}", i);
    joint.type = JointType::revolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.origin.linear() = Eigen::AngleAxisd(twist[i], Eigen::Vector3d::UnitX()).toRotationMatrix();
    joint.origin.translation() = Eigen::Vector3d(a[i], 0, d[i]);
    tree.addLink(joint.child);
    tree.addJoint(joint);
  }
  const FrameSweep sweep = FrameSweep::fromWorld(tree);
  std::vector<double> coefficients(2 * kJoints * kQueries);
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    coefficients[i] = i / kJoints % 2 == 0 ? random.uniform(-3, 3) : random.uniform(-0.09, 0.09);  // q0, 5 degrees
  }
  ChainBounds chain;
  FrameBounds frames[kJoints];
  const std::pair<const char*, Enclosure> enclosures[] = {{"interval chain", Enclosure::intervalChain},
                                                          {"mean value", Enclosure::meanValue},
                                                          {"Taylor", Enclosure::taylor}};
  for (const auto& [name, enclosure] : enclosures) {
    for (const auto& [order, derivatives] :
         {std::pair("poses", Derivatives::none), std::pair("poses and rates", Derivatives::first)}) {
      report.add("PUMA, 6 links", order, name, [&, enclosure = enclosure, derivatives = derivatives] {
        return perElement(16, passes, [&](std::size_t i) {
          engine::Query query;
          query.coefficients = &coefficients[2 * kJoints * i];
          query.num_variables = kJoints;
          chain.reset(sweep.view(), query);
          for (int k = 0; k < 16; ++k) chain.enclose(k / 16.0, (k + 1) / 16.0, enclosure, derivatives, frames);
          return frames[kJoints - 1].pose.t[0].upper();
        });
      });
    }
  }
  report.run();
  return report.finish();
}
