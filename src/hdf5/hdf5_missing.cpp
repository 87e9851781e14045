// SPDX-License-Identifier: BSD-3-Clause
// In place of hdf5.cpp where HDF5 was not found.
#include <stdexcept>

#include "hdf5/hdf5.h"

namespace fcl_artic::hdf5 {
namespace {

[[noreturn]] void refuse() {
  throw std::runtime_error("HDF5 files: this program was built without HDF5 (Debian: libhdf5-dev), build it with it");
}

}  // namespace

struct File::Impl {};
File::File(const std::string&) {
  refuse();
}
File::File(const std::string&, const std::string&) {
  refuse();
}
File::~File() = default;
File::File(File&&) noexcept = default;
File& File::operator=(File&&) noexcept = default;
const std::string& File::path() const {
  refuse();
}
std::vector<std::string> File::datasets() const {
  refuse();
}
bool File::has(const std::string&) const {
  refuse();
}
std::vector<std::size_t> File::shape(const std::string&) const {
  refuse();
}
void File::read(const std::string&, std::size_t, std::size_t, std::vector<double>&) const {
  refuse();
}
void File::read(const std::string&, std::size_t, std::size_t, std::vector<std::int64_t>&) const {
  refuse();
}
std::vector<std::string> File::strings(const std::string&, const std::string&) const {
  refuse();
}

struct Image::Impl {};
Image::Image() {
  refuse();
}
Image::~Image() = default;
void Image::add(const std::string&, const std::vector<std::size_t>&, const std::int8_t*) {
  refuse();
}
void Image::add(const std::string&, const std::vector<std::size_t>&, const std::int32_t*) {
  refuse();
}
void Image::add(const std::string&, const std::vector<std::size_t>&, const std::int64_t*) {
  refuse();
}
void Image::add(const std::string&, const std::vector<std::size_t>&, const double*) {
  refuse();
}
void Image::addVirtual(const std::string&, Type, const std::vector<std::size_t>&, double, const std::vector<Source>&) {
  refuse();
}
void Image::attribute(const std::string&, const std::string&, const std::vector<std::string>&) {
  refuse();
}
void Image::attribute(const std::string&, const std::string&, const std::string&) {
  refuse();
}
std::string Image::bytes() {
  refuse();
}

}  // namespace fcl_artic::hdf5
