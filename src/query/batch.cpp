// SPDX-License-Identifier: BSD-3-Clause
//
// Many motions over threads: queries share nothing but the set-up, so that all that is left is to hand them out.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <thread>

#ifdef FCL_ARTIC_TBB
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#else
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#endif

#include "fcl_artic/manager.h"
#include "query/claim_nothing.h"

namespace fcl_artic {
namespace {

/// Calls f(i) for i in [0, n), over so many threads; what a call throws comes out once all have ended.
template <class F>
void parallelFor(std::size_t n, int threads, const F& f) {
#ifdef FCL_ARTIC_TBB
  if (threads >= tbb::info::default_concurrency())
    return tbb::parallel_for(std::size_t{0}, n, f);  // oneTBB's own arena
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, n, f); });
#else
  constexpr std::size_t kChunk = 16;  // queries of microseconds: the counter is not to be fought for
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t i; (i = next.fetch_add(kChunk)) < n;) {
        for (const std::size_t end = std::min(n, i + kChunk); i < end; ++i) f(i);
      }
    } catch (...) {
      next = n;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!thrown) thrown = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  try {
    for (std::size_t k = 1; k < std::min<std::size_t>(static_cast<std::size_t>(threads), n); ++k)
      others.emplace_back(work);
  } catch (const std::system_error&) {
    // No more threads to be had: those that there are do it.
  }
  work();
  for (std::thread& thread : others) thread.join();
  if (thrown) std::rethrow_exception(thrown);
#endif
}

}  // namespace

void ArticulatedCollisionManager::continuousCollide(const std::vector<JointMotion>& motions,
                                                    const CertifiedRequest& request,
                                                    std::vector<CertifiedResult>& results, int threads) const {
  const auto reset = [&] {
    for (CertifiedResult& result : results) claimNothing(result);
  };
  for (CertifiedResult& result : results) withdrawClaims(result, 0, 1);
  resetUnlessAnswered(reset, [&] {
    if (threads < 0) {
      throw std::invalid_argument("continuousCollide: the number of threads is " + std::to_string(threads));
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i].isOf(tree())) motions[i].requireOf(tree(), ("motion " + std::to_string(i)).c_str());
    }
    CertifiedRequest alike = request;
    alike.progress = nullptr;
    results.resize(motions.size());
    const int most = threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const auto answer = [&](std::size_t i) { collideMotion(motions[i], alike, results[i]); };
    if (most == 1 || motions.size() < 2) {
      for (std::size_t i = 0; i < motions.size(); ++i) answer(i);
    } else {
      parallelFor(motions.size(), most, answer);
    }
  });
}

}  // namespace fcl_artic
