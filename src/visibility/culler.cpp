// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <exception>
#include <mutex>
#include <random>
#include <stdexcept>
#include <utility>

#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// Draws what is swept in the middle of a window, triangles that touch it, and others that are apart from it in every
/// view. It finds a broken executor. That a sound one proves what it says rests on the rule's derivation.
void requireSoundness(Executor& executor, int resolution) {
  constexpr int kPairs = 512;
  constexpr double kRadius = 0.1;
  std::minstd_rand random(1);
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()));
  };
  Drawing drawing;
  drawing.resolution = resolution;
  std::fill_n(drawing.hi, 3, 1.0);
  double points[18], triangle[9];
  for (double& x : points) x = uniform(0.4, 0.8);
  drawing.swept.push_back(drawing.addVolume(points, 6, kRadius));
  for (; drawing.num_groups < 2 * kPairs; ++drawing.num_groups) {
    const int touched = drawing.num_groups % 2 ? -1 : 3 * (drawing.num_groups / 2 % 6);
    for (double& x : triangle) x = touched < 0 ? uniform(0, 0.1) : uniform(-1, 2);
    for (int k = 0; touched >= 0 && k < 3; ++k) triangle[k] = points[touched + k] + uniform(-0.57, 0.57) * kRadius;
    drawing.pieces.push_back({drawing.addVolume(triangle, 3, 0), drawing.num_groups});
  }
  std::vector<std::uint8_t> may;
  executor.draw(drawing, may);
  int wrong = 0, culled = 0;
  for (std::size_t group = 0; group < may.size(); ++group) (group % 2 ? culled : wrong) += !may[group];
  if (wrong) {
    throw std::runtime_error("self-test: " + std::to_string(wrong) + " of " + std::to_string(kPairs) +
                             " touching pairs were culled");
  }
  if (!culled) throw std::runtime_error("self-test: it culls nothing");
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

  /// Has the culler's own executor draw, if there is something to draw. @return whether there is one that did.
  bool drawByOwn(const visibility::Drawing* drawing, std::vector<std::uint8_t>* may) {
    if (!factory) return false;
    const std::lock_guard<std::mutex> lock(mutex);
    if (!reason.empty()) return false;
    try {
      if (!executor) {
        auto made = factory();
        visibility::requireSoundness(*made, options.resolution);
        executor = std::move(made);
      }
      if (drawing) executor->draw(*drawing, *may);
      return true;
    } catch (const std::exception& e) {
      executor.reset();
      reason = name + ": " + e.what();
      return false;
    }
  }
};

std::string visibility::drawBy(const VisibilityCuller& culler, const Drawing& drawing, std::vector<std::uint8_t>& may) {
  if (culler.impl_->drawByOwn(&drawing, &may)) return culler.impl_->name;
  thread_local const std::unique_ptr<Executor> cpu = makeCpuExecutor();
  cpu->draw(drawing, may);
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
  impl_->options = options;
  impl_->name = executor;
  impl_->factory = std::move(factory);
}

VisibilityCuller::~VisibilityCuller() = default;

const VisibilityOptions& VisibilityCuller::options() const {
  return impl_->options;
}

std::string VisibilityCuller::executor() const {
  return impl_->drawByOwn(nullptr, nullptr) ? impl_->name : "cpu";
}

std::string VisibilityCuller::fallbackReason() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->reason;
}

}  // namespace fcl_artic
