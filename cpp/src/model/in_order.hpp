// SPDX-License-Identifier: BSD-3-Clause
// What the chunks of a pass give, taken in the record's order as they come: the same bits whatever
// thread ends first, and of a long record little piles up.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

namespace sepcal::model {

template <class Part>
class InOrder {
 public:
  /// `take` gets chunk 0's part, chunk 1's, ..., from one thread at a time.
  explicit InOrder(std::function<void(const Part&)> take) : take_(std::move(take)) {}

  /// Each chunk once, from any thread.
  void give(std::size_t chunk, Part part) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(chunk, std::move(part));
    for (auto next = waiting_.find(taken_); next != waiting_.end(); next = waiting_.find(taken_)) {
      take_(next->second);
      waiting_.erase(next);
      ++taken_;
    }
  }

 private:
  std::mutex mutex_;
  std::function<void(const Part&)> take_;
  std::map<std::size_t, Part> waiting_;  // for chunks before them
  std::size_t taken_ = 0;
};

}  // namespace sepcal::model
