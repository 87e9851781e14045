// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA neon
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_SUBJECT kSubjectNeon
#include "subject.inl"
