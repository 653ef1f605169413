// SPDX-License-Identifier: BSD-3-Clause
#include "base/thread_pool.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

namespace sepcal::base {
namespace {

template <class Work>
std::exception_ptr failure_of(const Work& work) {
  try {
    work();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

ThreadPool::ThreadPool(int threads)
    : threads_(threads > 0 ? threads
                           : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::for_each(std::size_t count, const std::function<void(std::size_t)>& task) {
  if (count <= 1 || threads_ == 1) {
    for (std::size_t i = 0; i < count; ++i) {
      heed_stop();
      task(i);
    }
    return;
  }
  start_workers();
  std::unique_lock lock(mutex_);
  task_ = &task;
  stop_ = heeded_stop();
  next_ = 0;
  count_ = count;
  wake_.notify_all();
  run_tasks(lock);
  wait_for_the_last(lock);
  task_ = nullptr;
  if (!failure_) return;
  const std::exception_ptr failure = std::exchange(failure_, nullptr);
  heed_stop();  // where it is the reason, the asker's own exception and not a worker's
  std::rethrow_exception(failure);
}

void ThreadPool::wait_for_the_last(std::unique_lock<std::mutex>& lock) {
  while (!done_.wait_for(lock, between_asking, [this] { return running_ == 0; })) {
    lock.unlock();
    const std::exception_ptr failure = failure_of(heed_stop);
    lock.lock();
    keep(failure);
  }
}

void ThreadPool::keep(const std::exception_ptr& failure) {
  if (!failure || failure_) return;
  failure_ = failure;
  next_ = count_;
}

void ThreadPool::start_workers() {
  try {
    while (static_cast<int>(workers_.size()) + 1 < threads_) {
      workers_.emplace_back([this] { work(); });
    }
  } catch (const std::system_error&) {
    return;  // no more of them here and now: those that run do it all
  }
}

void ThreadPool::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || next_ < count_; });
    if (stopping_) return;
    run_tasks(lock);
  }
}

void ThreadPool::run_tasks(std::unique_lock<std::mutex>& lock) {
  const HeedStop heeding(stop_);
  while (next_ < count_) {
    const std::size_t mine = next_++;
    const auto* task = task_;
    ++running_;
    lock.unlock();
    const std::exception_ptr failure = failure_of([&] {
      heed_stop();
      (*task)(mine);
    });
    lock.lock();
    --running_;
    keep(failure);
  }
  if (running_ == 0) done_.notify_all();
}

}  // namespace sepcal::base
