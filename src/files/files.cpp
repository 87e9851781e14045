// SPDX-License-Identifier: BSD-3-Clause
#include "files/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <deque>
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

/// @throws std::runtime_error naming the kind of file, unless it is a regular file.
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

/// Has the system write a folder's list of names to the disk.
bool syncFolder(const std::filesystem::path& folder) {
  const Descriptor at(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems sync no folder, and say so.
  return at.good() && (::fsync(at.number()) == 0 || errno == EINVAL);
}

/// A regular file that is written as a whole beside the file that it replaces. If it is not kept, it is removed.
class FileAside {
 public:
  /// Writes it, down to the disk.
  FileAside(const std::string& path, std::string_view content) : path_(path), target_(targetOf(path)) {
    struct stat old {};
    replaces_ = ::stat(target_.c_str(), &old) == 0;
    if (!replaces_ && errno == ELOOP) fail();  // links that go round
    if (replaces_) requireRegular(path, old);
    if (replaces_ && ::access(target_.c_str(), W_OK) != 0) fail();  // a new file would take its place all the same
    Descriptor to(create());
    const bool done = to.good() && writeAll(to, content) &&
                      (!replaces_ || ::fchmod(to.number(), old.st_mode & 07777) == 0) && ::fsync(to.number()) == 0 &&
                      to.close();
    if (done) return;
    if (to.good()) removeAside();
    fail();
  }
  ~FileAside() {
    if (!kept_) removeAside();
  }
  FileAside(const FileAside&) = delete;
  FileAside& operator=(const FileAside&) = delete;

  /// Removes the file whose place it will take, if there is one.
  void removeOld() const {
    if (replaces_ && (::unlink(target_.c_str()) != 0 || !syncFolder(target_.parent_path()))) fail();
  }
  void takePlace() {
    if (::rename(name_.c_str(), target_.c_str()) != 0) fail();
    kept_ = true;
    if (!syncFolder(target_.parent_path())) fail();
  }

 private:
  [[noreturn]] void fail() const { failToWrite("'" + path_ + "'"); }
  int create() {
    for (int k = 0;; ++k) {
      name_ = target_.string() + ".part" + std::to_string(::getpid()) + "-" + std::to_string(k);
      const int number = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (number >= 0 || errno != EEXIST) return number;
    }
  }
  void removeAside() const {
    const int kept = errno;  // of the error that is being reported
    ::unlink(name_.c_str());
    errno = kept;
  }

  const std::string path_;
  const std::filesystem::path target_;
  std::string name_;
  bool replaces_ = false, kept_ = false;
};

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

std::filesystem::path targetOf(const std::filesystem::path& path) {
  std::filesystem::path target = path;
  std::error_code error;
  constexpr int kMaxLinks = 40;  // Linux follows no more
  for (int k = 0; k < kMaxLinks && std::filesystem::is_symlink(std::filesystem::symlink_status(target, error)); ++k) {
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) break;
    target = target.parent_path() / next;
  }
  return target;
}

void write(const std::string& path, std::string_view content) {
  writeTogether({{path, content}});
}

void writeTogether(const std::vector<File>& files) {
  std::deque<FileAside> all;
  for (const File& file : files) {
    struct stat there {};
    if (::stat(file.path.c_str(), &there) != 0 || S_ISREG(there.st_mode)) {
      all.emplace_back(file.path, file.content);
      continue;
    }
    Descriptor to(::open(file.path.c_str(), O_WRONLY | O_CLOEXEC));
    if (!to.good() || !writeAll(to, file.content) || !to.close()) failToWrite("'" + file.path + "'");
  }
  // From here on old files are replaced. The last of the old ones is removed first. So at no time, even after a power
  // cut, an old file stands behind a new one in the list.
  for (std::size_t i = all.size(); i-- > 1;) all[i].removeOld();
  for (FileAside& one : all) one.takePlace();
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
