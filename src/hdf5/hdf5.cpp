// SPDX-License-Identifier: BSD-3-Clause
#include "hdf5/hdf5.h"

#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>

#include "text/nearest_name.h"

namespace fcl_artic::hdf5 {
namespace {

/// The innermost reason of HDF5's last error.
std::string reason() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
        auto& found = *static_cast<std::string*>(out);
        if (found.empty() && error->desc) found = error->desc;
        return 0;
      },
      &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

/// A handle of HDF5's that is closed by its own function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  bool good() const { return id_ >= 0; }
  hid_t id() const { return id_; }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// HDF5 prints its errors unless it is told not to.
void beQuiet() {
  static const bool done = [] {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return true;
  }();
  (void)done;
}

/// A name that no file in memory or on a disk has: HDF5 takes two of one name for the same file.
std::string imageName() {
  static std::size_t number = 0;
  return "/dev/null/image" + std::to_string(number++);
}

Handle inMemory() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.id(), std::size_t{1} << 20, 0);
  return access;
}

hid_t memoryType(const std::int8_t*) {
  return H5T_NATIVE_INT8;
}
hid_t memoryType(const std::int32_t*) {
  return H5T_NATIVE_INT32;
}
hid_t memoryType(const std::int64_t*) {
  return H5T_NATIVE_INT64;
}
hid_t memoryType(const double*) {
  return H5T_NATIVE_DOUBLE;
}
/// Little-endian in files, whatever the machine.
hid_t fileType(Type type) {
  switch (type) {
    case Type::int8:
      return H5T_STD_I8LE;
    case Type::int32:
      return H5T_STD_I32LE;
    case Type::int64:
      return H5T_STD_I64LE;
    case Type::float64:
      return H5T_IEEE_F64LE;
  }
  return H5T_IEEE_F64LE;
}
Type typeOf(const std::int8_t*) {
  return Type::int8;
}
Type typeOf(const std::int32_t*) {
  return Type::int32;
}
Type typeOf(const std::int64_t*) {
  return Type::int64;
}
Type typeOf(const double*) {
  return Type::float64;
}

std::vector<hsize_t> sizes(const std::vector<std::size_t>& shape) {
  return {shape.begin(), shape.end()};
}

[[noreturn]] void failToMake(const std::string& what) {
  throw std::runtime_error("HDF5: " + what + " can't be made: " + reason());
}

}  // namespace

struct File::Impl {
  std::string path;
  Handle file{H5I_INVALID_HID, H5Fclose};
  mutable std::map<std::string, Handle> open_;  // closed before the file

  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error("'" + path + "': " + what); }

  /// The dataset stays open, with its cache of chunks: many callers read a few rows after the other.
  const Handle& open(const std::string& dataset) const {
    const auto known = open_.find(dataset);
    if (known != open_.end()) return known->second;
    Handle set(H5Dopen2(file.id(), dataset.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.good()) return open_.emplace(dataset, std::move(set)).first->second;
    const std::string why = reason();
    const std::vector<std::string> names = datasets();
    if (std::find(names.begin(), names.end(), dataset) != names.end()) {
      fail("dataset '" + dataset + "' can't be read: " + why);
    }
    fail("there is no dataset '" + dataset + "'" + text::didYouMean(dataset, names));
  }

  std::vector<std::string> datasets() const {
    std::vector<std::string> names;
    H5Literate(
        file.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr,
        [](hid_t group, const char* name, const H5L_info_t*, void* out) -> herr_t {
          const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
          if (object.good() && H5Iget_type(object.id()) == H5I_DATASET) {
            static_cast<std::vector<std::string>*>(out)->emplace_back(name);
          }
          return 0;
        },
        &names);
    return names;
  }

  std::vector<std::size_t> shapeOf(const Handle& set, const std::string& dataset) const {
    const Handle space(H5Dget_space(set.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0) fail("dataset '" + dataset + "' has no dimensions: " + reason());
    std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
    if (rank > 0) H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr);
    return {dims.begin(), dims.end()};
  }

  template <class T>
  void read(const Handle& set, const std::string& dataset, std::size_t begin, std::size_t count,
            std::vector<T>& values) const {
    const std::vector<std::size_t> shape = shapeOf(set, dataset);
    if (shape.empty()) fail("dataset '" + dataset + "' is a single value, not a table of rows");
    if (begin > shape[0] || count > shape[0] - begin) {
      fail("dataset '" + dataset + "' has " + std::to_string(shape[0]) + " rows; asked for row " +
           std::to_string(begin + count - 1));
    }
    const Handle type(H5Dget_type(set.id()), H5Tclose);
    const H5T_class_t kind = H5Tget_class(type.id());
    const bool whole = kind == H5T_INTEGER || kind == H5T_ENUM;
    if (typeOf(values.data()) == Type::float64 ? !(whole || kind == H5T_FLOAT) : !whole) {
      fail("dataset '" + dataset + "' does not hold " +
           (typeOf(values.data()) == Type::float64 ? "numbers" : "whole numbers"));
    }
    std::vector<hsize_t> start(shape.size(), 0), size = sizes(shape);
    start[0] = begin;
    size[0] = count;
    std::size_t all = 1;
    for (const hsize_t n : size) all *= static_cast<std::size_t>(n);
    values.resize(all);
    if (all == 0) return;
    const Handle space(H5Dget_space(set.id()), H5Sclose);
    const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) < 0 ||
        H5Dread(set.id(), memoryType(values.data()), memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
      fail("dataset '" + dataset + "' can't be read: " + reason());
    }
  }
};

