// SPDX-License-Identifier: BSD-3-Clause
// Work that is asked to stop, by a token or by whatever the asking throws.
#include "base/stop.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/fit.hpp"

namespace stop_test {

using sepcal::Stopped;
using sepcal::StopScope;
using sepcal::base::heed_stop;
using sepcal::base::ThreadPool;

namespace {

/// Works until it is stopped; gives up after a minute, which no test waits for.
void work_on() {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::minutes(1); Clock::now() < end;) {
    heed_stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

std::stop_token requested() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

void refuse() { throw std::runtime_error("asked"); }

}  // namespace

TEST_CASE("nothing is asked outside a scope, and after it") {
  heed_stop();
  {
    const StopScope scope(requested());
    CHECK_THROWS_AS(work_on(), Stopped);
    CHECK_THROWS_AS(heed_stop(), Stopped);  // once stopped, stopped
  }
  heed_stop();
}

TEST_CASE("a token that is not asked for lets work go on") {
  const std::stop_source source;
  const StopScope scope(source.get_token());
  ThreadPool pool(2);
  std::atomic<int> done = 0;
  pool.for_each(20, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ++done;
  });
  CHECK(done == 20);
}

TEST_CASE("tasks that are not begun are left, and what the asking threw comes out") {
  for (const int threads : {1, 3}) {
    const StopScope scope(&refuse);
    ThreadPool pool(threads);
    std::atomic<int> begun = 0;
    const auto take_a_while = [&](std::size_t) {
      ++begun;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    };
    CHECK_THROWS_WITH_AS(pool.for_each(100'000, take_a_while), "asked", std::runtime_error);
    CHECK(begun < 1000);
  }
}

TEST_CASE("the caller asks on its own thread while others have the last tasks") {
  std::atomic<bool> elsewhere = false;
  const auto caller = std::this_thread::get_id();
  const StopScope scope([&] {
    if (std::this_thread::get_id() != caller) elsewhere = true;
    throw std::runtime_error("asked");
  });
  ThreadPool pool(2);
  const auto work_elsewhere = [&](std::size_t) {
    if (std::this_thread::get_id() != caller) return work_on();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the other takes one meanwhile
  };
  CHECK_THROWS_WITH_AS(pool.for_each(2, work_elsewhere), "asked", std::runtime_error);
  CHECK(!elsewhere);
}

TEST_CASE("a scope within another is heeded in its place") {
  const StopScope outer(requested());
  {
    const std::stop_source never;
    const StopScope inner(never.get_token());
    std::this_thread::sleep_for(2 * sepcal::base::between_asking);
    heed_stop();
  }
  CHECK_THROWS_AS(work_on(), Stopped);
}

TEST_CASE("a fit is stopped on any number of threads") {
  sepcal::Record record;
  std::vector<double> u(2000);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 1e-3 * static_cast<double>(i);
  record.add("eta", u).add("z", u);
  for (const int threads : {1, 2}) {
    const StopScope scope(requested());
    CHECK_THROWS_AS(
        sepcal::fit(sepcal::ScalarExample1{}, record, {.samples = 500'000, .threads = threads}),
        Stopped);
  }
}

}  // namespace stop_test
