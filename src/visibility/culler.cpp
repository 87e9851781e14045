// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <exception>
#include <mutex>
#include <random>
#include <stdexcept>
#include <utility>

#include "visibility/cpu_executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// Number of pairs in each half of the self-test.
constexpr int kSelfTestPairs = 512;

/// Adds pairs of a swept volume and a triangle with a corner in it, or of two that are apart in every view.
void addPairs(bool touching, Batch& batch) {
  std::minstd_rand random(touching ? 1 : 2);
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()));
  };
  batch.clear();
  for (; batch.num_groups < kSelfTestPairs; ++batch.num_groups) {
    const std::int32_t first = 9 * batch.num_groups, window = batch.num_groups;
    const double radius = uniform(1e-4, 0.1);
    double corner[3] = {}, turn[3], length = 0;
    for (double& x : turn) {
      x = uniform(-1, 1);
      length += std::abs(x);
    }
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 3; ++k) {
        batch.points.push_back(uniform(0.4, 0.8));
        if (i == 0) corner[k] = batch.points.back() + radius * turn[k] / length;
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        batch.points.push_back(!touching ? uniform(0, 0.1) : i == 0 ? corner[k] : uniform(-1, 2));
      }
    }
    batch.windows.push_back({{0, 0, 0}, {1, 1, 1}});
    batch.swept.push_back({{first, 6, radius}, window});
    batch.objects.push_back({{first + 6, 3, 0}, window, batch.num_groups});
  }
}

/// It finds a broken executor. That a sound one proves what it says rests on the rule's derivation.
void requireSoundness(Executor& executor, int resolution) {
  Batch batch;
  batch.resolution = resolution;
  std::vector<std::uint8_t> may;
  const auto culled = [&](bool touching) {
    addPairs(touching, batch);
    executor.run(batch, may);
    int n = 0;
    for (const std::uint8_t group : may) n += !group;
    return n;
  };
  if (const int wrong = culled(true)) {
    throw std::runtime_error("self-test: " + std::to_string(wrong) + " of " + std::to_string(kSelfTestPairs) +
                             " touching pairs were culled");
  }
  if (culled(false) == 0) throw std::runtime_error("self-test: it culls nothing");
}

}  // namespace
}  // namespace visibility

struct VisibilityCuller::Impl {
  VisibilityOptions options;
  std::string name;
  visibility::ExecutorFactory factory;  ///< empty: cpu
  std::mutex mutex;                     ///< held while `executor` is made or at work
  std::unique_ptr<visibility::Executor> executor;
  std::string reason;  ///< for the fallback; factory is not asked any more

  /// The executor of the culler's own; null: cpu. The mutex is held.
  visibility::Executor* own() {
    if (!factory || !reason.empty()) return nullptr;
    try {
      if (!executor) {
        auto made = factory();
        visibility::requireSoundness(*made, options.resolution);
        executor = std::move(made);
      }
    } catch (const std::exception& e) {
      giveUp(e);
    }
    return executor.get();
  }
  void giveUp(const std::exception& e) {
    executor.reset();
    reason = name + ": " + e.what();
  }
};

std::string visibility::runBy(const VisibilityCuller& culler, const Batch& batch, std::vector<std::uint8_t>& may) {
  VisibilityCuller::Impl& impl = *culler.impl_;
  if (impl.factory) {
    const std::lock_guard<std::mutex> lock(impl.mutex);
    if (Executor* const own = impl.own()) {
      try {
        own->run(batch, may);
        return impl.name;
      } catch (const std::exception& e) {
        impl.giveUp(e);
      }
    }
  }
  thread_local CpuExecutor cpu;
  cpu.run(batch, may);
  return "cpu";
}

VisibilityCuller::VisibilityCuller(const VisibilityOptions& options) : VisibilityCuller(options, "cpu", nullptr) {}

VisibilityCuller::VisibilityCuller(const VisibilityOptions& options, const std::string& executor,
                                   visibility::ExecutorFactory factory)
    : impl_(std::make_unique<Impl>()) {
  if (options.resolution < 4 || options.resolution > visibility::kLargestResolution) {
    throw std::invalid_argument("VisibilityOptions.resolution is " + std::to_string(options.resolution) +
                                ", not in [4, " + std::to_string(visibility::kLargestResolution) + "]");
  }
  if (options.every_link_pair) {
    throw std::invalid_argument("VisibilityOptions.every_link_pair is gone: leave it false, answers are the same");
  }
  impl_->options = options;
  impl_->name = executor;
  impl_->factory = std::move(factory);
}

VisibilityCuller::~VisibilityCuller() = default;

const VisibilityOptions& VisibilityCuller::options() const {
  return impl_->options;
}

std::string VisibilityCuller::executor() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->own() ? impl_->name : "cpu";
}

std::string VisibilityCuller::fallbackReason() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->reason;
}

}  // namespace fcl_artic
