// SPDX-License-Identifier: BSD-3-Clause
int own() {
  return 0;
}
