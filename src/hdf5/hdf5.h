// SPDX-License-Identifier: BSD-3-Clause
//
// Tables of numbers in HDF5 files, as NumPy, MATLAB and Julia read them: datasets by name whose rows are the first
// dimension, names of columns as attributes. Files are written by way of memory: HDF5 itself never writes to a disk, so
// that a full one is an error of files::write() and never half a file. All calls must come from one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fcl_artic::hdf5 {

// In a build without HDF5 every call throws std::runtime_error that says so.

/// Types of numbers that are written.
enum class Type { int8, int32, int64, float64 };

/// A file that is read.
class File {
 public:
  /// @throws std::runtime_error naming the file: not there, not HDF5, damaged.
  explicit File(const std::string& path);
  /// The same of bytes in memory. @param name  for messages.
  File(const std::string& bytes, const std::string& name);
  ~File();
  File(File&&) noexcept;
  File& operator=(File&&) noexcept;

  const std::string& path() const;
  /// Names of the file's datasets, those of groups left out, in alphabetical order.
  std::vector<std::string> datasets() const;
  bool has(const std::string& dataset) const;
  /// @throws std::runtime_error naming file and dataset, as all functions below; with a name that was probably meant.
  std::vector<std::size_t> shape(const std::string& dataset) const;
  /// Rows [begin, begin + count) of a dataset of any kind of number, by rows. @param columns  of each row, multiplied.
  void read(const std::string& dataset, std::size_t begin, std::size_t count, std::vector<double>& values) const;
  /// The same of whole numbers; a dataset of other numbers is refused.
  void read(const std::string& dataset, std::size_t begin, std::size_t count, std::vector<std::int64_t>& values) const;
  /// An attribute of strings of a dataset, or, with an empty name, of the file; empty where there is none.
  std::vector<std::string> strings(const std::string& dataset, const std::string& attribute) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A part of a virtual dataset: a one-dimensional dataset of another file stands for [begin, begin + count) of its row.
struct Source {
  std::string path;     ///< relative to the folder of the file that has the virtual dataset
  std::size_t row = 0;  ///< where the virtual dataset has two dimensions
  std::size_t begin = 0, count = 0;
};

/// A file that is written, in memory until bytes() is asked for.
class Image {
 public:
  Image();
  ~Image();
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  /// Adds a dataset, compressed. @param shape  its dimensions. @param values  their product of them, by rows.
  void add(const std::string& name, const std::vector<std::size_t>& shape, const std::int8_t* values);
  void add(const std::string& name, const std::vector<std::size_t>& shape, const std::int32_t* values);
  void add(const std::string& name, const std::vector<std::size_t>& shape, const std::int64_t* values);
  void add(const std::string& name, const std::vector<std::size_t>& shape, const double* values);
  /// Adds a dataset of one or two dimensions that other files hold under the same name.
  /// @param fill  its value where no file has one, or the file is gone.
  void addVirtual(const std::string& name, Type type, const std::vector<std::size_t>& shape, double fill,
                  const std::vector<Source>& sources);
  /// Adds an attribute to a dataset or, with an empty name, to the file.
  void attribute(const std::string& dataset, const std::string& name, const std::vector<std::string>& values);
  void attribute(const std::string& dataset, const std::string& name, const std::string& value);

  /// The file's bytes. Nothing can be added afterwards.
  std::string bytes();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic::hdf5
