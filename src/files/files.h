// SPDX-License-Identifier: BSD-3-Clause
// The one way in which this project reads and writes files. Whatever goes wrong on the way is an error that names the
// file: what a half-read file describes must not be checked, a half-written one must not be left.
#pragma once

#include <string>
#include <string_view>

namespace fcl_artic::files {

/// All bytes of a regular file; an empty file is empty. Of all else only what a shell passes on as /dev/fd/N or
/// /dev/stdin is read: a device may be endless or do something when it is opened, a pipe of the file system may have
/// nobody at its other end.
/// @throws std::runtime_error naming the file and the system's reason, also for an error after the first bytes.
std::string read(const std::string& path);

/// Writes a file, all or nothing: a new one beside it is filled and takes its place (its permissions stay; of a
/// symbolic link, the file it points to is replaced). What is no regular file, a device or a pipe, is written to.
/// @throws std::runtime_error naming the file and the system's reason; a file that was there is as before.
void write(const std::string& path, std::string_view content);

/// The same of a regular file, and it is on the disk when this returns, under its name too: after a power cut it is
/// there as a whole, or what was there before.
/// @throws std::runtime_error as write().
void writeSynced(const std::string& path, std::string_view content);

/// Hands everything printed so far over to the system. To be called before a program says by its exit status that all
/// is well: what is printed is kept back until then, and errors with it.
/// @throws std::runtime_error when it, or something before it, couldn't be written.
void flushStandardOutput();

}  // namespace fcl_artic::files
