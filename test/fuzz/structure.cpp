// SPDX-License-Identifier: BSD-3-Clause
// Half of the inputs that a fuzzer makes are changed in their structure: lines, words, elements are removed, doubled,
// moved or replaced. Bytewise changes seldom leave a file that is read to its end.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "../readers/changes.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  fcl_artic::test::Random random(seed);
  if (size == 0 || random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text =
      fcl_artic::test::changedFile("file.txt", std::string(reinterpret_cast<const char*>(data), size), random);
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}
