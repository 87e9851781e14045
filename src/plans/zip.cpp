// SPDX-License-Identifier: BSD-3-Clause
// The zip format is described in PKWARE's APPNOTE.TXT 6.3: a directory at the end names the files and where they begin.
#include "plans/zip.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <zlib.h>

namespace fcl_artic::plans {
namespace {

constexpr std::uint32_t kEnd = 0x06054b50, kDirectory = 0x02014b50, kLocal = 0x04034b50;  // signatures, little-endian
constexpr std::size_t kEndSize = 22, kDirectorySize = 46, kLocalSize = 30;
constexpr std::uint32_t kElsewhere = 0xffffffff;  // zip64: the number stands in another record
constexpr std::size_t kMaxPerByte = 1032;         // deflate makes at most this much of a byte
// Most bytes of all files of an archive together, unpacked. Plans are some thousand numbers each, and a small archive
// may be made to take all memory.
constexpr std::size_t kMaxUnpacked = std::size_t{1} << 30;

[[noreturn]] void refuseArchive(const std::string& what) {
  throw std::invalid_argument("the archive: " + what);
}

std::uint32_t number(std::string_view bytes, std::size_t at, int size) {
  if (at > bytes.size() || bytes.size() - at < static_cast<std::size_t>(size)) refuseArchive("it is cut short");
  std::uint32_t value = 0;
  for (int i = size - 1; i >= 0; --i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

std::string_view part(std::string_view bytes, std::size_t at, std::size_t size) {
  if (at > bytes.size() || size > bytes.size() - at) refuseArchive("it is cut short");
  return bytes.substr(at, size);
}

std::string inflated(std::string_view packed, std::size_t size, const std::string& name) {
  if (size / kMaxPerByte > packed.size())
    refuseArchive(fmt::format("'{}' claims {} bytes of {}", name, size, packed.size()));
  std::string out(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) refuseArchive("zlib does not start");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(size);
  const int end = inflate(&stream, Z_FINISH);
  const std::size_t written = stream.total_out;
  inflateEnd(&stream);
  if (end != Z_STREAM_END || written != size) refuseArchive(fmt::format("'{}' cannot be unpacked", name));
  return out;
}

std::size_t findEnd(std::string_view bytes) {
  if (bytes.size() < kEndSize) refuseArchive("it is no zip archive");
  const std::size_t first = bytes.size() - std::min<std::size_t>(bytes.size(), kEndSize + 0xffff);
  for (std::size_t at = bytes.size() - kEndSize + 1; at-- > first;) {
    if (number(bytes, at, 4) == kEnd) return at;
  }
  refuseArchive("it is no zip archive, or cut short");
}

}  // namespace

std::vector<ZipEntry> unzip(std::string_view content) {
  const std::size_t end = findEnd(content);
  const std::uint32_t entries = number(content, end + 10, 2);
  if (number(content, end + 4, 2) != 0 || number(content, end + 8, 2) != entries)
    refuseArchive("it has several volumes");
  std::size_t at = number(content, end + 16, 4);
  if (at == kElsewhere || entries == 0xffff) refuseArchive("archives of over 4 GB or 65534 files are not read");
  std::vector<ZipEntry> out;
  std::size_t unpacked = 0;
  for (std::uint32_t i = 0; i < entries; ++i) {
    if (number(content, at, 4) != kDirectory) refuseArchive("its directory is damaged");
    const std::uint32_t flags = number(content, at + 8, 2), method = number(content, at + 10, 2),
                        sum = number(content, at + 16, 4), packed = number(content, at + 20, 4),
                        size = number(content, at + 24, 4), local = number(content, at + 42, 4);
    const std::size_t name_size = number(content, at + 28, 2);
    const std::string name(part(content, at + kDirectorySize, name_size));
    at += kDirectorySize + name_size + number(content, at + 30, 2) + number(content, at + 32, 2);
    if (flags & 1) refuseArchive(fmt::format("'{}' is encrypted", name));
    if (packed == kElsewhere || size == kElsewhere || local == kElsewhere)
      refuseArchive(fmt::format("'{}' is over 4 GB", name));
    if (number(content, local, 4) != kLocal) refuseArchive("its directory is damaged");
    const std::size_t begin = std::size_t{local} + kLocalSize + number(content, std::size_t{local} + 26, 2) +
                              number(content, std::size_t{local} + 28, 2);
    const std::string_view bytes = part(content, begin, packed);
    unpacked += size;
    if (unpacked > kMaxUnpacked)
      refuseArchive(fmt::format("unpacked it takes over {} bytes; save the arrays one by one (.npy)", kMaxUnpacked));
    if (method != 0 && method != 8)
      refuseArchive(fmt::format("'{}' is packed by method {}, which is not read", name, method));
    if (method == 0 && packed != size) refuseArchive(fmt::format("'{}' is stored in another size than its own", name));
    std::string text = method == 0 ? std::string(bytes) : inflated(bytes, size, name);
    const uLong found = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
    if (found != sum) refuseArchive(fmt::format("'{}' has a wrong check sum", name));
    out.push_back({name, std::move(text)});
  }
  return out;
}

}  // namespace fcl_artic::plans
