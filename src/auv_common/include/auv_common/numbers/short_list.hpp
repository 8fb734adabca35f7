#pragma once

#include <cassert>
#include <memory>
#include <new>
#include <type_traits>

namespace stg {

/// Up to N values in the memory of the list itself. A copy copies only the values that the list
/// holds: packets have room for many measurements and mostly carry one or two.
template <class T, int N>
class ShortList {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  ShortList() {}  // NOLINT(modernize-use-equals-default): a union's member has a constructor
  ShortList(const ShortList& other) : size_(other.size_) {
    std::uninitialized_copy(other.begin(), other.end(), items_);
  }
  ShortList& operator=(const ShortList& other) {
    if (this == &other) return *this;
    size_ = other.size_;
    std::uninitialized_copy(other.begin(), other.end(), items_);
    return *this;
  }

  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == N; }

  T& operator[](int k) {
    assert(0 <= k && k < size_);
    return items_[k];
  }
  const T& operator[](int k) const {
    assert(0 <= k && k < size_);
    return items_[k];
  }
  T* begin() { return items_; }
  T* end() { return items_ + size_; }
  const T* begin() const { return items_; }
  const T* end() const { return items_ + size_; }

  void clear() { size_ = 0; }
  /// Appends a value and returns it. The list must not be full.
  T& push_back(const T& value) {
    assert(!full());
    return *::new (items_ + size_++) T(value);
  }
  /// Removes the last value. The list must not be empty.
  void pop_back() {
    assert(!empty());
    --size_;
  }
  /// Puts a value before the k-th one. A full list loses its last value.
  void insert(int k, const T& value) {
    assert(0 <= k && k <= size_ && k < N);
    if (full()) --size_;
    push_back(value);
    for (int j = size_ - 1; j > k; --j) items_[j] = items_[j - 1];
    items_[k] = value;
  }

 private:
  int size_ = 0;
  union {
    T items_[N];  // only the first size_ exist
  };
};

}  // namespace stg
