// SPDX-License-Identifier: BSD-3-Clause
// Loaded before the C library: reading a file whose path ends in $FCL_ARTIC_FAIL_FILE fails with EIO from byte
// $FCL_ARTIC_FAIL_AFTER on, as on a disk with a bad block.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

/// Bytes that may be read here; -1: no limit.
long roomAt(int file, long at) {
  const char *name = std::getenv("FCL_ARTIC_FAIL_FILE"), *after = std::getenv("FCL_ARTIC_FAIL_AFTER");
  if (!name || !after) return -1;
  char path[4096];
  const ssize_t length = readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
  const std::string whole(path, static_cast<std::size_t>(std::max<ssize_t>(length, 0))), end = name;
  if (whole.size() < end.size() || whole.substr(whole.size() - end.size()) != end) return -1;
  return std::max(0L, std::atol(after) - at);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) ssize_t read(int file, void* to, size_t size) {
  static const auto real = reinterpret_cast<ssize_t (*)(int, void*, size_t)>(dlsym(RTLD_NEXT, "read"));
  const long room = roomAt(file, lseek(file, 0, SEEK_CUR));
  if (room == 0 && size > 0) {
    errno = EIO;
    return -1;
  }
  return real(file, to, room < 0 ? size : std::min(size, static_cast<size_t>(room)));
}

extern "C" __attribute__((visibility("default"))) size_t fread(void* to, size_t size, size_t count, FILE* file) {
  static const auto real = reinterpret_cast<size_t (*)(void*, size_t, size_t, FILE*)>(dlsym(RTLD_NEXT, "fread"));
  const long room = roomAt(fileno(file), std::ftell(file));
  if (room < 0 || size == 0 || count <= static_cast<size_t>(room) / size) return real(to, size, count, file);
  errno = EIO;  // stdio's own flag for it can't be set from here
  return real(to, size, static_cast<size_t>(room) / size, file);
}
