// SPDX-License-Identifier: BSD-3-Clause
// Numbered tasks on a pool of threads.
#include "base/thread_pool.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace thread_pool_test {

using sepcal::base::ThreadPool;

TEST_CASE("every task runs exactly once, whatever the number of threads and tasks") {
  for (const int threads : {0, 1, 2, 5}) {
    ThreadPool pool(threads);
    for (const std::size_t count : {0U, 1U, 2U, 3U, 100U, 1000U}) {
      std::vector<std::atomic<int>> runs(count);
      pool.for_each(count, [&](std::size_t i) { ++runs[i]; });
      for (const auto& times : runs) CHECK(times == 1);
    }
  }
}

TEST_CASE("a task's exception comes out, tasks not begun are skipped, and the pool works on") {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 20; ++round) {
      std::atomic<int> begun = 0;
      // The others take their time: whichever thread has the fifth may lose its core for a while.
      const auto fail_at_the_fifth = [&](std::size_t i) {
        ++begun;
        if (i == 4) throw std::runtime_error("task 4");
        if (i > 4) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      };
      CHECK_THROWS_WITH_AS(pool.for_each(100'000, fail_at_the_fifth), "task 4", std::runtime_error);
      CHECK(begun < 100'000);
      std::atomic<int> sum = 0;
      pool.for_each(10, [&](std::size_t i) { sum += static_cast<int>(i); });
      CHECK(sum == 45);
    }
  }
}

TEST_CASE("what one call wrote is seen by the next") {
  ThreadPool pool(3);
  std::vector<int> values(500, 0);
  for (int round = 1; round <= 50; ++round) {
    pool.for_each(values.size(), [&](std::size_t i) { values[i] += round; });
  }
  CHECK(std::accumulate(values.begin(), values.end(), 0) == 500 * 50 * 51 / 2);
}

TEST_CASE("a pool that was never asked for anything ends quietly") { const ThreadPool pool(4); }

}  // namespace thread_pool_test
