// SPDX-License-Identifier: BSD-3-Clause
// Doubles that registers of any width load and store.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace sepcal::base {

template <class T>
struct WidestAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): as containers call it
  static constexpr std::align_val_t alignment{64};

  WidestAllocator() = default;
  template <class U>
  WidestAllocator(const WidestAllocator<U>& /*other*/) {}  // NOLINT: as containers ask for it

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), alignment));
  }
  void deallocate(T* values, std::size_t /*count*/) noexcept {
    ::operator delete(values, alignment);
  }
  friend bool operator==(const WidestAllocator&, const WidestAllocator&) { return true; }
};

using AlignedDoubles = std::vector<double, WidestAllocator<double>>;

}  // namespace sepcal::base
