// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Marks the symbols that the shared library exports; all others are hidden.
#define FCL_ARTIC_EXPORT __attribute__((visibility("default")))
