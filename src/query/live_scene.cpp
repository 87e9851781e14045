// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "fcl_artic/guard.h"
#include "numerics/require.h"

namespace fcl_artic {
struct LiveScene::Impl {
  std::shared_ptr<const Snapshot> get() const {
    const std::lock_guard<std::mutex> lock(handle);
    return latest;
  }

  mutable std::mutex handle;               ///< held for as long as copying a pointer takes
  std::shared_ptr<const Snapshot> latest;  ///< never null
  std::mutex renewing;
  /// Older scenes that somebody may still hold. They are freed here, not by who asks.
  std::vector<std::shared_ptr<const Snapshot>> before;
};

LiveScene::LiveScene(ArticulatedCollisionManager manager, double seen_at) : impl_(std::make_unique<Impl>()) {
  requireFinite(seen_at, "LiveScene: seen_at");
  manager.setup();
  impl_->latest = std::make_shared<const Snapshot>(Snapshot{std::move(manager), seen_at});
}

LiveScene::~LiveScene() = default;

std::shared_ptr<const LiveScene::Snapshot> LiveScene::latest() const {
  return impl_->get();
}

void LiveScene::renew(double seen_at, const std::function<void(ArticulatedCollisionManager&)>& change) {
  requireFinite(seen_at, "LiveScene: seen_at");
  const std::lock_guard<std::mutex> one_at_a_time(impl_->renewing);
  ArticulatedCollisionManager manager = impl_->get()->manager.copy();
  change(manager);
  manager.update(std::vector<fcl::CollisionObjectd*>());
  auto next = std::make_shared<const Snapshot>(Snapshot{std::move(manager), seen_at});
  auto& before = impl_->before;
  before.push_back(impl_->get());
  {
    const std::lock_guard<std::mutex> lock(impl_->handle);
    impl_->latest = std::move(next);
  }
  before.erase(std::remove_if(before.begin(), before.end(), [](const auto& scene) { return scene.use_count() == 1; }),
               before.end());
}

}  // namespace fcl_artic
