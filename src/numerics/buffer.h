// SPDX-License-Identifier: BSD-3-Clause
//
// A growing array for the engine. Not std::vector: its inline code, compiled for a wide instruction set, could be
// picked by the linker for the whole program.
#pragma once

#include <cstdlib>

#include "numerics/assertion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Keeps its memory until it dies, so that queries allocate nothing after the first ones. T is plain data.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { std::free(data_); }

  int size() const { return size_; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](int i) {
    FCL_ARTIC_ASSERT(i >= 0 && i < size_);
    return data_[i];
  }
  const T& operator[](int i) const {
    FCL_ARTIC_ASSERT(i >= 0 && i < size_);
    return data_[i];
  }
  void clear() { size_ = 0; }
  void truncate(int size) {
    FCL_ARTIC_ASSERT(size >= 0 && size <= size_);
    size_ = size;
  }
  /// @param value  may be an entry of this buffer.
  void push(const T& value) {
    const T copy = value;
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    data_[size_++] = copy;
  }
  T& grow() {
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    return data_[size_++];
  }
  /// Makes room for `size` entries; new memory is zero.
  void resize(int size) {
    if (size > capacity_) reserve(size);
    size_ = size;
  }

 private:
  void reserve(int capacity) {
    const std::size_t bytes = (static_cast<std::size_t>(capacity) * sizeof(T) + 63) / 64 * 64;
    T* data = static_cast<T*>(std::aligned_alloc(64, bytes));
    if (!data) std::abort();  // nothing true can be answered without memory
    if (size_ > 0) __builtin_memcpy(data, data_, static_cast<std::size_t>(size_) * sizeof(T));
    __builtin_memset(reinterpret_cast<char*>(data) + static_cast<std::size_t>(size_) * sizeof(T), 0,
                     bytes - static_cast<std::size_t>(size_) * sizeof(T));
    std::free(data_);
    data_ = data;
    capacity_ = capacity;
  }
  T* data_ = nullptr;
  int size_ = 0, capacity_ = 0;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
