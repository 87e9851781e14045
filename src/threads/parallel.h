// SPDX-License-Identifier: BSD-3-Clause
//
// Many calls over threads.
#pragma once

#include <algorithm>
#include <cstddef>
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
#include <vector>
#endif

namespace fcl_artic {

/// The number of threads that a caller's number stands for; 0: as many as the machine runs at once.
inline std::size_t threadsFor(int most_threads) {
  if (most_threads > 0) return static_cast<std::size_t>(most_threads);
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// Calls f(i) for i in [0, n), over `most_threads` threads at most (0: as many as the machine runs at once). If a call
/// throws, its exception is thrown again once all have ended.
template <class F>
void parallelFor(std::size_t n, int most_threads, const F& f) {
  const auto threads = static_cast<int>(threadsFor(most_threads));
  if (threads == 1 || n < 2) {
    for (std::size_t i = 0; i < n; ++i) f(i);
    return;
  }
#ifdef FCL_ARTIC_TBB
  if (threads >= tbb::info::default_concurrency())
    return tbb::parallel_for(std::size_t{0}, n, f);  // oneTBB's own arena
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, n, f); });
#else
  // Queries of microseconds: the counter is not to be fought for. Few are long: each goes by itself.
  const std::size_t chunk = n >= 1024 ? 16 : 1;
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t i; (i = next.fetch_add(chunk)) < n;) {
        for (const std::size_t end = std::min(n, i + chunk); i < end; ++i) f(i);
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

/// Calls f(share, begin, end) for each of `shares` equal shares of [0, n): what each thread does by itself.
template <class F>
void parallelShares(std::size_t n, std::size_t shares, const F& f) {
  const auto begin = [&](std::size_t share) { return n / shares * share + std::min(n % shares, share); };
  parallelFor(shares, static_cast<int>(shares), [&](std::size_t share) { f(share, begin(share), begin(share + 1)); });
}

}  // namespace fcl_artic
