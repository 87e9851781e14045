// SPDX-License-Identifier: BSD-3-Clause
#include "children.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include "elapsed.h"

namespace fcl_artic::app {
namespace {

/// Memory that parent and children share: the results, and how far the children have come.
class SharedResults {
 public:
  explicit SharedResults(std::size_t count) : bytes_(sizeof(Head) + count * sizeof(TaskResult)) {
    memory_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::runtime_error("no memory to share with child processes");
    new (memory_) Head;
    results_ = reinterpret_cast<TaskResult*>(static_cast<char*>(memory_) + sizeof(Head));
    for (std::size_t i = 0; i < count; ++i) new (results_ + i) TaskResult;
  }
  ~SharedResults() { munmap(memory_, bytes_); }
  SharedResults(const SharedResults&) = delete;
  SharedResults& operator=(const SharedResults&) = delete;

  std::atomic<std::size_t>& finished() { return static_cast<Head*>(memory_)->finished; }
  TaskResult& operator[](std::size_t i) { return results_[i]; }

 private:
  struct alignas(TaskResult) alignas(64) Head {
    std::atomic<std::size_t> finished{0};
  };
  static_assert(std::atomic<std::size_t>::is_always_lock_free);
  std::size_t bytes_;
  void* memory_;
  TaskResult* results_;
};

[[noreturn]] void runChild(std::size_t count, const std::function<TaskResult(std::size_t)>& task,
                           SharedResults& shared) {
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  for (std::size_t i = shared.finished(); i < count; i = shared.finished()) {
    try {
      shared[i] = task(i);
    } catch (...) {
      shared[i].end = TaskResult::End::refused;
    }
    shared.finished() = i + 1;
  }
  _exit(0);
}

}  // namespace

std::vector<TaskResult> runInChildren(std::size_t count, double limit_s,
                                      const std::function<TaskResult(std::size_t)>& task,
                                      const std::function<void(std::size_t)>& done) {
  SharedResults shared(count);
  while (shared.finished() < count) {
    std::fflush(nullptr);  // nothing is left in buffers for the child to write once more
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error(std::string("cannot make a child process: ") + std::strerror(errno));
    if (child == 0) runChild(count, task, shared);

    std::size_t seen = shared.finished();
    auto since = Clock::now();
    bool timed_out = false;
    for (int status = 0; waitpid(child, &status, WNOHANG) != child;) {
      usleep(300);
      const std::size_t now = shared.finished();
      if (now != seen) {
        seen = now, since = Clock::now();
        if (done) done(seen);
      } else if (!timed_out && std::chrono::duration<double>(Clock::now() - since).count() > limit_s) {
        kill(child, SIGKILL);
        timed_out = true;
      }
    }
    const std::size_t last = shared.finished();
    if (last >= count) break;
    shared[last].end = timed_out ? TaskResult::End::timed_out : TaskResult::End::crashed;
    shared.finished() = last + 1;
  }
  std::vector<TaskResult> results;
  for (std::size_t i = 0; i < count; ++i) results.push_back(shared[i]);
  return results;
}

}  // namespace fcl_artic::app
