// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles side by side, as an interval's ends or two angles go through together, in code that is compiled once. All
// that depends on the processor is in numerics/pair_*.h; for another processor pair_portable.h serves, or a file that
// defines what follows. Nothing here rounds but the arithmetic of the vector type and pairOf() of integers, which is
// exact.
//
//   Pair                    a vector type of the compiler's, 16 bytes: its + - * / are IEEE 754's in the present mode
//   pairOf(x)               x in both halves
//   pairOf(low, high)
//   pairLow(a), pairHigh(a) one half
//   pairLows(a), pairHighs(a)       one half in both
//   pairLows(a, b), pairHighs(a, b) a's and b's half, in this order
//   pairSwap(a)             halves exchanged
//   pairMix(a, b)           a's low, b's high half
//   pairNegate(a)           sign bits flipped, NaN's too
//   pairNegateLow(a)        the low half so, the high one as it is
//   pairMin(a, b)           a < b ? a : b in each half; so it is b where either is NaN, and where both are zero
//   pairMax(a, b)           a > b ? a : b; likewise
//   pairWhereAtMost(a, b, x, y)     a <= b ? x : y
//   pairGreater(a, b)       an unsigned whose bit i is set where a > b in half i; not where either is NaN
//   pairWithSignOf(x, a)    x > 0 with a's sign
//
//   PairIntegers            two 32-bit integers
//   pairTruncate(a)         a toward zero, |a| < 2^31
//   pairPlus(n, int k)      n + k, modulo 2^32
//   pairOf(n)               n as doubles
//   pairWhereOdd(n, x, y)   n odd ? x : y
//   pairFlip(a, n)          -a where bit 1 of n is set
#pragma once

#if defined(__SSE2__) && !defined(FCL_ARTIC_PORTABLE)
#include "numerics/pair_sse2.h"
#else
#include "numerics/pair_portable.h"
#endif