File::File(const std::string& path) : impl_(std::make_unique<Impl>()) {
  beQuiet();
  impl_->path = path;
  impl_->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!impl_->file.good()) impl_->fail("can't be read as an HDF5 file: " + reason());
}

File::File(const std::string& bytes, const std::string& name) : impl_(std::make_unique<Impl>()) {
  beQuiet();
  impl_->path = name;
  const Handle access = inMemory();
  H5Pset_file_image(access.id(), const_cast<char*>(bytes.data()), bytes.size());  // NOLINT: it is copied
  impl_->file = Handle(H5Fopen(imageName().c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!impl_->file.good()) impl_->fail("is no HDF5 file, or a damaged one: " + reason());
}

File::~File() = default;
File::File(File&&) noexcept = default;
File& File::operator=(File&&) noexcept = default;

const std::string& File::path() const {
  return impl_->path;
}

std::vector<std::string> File::datasets() const {
  return impl_->datasets();
}

bool File::has(const std::string& dataset) const {
  const std::vector<std::string> known = datasets();
  return std::find(known.begin(), known.end(), dataset) != known.end();
}

std::vector<std::size_t> File::shape(const std::string& dataset) const {
  return impl_->shapeOf(impl_->open(dataset), dataset);
}

void File::read(const std::string& dataset, std::size_t begin, std::size_t count, std::vector<double>& values) const {
  impl_->read(impl_->open(dataset), dataset, begin, count, values);
}

void File::read(const std::string& dataset, std::size_t begin, std::size_t count,
                std::vector<std::int64_t>& values) const {
  impl_->read(impl_->open(dataset), dataset, begin, count, values);
}

std::vector<std::string> File::strings(const std::string& dataset, const std::string& attribute) const {
  const Handle object(H5Oopen(impl_->file.id(), dataset.empty() ? "/" : dataset.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.good() || H5Aexists(object.id(), attribute.c_str()) <= 0) return {};
  const Handle a(H5Aopen(object.id(), attribute.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(a.id()), H5Tclose);
  const Handle space(H5Aget_space(a.id()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  const std::string what = "attribute '" + attribute + "'";
  if (count < 0 || H5Tget_class(type.id()) != H5T_STRING) impl_->fail(what + " does not hold strings");
  std::vector<std::string> values;
  if (H5Tis_variable_str(type.id()) > 0) {
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.id(), H5T_VARIABLE);
    H5Tset_cset(memory.id(), H5Tget_cset(type.id()));
    std::vector<char*> found(static_cast<std::size_t>(count), nullptr);
    if (count > 0 && H5Aread(a.id(), memory.id(), found.data()) < 0) impl_->fail(what + " can't be read: " + reason());
    for (const char* one : found) values.emplace_back(one ? one : "");
    if (count > 0) H5Dvlen_reclaim(memory.id(), space.id(), H5P_DEFAULT, found.data());
    return values;
  }
  const std::size_t length = H5Tget_size(type.id());
  std::vector<char> found(length * static_cast<std::size_t>(count));
  if (count > 0 && H5Aread(a.id(), type.id(), found.data()) < 0) impl_->fail(what + " can't be read: " + reason());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const char* const one = found.data() + i * length;
    std::size_t n = 0;
    while (n < length && one[n]) ++n;
    while (H5Tget_strpad(type.id()) == H5T_STR_SPACEPAD && n > 0 && one[n - 1] == ' ') --n;
    values.emplace_back(one, n);
  }
  return values;
}

struct Image::Impl {
  Handle file{H5I_INVALID_HID, H5Fclose};

  template <class T>
  void add(const std::string& name, const std::vector<std::size_t>& shape, const T* values) const {
    const std::vector<hsize_t> dims = sizes(shape);
    const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose);
    const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    // All alike wherever and whenever it is written.
    H5Pset_obj_track_times(how.id(), 0);
    if (std::all_of(dims.begin(), dims.end(), [](hsize_t n) { return n > 0; })) {
      std::vector<hsize_t> chunk = dims;
      // Chunks fit in the cache that HDF5 has for each dataset, 1 MiB.
      constexpr hsize_t kMaxBytes = 1 << 18;
      hsize_t row = sizeof(T);
      for (std::size_t d = 1; d < chunk.size(); ++d) row *= chunk[d];
      chunk[0] = std::clamp<hsize_t>(kMaxBytes / row, 1, chunk[0]);
      H5Pset_chunk(how.id(), static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(how.id());
      H5Pset_deflate(how.id(), 1);
    }
    const Handle set(
        H5Dcreate2(file.id(), name.c_str(), fileType(typeOf(values)), space.id(), H5P_DEFAULT, how.id(), H5P_DEFAULT),
        H5Dclose);
    if (!set.good() || H5Dwrite(set.id(), memoryType(values), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
      failToMake("dataset '" + name + "'");
    }
  }
};

Image::Image() : impl_(std::make_unique<Impl>()) {
  beQuiet();
  const Handle access = inMemory();
  // (The image of a file of the newer superblock has a wrong checksum in HDF5 1.10.)
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V110);
  const Handle how(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(how.id(), 0);
  impl_->file = Handle(H5Fcreate(imageName().c_str(), H5F_ACC_TRUNC, how.id(), access.id()), H5Fclose);
  if (!impl_->file.good()) failToMake("a file");
}

Image::~Image() = default;

void Image::add(const std::string& name, const std::vector<std::size_t>& shape, const std::int8_t* values) {
  impl_->add(name, shape, values);
}
void Image::add(const std::string& name, const std::vector<std::size_t>& shape, const std::int32_t* values) {
  impl_->add(name, shape, values);
}
void Image::add(const std::string& name, const std::vector<std::size_t>& shape, const std::int64_t* values) {
  impl_->add(name, shape, values);
}
void Image::add(const std::string& name, const std::vector<std::size_t>& shape, const double* values) {
  impl_->add(name, shape, values);
}

void Image::addVirtual(const std::string& name, Type type, const std::vector<std::size_t>& shape, double fill,
                       const std::vector<Source>& sources) {
  const std::vector<hsize_t> dims = sizes(shape);
  const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose);
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(how.id(), 0);
  if (H5Pset_fill_value(how.id(), H5T_NATIVE_DOUBLE, &fill) < 0) failToMake("the fill value of '" + name + "'");
  for (const Source& source : sources) {
    const bool flat = dims.size() == 1;
    const hsize_t start[2] = {flat ? source.begin : source.row, source.begin};
    const hsize_t size[2] = {flat ? source.count : 1, source.count};
    const hsize_t count = source.count;
    const Handle from(H5Screate_simple(1, &count, nullptr), H5Sclose);
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, size, nullptr) < 0 ||
        H5Pset_virtual(how.id(), space.id(), source.path.c_str(), name.c_str(), from.id()) < 0) {
      failToMake("the part '" + source.path + "' of '" + name + "'");
    }
  }
  H5Sselect_all(space.id());
  const Handle set(
      H5Dcreate2(impl_->file.id(), name.c_str(), fileType(type), space.id(), H5P_DEFAULT, how.id(), H5P_DEFAULT),
      H5Dclose);
  if (!set.good()) failToMake("the virtual dataset '" + name + "'");
}

void Image::attribute(const std::string& dataset, const std::string& name, const std::vector<std::string>& values) {
  std::size_t length = 1;
  for (const std::string& value : values) length = std::max(length, value.size());
  std::string padded;
  for (const std::string& value : values) padded += value + std::string(length - value.size(), '\0');
  const Handle object(H5Oopen(impl_->file.id(), dataset.empty() ? "/" : dataset.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), length);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const hsize_t count = values.size();
  const Handle space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle a(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!a.good() || (count > 0 && H5Awrite(a.id(), type.id(), padded.data()) < 0))
    failToMake("attribute '" + name + "'");
}

void Image::attribute(const std::string& dataset, const std::string& name, const std::string& value) {
  attribute(dataset, name, std::vector<std::string>{value});
}

std::string Image::bytes() {
  if (H5Fflush(impl_->file.id(), H5F_SCOPE_GLOBAL) < 0) failToMake("a file");
  const ssize_t size = H5Fget_file_image(impl_->file.id(), nullptr, 0);
  std::string content(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
  if (size <= 0 || H5Fget_file_image(impl_->file.id(), content.data(), content.size()) < 0) failToMake("a file");
  impl_->file.reset();
  return content;
}

}  // namespace fcl_artic::hdf5
