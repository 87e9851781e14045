// SPDX-License-Identifier: BSD-3-Clause
// The headers are precompiled for a program, as programs have other flags than libraries.
int main() {}
