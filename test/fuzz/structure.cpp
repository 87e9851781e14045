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
  using fcl_artic::test::changedFile;
  fcl_artic::test::Random random(seed);
  if (size == 0 || random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string content(reinterpret_cast<const char*>(data), size);
  // Some targets have a byte for the format before the file.
  const std::size_t begin = content[0] == '{' || content[0] == '<' ? 0 : 1;
  const char* const name = begin < size && content[begin] == '{' ? "file.json" : "file.txt";
  const std::string text = content.substr(0, begin) + changedFile(name, content.substr(begin), random);
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}
