// SPDX-License-Identifier: BSD-3-Clause
#include "files/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>

namespace fcl_artic::files {
namespace {

[[noreturn]] void failToRead(const std::string& path) {
  throw std::runtime_error("'" + path + "': cannot be read: " + std::strerror(errno));
}
[[noreturn]] void failToWrite(const std::string& what) {
  throw std::runtime_error("cannot write " + what + ": " + std::strerror(errno));
}

/// @throws std::runtime_error saying what it is, unless it is a regular file.
void requireRegular(const std::string& path, const struct stat& status) {
  if (S_ISREG(status.st_mode)) return;
  const char* const kind = S_ISDIR(status.st_mode)    ? "a directory"
                           : S_ISFIFO(status.st_mode) ? "a pipe"
                           : S_ISSOCK(status.st_mode) ? "a socket"
                                                      : "a device";
  throw std::runtime_error("'" + path + "': is " + kind + ", not a file");
}

/// Whether the shell opened it for this process: `<(command)`, standard input.
bool isPassedOn(const std::string& path) {
  return path.rfind("/dev/fd/", 0) == 0 || path.rfind("/proc/self/fd/", 0) == 0 || path == "/dev/stdin";
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    const int kept = errno;  // of the error that is being reported
    if (number_ >= 0) ::close(number_);
    errno = kept;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  bool good() const { return number_ >= 0; }
  /// Some systems report only now that there was no room.
  bool close() {
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

bool writeAll(const Descriptor& to, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(to.number(), content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// Creates a file that isn't there yet beside `path`. @param[out] name  of it.
int createBeside(const std::string& path, std::string& name) {
  for (int k = 0;; ++k) {
    name = path + ".part" + std::to_string(::getpid()) + "-" + std::to_string(k);
    const int number = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (number >= 0 || errno != EEXIST) return number;
  }
}

/// Has the system write a folder's list of names to the disk.
bool syncFolder(const std::filesystem::path& folder) {
  const Descriptor at(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems sync no folder, and say so.
  return at.good() && (::fsync(at.number()) == 0 || errno == EINVAL);
}

/// @param synced  it is on the disk when this returns.
void writeRegular(const std::string& path, std::string_view content, bool synced) {
  const std::string what = "'" + path + "'";
  struct stat old {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (exists) requireRegular(path, old);
  if (exists && ::access(path.c_str(), W_OK) != 0) failToWrite(what);  // a new file would take its place all the same
  // Of a symbolic link the file that it points to is replaced.
  std::error_code error;
  const std::filesystem::path resolved = std::filesystem::weakly_canonical(path, error);
  const std::filesystem::path target = error ? std::filesystem::path(path) : resolved;
  std::string name;
  Descriptor to(createBeside(target.string(), name));
  if (!to.good()) failToWrite(what);
  const bool done = writeAll(to, content) && (!exists || ::fchmod(to.number(), old.st_mode & 07777) == 0) &&
                    (!synced || ::fsync(to.number()) == 0) && to.close() && ::rename(name.c_str(), target.c_str()) == 0;
  if (done && (!synced || syncFolder(target.parent_path()))) return;
  if (done) failToWrite(what);
  const int reason = errno;
  ::unlink(name.c_str());
  errno = reason;
  failToWrite(what);
}

}  // namespace

std::string read(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) failToRead(path);
  const bool passed_on = isPassedOn(path);
  if (!passed_on) requireRegular(path, status);
  // Not blocking: the file may have been replaced by a pipe just now.
  const Descriptor from(::open(path.c_str(), O_RDONLY | O_CLOEXEC | (passed_on ? 0 : O_NONBLOCK)));
  if (!from.good() || ::fstat(from.number(), &status) != 0) failToRead(path);
  if (!passed_on || S_ISDIR(status.st_mode)) requireRegular(path, status);
  std::string content;
  if (S_ISREG(status.st_mode) && status.st_size > 0) content.reserve(static_cast<std::size_t>(status.st_size));
  char block[1 << 16];
  for (;;) {
    const ssize_t got = ::read(from.number(), block, sizeof block);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) failToRead(path);
    if (got == 0) return content;
    content.append(block, static_cast<std::size_t>(got));
  }
}

void write(const std::string& path, std::string_view content) {
  const std::string what = "'" + path + "'";
  struct stat old {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) {
    Descriptor to(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (!to.good() || !writeAll(to, content) || !to.close()) failToWrite(what);
    return;
  }
  writeRegular(path, content, false);
}

void writeSynced(const std::string& path, std::string_view content) {
  writeRegular(path, content, true);
}

void flushStandardOutput() {
  errno = 0;
  std::cout.flush();  // goes to stdout
  const bool good = std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout.good();
  if (good) return;
  if (errno == 0) throw std::runtime_error("cannot write standard output");  // the reason is that of an earlier call
  failToWrite("standard output");
}

}  // namespace fcl_artic::files
