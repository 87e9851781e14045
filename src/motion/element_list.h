// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace fcl_artic {

/// A vector that needs no memory of its own for up to N elements: a query of two free bodies then allocates none for
/// their motions.
template <class T, std::size_t N>
class ElementList {
  static_assert(std::is_trivially_destructible<T>::value, "those in place are left behind, not destroyed");

 public:
  ElementList() = default;
  ElementList(std::initializer_list<T> elements) { append(elements.begin(), elements.size()); }
  ElementList(const ElementList& other) { append(other.begin(), other.size()); }
  ElementList& operator=(const ElementList& other) {
    if (this != &other) {
      clear();
      append(other.begin(), other.size());
    }
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* begin() { return size_ <= N ? inPlace() : many_.data(); }
  T* end() { return begin() + size_; }
  const T* begin() const { return const_cast<ElementList*>(this)->begin(); }
  const T* end() const { return begin() + size_; }
  auto rbegin() const { return std::make_reverse_iterator(end()); }
  auto rend() const { return std::make_reverse_iterator(begin()); }
  T& operator[](std::size_t i) { return begin()[i]; }
  const T& operator[](std::size_t i) const { return begin()[i]; }
  const T& at(std::size_t i) const {
    if (i >= size_) throw std::out_of_range("ElementList::at");
    return begin()[i];
  }
  T& front() { return *begin(); }

  void clear() {
    many_.clear();
    size_ = 0;
  }
  /// Elements stay where they are until there are more than N.
  T& emplace_back() {
    if (size_ < N) return *new (inPlace() + size_++) T();
    if (size_ == N) many_.assign(inPlace(), inPlace() + N);
    many_.emplace_back();
    ++size_;
    return many_.back();
  }
  void push_back(const T& element) { append(&element, 1); }
  void resize(std::size_t n) {
    if (n < size_) {
      ElementList kept;
      kept.append(begin(), n);
      *this = kept;
    }
    while (size_ < n) emplace_back();
  }

 private:
  T* inPlace() { return reinterpret_cast<T*>(few_); }
  /// @param first  not one of this list's own.
  void append(const T* first, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      if (size_ < N) {
        new (inPlace() + size_++) T(first[i]);
      } else {
        emplace_back() = first[i];
      }
    }
  }

  alignas(T) unsigned char few_[N * sizeof(T)];
  std::vector<T> many_;  ///< all of them, once there are more than N
  std::size_t size_ = 0;
};

}  // namespace fcl_artic
