// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BITS 0
#define FCL_ARTIC_ISA_SUBJECT kSubjectPortable
#include "subject.inl"
