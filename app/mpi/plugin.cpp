// SPDX-License-Identifier: BSD-3-Clause
//
// MPI for `certify --edges`: two counters in rank 0's memory, which all ranks add to by one-sided MPI_Fetch_and_op, so
// that nobody has to answer for them.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "edges/mpi_plugin.h"

namespace {

int rank_ = 0, size_ = 1;
std::int64_t* counters = nullptr;
MPI_Win window;
std::thread attendant;
std::atomic<bool> over{false};

/// Over networks without remote atomics, rank 0's MPI serves its counters only while it is in a call, and rank 0
/// computes for seconds on end. This thread has it look a hundred times a second. (Within one machine the counters are
/// shared memory, and nobody needs to look.)
void attend() {
  while (!over) {
    int there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

int open(char* why, std::size_t size) {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &provided) != MPI_SUCCESS) {
    std::snprintf(why, size, "MPI_Init_thread failed");
    return 1;
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  const MPI_Aint bytes = rank_ == 0 ? static_cast<MPI_Aint>(2 * sizeof(std::int64_t)) : 0;
  MPI_Win_allocate(bytes, sizeof(std::int64_t), MPI_INFO_NULL, MPI_COMM_WORLD, &counters, &window);
  MPI_Win_lock_all(0, window);
  if (rank_ == 0) {
    counters[0] = counters[1] = 0;
    MPI_Win_sync(window);
  }
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
  int on_machine = 0;
  MPI_Comm_size(machine, &on_machine);
  MPI_Comm_free(&machine);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank_ == 0 && on_machine < size_ && provided == MPI_THREAD_MULTIPLE) attendant = std::thread(attend);
  return 0;
}

int rank() {
  return rank_;
}
int size() {
  return size_;
}

std::int64_t add(int counter, std::int64_t number) {
  std::int64_t before = 0;
  MPI_Fetch_and_op(&number, &before, MPI_INT64_T, 0, counter, MPI_SUM, window);
  MPI_Win_flush(0, window);
  return before;
}

/// Sleeps until `request` is done: MPI_Wait alone would take a processor from those that still compute.
void sleepUntilDone(MPI_Request& request) {
  for (int done = 0; !done;) {
    MPI_Request_get_status(request, &done, MPI_STATUS_IGNORE);
    if (!done) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

int finish(int status, int* first) {
  int most = status;
  *first = status;
  MPI_Request request;
  MPI_Iallreduce(&status, &most, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
  sleepUntilDone(request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  MPI_Ibcast(first, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  sleepUntilDone(request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  return most;
}

void close() {
  over = true;
  if (attendant.joinable()) attendant.join();
  MPI_Win_unlock_all(window);
  MPI_Win_free(&window);
  MPI_Finalize();
}

const FclArticMpi kMpi = {open, rank, size, add, finish, close};

}  // namespace

extern "C" const FclArticMpi* fcl_artic_mpi() {
  return &kMpi;
}
