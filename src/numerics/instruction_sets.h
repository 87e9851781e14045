// SPDX-License-Identifier: BSD-3-Clause
//
// The instruction sets for which this build has batches and an engine, and the choice among them at run time. One more
// takes:
// - a line here,
// - numerics/register_*.h and where it has directed rounding interval/processor_*.h,
// - a file of its own for what is compiled for it (narrowphase/engine_*.cpp, redon/box_batch_*.cpp),
// - a name in cmake/InstructionSets.cmake, which lists the compiler's flags.
#pragma once

#include <cstddef>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "fcl_artic reads binary files and packs numbers for little-endian processors; this one is big-endian"
#endif

// The widest first: X(name, Name). FCL_ARTIC_ENGINES are those with an engine: the last one runs on every processor of
// the kind. All sets have batches; "portable" ones need no rounding mode.
#if defined(__x86_64__) && defined(FCL_ARTIC_BASELINE_ONLY)
#define FCL_ARTIC_INSTRUCTION_SETS(X) X(sse2, Sse2) X(portable, Portable)
#define FCL_ARTIC_ENGINES(X) X(sse2, Sse2)
#elif defined(__x86_64__) && !defined(FCL_ARTIC_PORTABLE)
#define FCL_ARTIC_INSTRUCTION_SETS(X) X(avx512, Avx512) X(avx2, Avx2) X(sse2, Sse2) X(portable, Portable)
#define FCL_ARTIC_ENGINES(X) X(avx512, Avx512) X(avx2, Avx2) X(sse2, Sse2)
#elif defined(__aarch64__) && !defined(FCL_ARTIC_PORTABLE)
#define FCL_ARTIC_INSTRUCTION_SETS(X) X(neon, Neon) X(portable, Portable)
#define FCL_ARTIC_ENGINES(X) X(neon, Neon)
#else
#define FCL_ARTIC_INSTRUCTION_SETS(X) X(portable, Portable)
#define FCL_ARTIC_ENGINES(X) X(portable, Portable)
#endif

namespace fcl_artic {

/// Whether this processor has the instruction set of that name, one of FCL_ARTIC_INSTRUCTION_SETS.
bool processorRuns(const char* name);

bool sameName(const char* a, const char* b);
/// The name that FCL_ARTIC_ISA in the environment gives; null where it is not set.
const char* instructionSetAsked();

/// The one of that name; null where there is none, or `runs` refuses it.
template <class T, std::size_t n>
const T* findNamed(const T* const (&all)[n], const char* name, bool (*runs)(const T&)) {
  for (const T* one : all) {
    if (sameName(one->name, name) && runs(*one)) return one;
  }
  return nullptr;
}

/// The one that the environment asks for, where it runs; else the first that does.
template <class T, std::size_t n>
const T& chooseWidest(const T* const (&all)[n], bool (*runs)(const T&)) {
  if (const char* asked = instructionSetAsked()) {
    if (const T* found = findNamed(all, asked, runs)) return *found;
  }
  for (const T* one : all) {
    if (runs(*one)) return *one;
  }
  return *all[n - 1];
}

}  // namespace fcl_artic
