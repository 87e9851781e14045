// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/culler.h"

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "visibility/adversary.h"
#include "visibility/cpu_executor.h"

namespace fcl_artic {

struct VisibilityCuller::Impl {
  VisibilityOptions options;
  std::string name = "cpu";
  visibility::ExecutorFactory factory;  ///< empty: cpu
  std::mutex mutex;
  std::string reason;  ///< for the fallback; factory is not asked any more
  std::vector<std::unique_ptr<visibility::Slot>> idle;

  bool useFactory() {
    const std::lock_guard<std::mutex> lock(mutex);
    return factory && reason.empty();
  }
  void fallBack(const std::string& why) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (reason.empty()) reason = why.empty() ? "unknown" : why;
    const auto own = [&](const std::unique_ptr<visibility::Slot>& slot) { return slot->own; };
    idle.erase(std::remove_if(idle.begin(), idle.end(), own), idle.end());
  }
};

namespace visibility {
namespace {

/// Number of pairs in the self-test, a hundred or two of each kind. It finds a broken executor, but no missing margin
/// for snapping: that margin rests on its derivation.
constexpr std::uint64_t kSelfTestPairs = 1024;

void requireSoundness(Executor& executor, Slot& slot, const VisibilityOptions& options) {
  slot.batch = Batch();
  slot.batch.resolution = options.resolution;
  slot.batch.rule = options.rule;
  const std::uint64_t wrong = countWrongCulls(executor, slot.batch, 1, 0, kSelfTestPairs);
  if (wrong) {
    throw std::runtime_error("self-test: " + std::to_string(wrong) + " of " + std::to_string(kSelfTestPairs) +
                             " touching pairs were culled");
  }
  if (!countWrongCulls(executor, slot.batch, 1, 0, 256, 8)) throw std::runtime_error("self-test: it culls nothing");
}

}  // namespace

/// One that is idle, of the culler's own kind or cpu; null: there is none.
std::unique_ptr<Slot> ExecutorLoan::takeIdle(bool own) {
  const std::lock_guard<std::mutex> lock(culler_.mutex);
  for (std::unique_ptr<Slot>& slot : culler_.idle) {
    if (slot->own != own) continue;
    std::swap(slot, culler_.idle.back());
    std::unique_ptr<Slot> taken = std::move(culler_.idle.back());
    culler_.idle.pop_back();
    return taken;
  }
  return nullptr;
}

ExecutorLoan::ExecutorLoan(const VisibilityCuller& culler, ExecutorKind kind) : culler_(*culler.impl_) {
  const bool own = kind == ExecutorKind::own && culler_.useFactory();
  slot_ = takeIdle(own);
  if (slot_) return;
  made_ = true;
  slot_ = std::make_unique<Slot>();
  if (own) {
    try {
      slot_->executor = culler_.factory();
      slot_->name = culler_.name;
      slot_->own = true;
      requireSoundness(*slot_->executor, *slot_, culler_.options);
      return;
    } catch (const std::exception& e) {
      culler_.fallBack(culler_.name + ": " + e.what());
    }
  }
  slot_->executor = std::make_unique<CpuExecutor>();
  slot_->name = "cpu";
  slot_->own = false;
}

ExecutorLoan::~ExecutorLoan() {
  const std::lock_guard<std::mutex> lock(culler_.mutex);
  if (slot_ && !(slot_->own && !culler_.reason.empty())) culler_.idle.push_back(std::move(slot_));
}

void ExecutorLoan::giveUp(const std::string& reason) {
  culler_.fallBack(slot_->name + ": " + reason);
  slot_->executor = std::make_unique<CpuExecutor>();
  slot_->name = "cpu";
  slot_->own = false;
}

double ExecutorLoan::makingCost(const VisibilityCuller& culler) {
  return culler.impl_->useFactory() ? 2e5 : -1;
}

bool ExecutorLoan::isMade(const VisibilityCuller& culler) {
  const std::lock_guard<std::mutex> lock(culler.impl_->mutex);
  const auto& idle = culler.impl_->idle;
  return std::any_of(idle.begin(), idle.end(), [](const std::unique_ptr<Slot>& slot) { return slot->own; });
}

}  // namespace visibility

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
  return visibility::ExecutorLoan(*this)->name;
}

std::string VisibilityCuller::fallbackReason() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->reason;
}

}  // namespace fcl_artic
