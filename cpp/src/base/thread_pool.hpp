// SPDX-License-Identifier: BSD-3-Clause
// A pool of threads that lives as long as a fit: numbered tasks, handed out in order, whose results
// never depend on which thread ran them. Threads start at the first call that can use them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "base/stop.hpp"

namespace sepcal::base {

constexpr int most_threads = 1024;

class ThreadPool {
 public:
  /// `threads` of them, the caller's included; 0: as many as the machine has cores. Fewer work
  /// where the system starts no more.
  explicit ThreadPool(int threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool();

  /// The caller's included.
  int threads() const { return threads_; }

  /// Runs task(0) ... task(count - 1) and returns when all are done. The first exception of a task
  /// is thrown again here; the tasks not yet begun are then skipped. So they are where the caller's
  /// work is to stop: before each task that is asked (base/stop.hpp), and while the last run.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task);

 private:
  void start_workers();
  void work();
  void run_tasks(std::unique_lock<std::mutex>& lock);
  void wait_for_the_last(std::unique_lock<std::mutex>& lock);
  void keep(const std::exception_ptr& failure);

  int threads_;
  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  Stop* stop_ = nullptr;  // what the caller heeds
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t running_ = 0;
  bool stopping_ = false;
  std::exception_ptr failure_;
};

}  // namespace sepcal::base
