// SPDX-License-Identifier: BSD-3-Clause
// The one way in which this project reads and writes files. Whatever goes wrong on the way is an error that names the
// file: what a half-read file describes must not be checked, a half-written one must not be left.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_artic::files {

/// All bytes of a regular file; an empty file is empty. Beside regular files, only what a shell passes on as /dev/fd/N
/// or /dev/stdin is read. A device may be endless or do something when it is opened, a pipe of the file system may
/// have nobody at its other end.
/// @throws std::runtime_error naming the file and the system's reason, also for an error after the first bytes.
std::string read(const std::string& path);

/// The file that a path leads to through symbolic links, also where it is not there yet.
std::filesystem::path targetOf(const std::filesystem::path& path);

/// Writes a file, all or nothing. A new one beside it is filled, written down to the disk, and takes its place. (Its
/// permissions stay; if it is a symbolic link, the file it points to is replaced or made.) After a power cut it is
/// there as a whole, or what was there before. A path that is no regular file, but a device or a pipe, is written to.
/// @throws std::runtime_error naming the file and the system's reason; a file that was there is as before.
void write(const std::string& path, std::string_view content);

struct File {
  std::string path;
  std::string_view content;
};
/// Writes files that belong together, each of which is of use only beside those before it. All are filled beside their
/// places first: a disk that fills up changes nothing. Whatever fails then, the power too, at no time does a file stand
/// that is older than one before it: it is missing.
/// @throws std::runtime_error as write().
void writeTogether(const std::vector<File>& files);

/// Hands everything printed so far over to the system. To be called before a program says by its exit status that all
/// is well: what is printed is kept back until then, and errors with it.
/// @throws std::runtime_error when it, or something before it, couldn't be written.
void flushStandardOutput();

}  // namespace fcl_artic::files
