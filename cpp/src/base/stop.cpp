// SPDX-License-Identifier: BSD-3-Clause
#include "base/stop.hpp"

#include <atomic>
#include <thread>
#include <utility>

namespace sepcal {

/// Shared by the thread that asks and those that work for it.
struct base::Stop {
  using Clock = std::chrono::steady_clock;

  explicit Stop(std::function<void()> ask_first) : ask(std::move(ask_first)) {}

  /// On the thread that asks.
  void ask_when_due() {
    if (!asked) {
      if (Clock::now() < due) return;
      try {
        ask();
      } catch (...) {
        reason = std::current_exception();
        asked = true;
      }
      due = Clock::now() + between_asking;
    }
    if (asked) std::rethrow_exception(reason);
  }

  std::function<void()> ask;
  std::thread::id asker = std::this_thread::get_id();
  Clock::time_point due = Clock::now() + between_asking;
  std::exception_ptr reason;
  std::atomic<bool> asked = false;
};

namespace {

thread_local base::Stop* heeded = nullptr;

}  // namespace

base::Stop* base::heeded_stop() { return heeded; }

void base::heed_stop() {
  if (heeded == nullptr) return;
  if (heeded->asker == std::this_thread::get_id()) return heeded->ask_when_due();
  if (heeded->asked) throw Stopped();
}

base::HeedStop::HeedStop(Stop* stop) : before_(std::exchange(heeded, stop)) {}

base::HeedStop::~HeedStop() { heeded = before_; }

StopScope::StopScope(std::stop_token token)
    : StopScope([token = std::move(token)] {
        if (token.stop_requested()) throw Stopped();
      }) {}

StopScope::StopScope(std::function<void()> ask)
    : stop_(std::make_unique<base::Stop>(std::move(ask))),
      outer_(std::exchange(heeded, stop_.get())) {}

StopScope::~StopScope() { heeded = outer_; }

}  // namespace sepcal
