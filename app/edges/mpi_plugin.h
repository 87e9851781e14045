/* SPDX-License-Identifier: BSD-3-Clause */
/* What the program and its plug-in for MPI (app/mpi) have in common. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/// MPI as the program sees it. One thread calls at a time.
struct FclArticMpi {
  /// @return 0, or 1 with the reason written to `why`.
  int (*open)(char* why, size_t size);
  int (*rank)();
  int (*size)();
  /// Adds to one of two counters that all ranks share, at 0 at first. @return what it was.
  int64_t (*add)(int counter, int64_t number);
  /// Waits for all ranks. @param[out] first  rank 0's status. @return the largest status of all.
  int (*finish)(int status, int* first);
  void (*close)();
};

// NOLINTNEXTLINE(readability-identifier-naming): a symbol of C, looked up by name
extern "C" __attribute__((visibility("default"))) const FclArticMpi* fcl_artic_mpi();
