// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C: the work ends at its next piece, within a second, and files that it would have written
// aren't there.
#pragma once

#include <csignal>
#include <optional>
#include <string>

#include "sepcal/stop.hpp"

namespace sepcal::app {

/// The exit code of what Ctrl-C ended, as shells have it.
inline constexpr int interrupted = 130;

/// A signal is taken in another way while it lives.
class SignalScope {
 public:
  SignalScope(int signal, void (*handler)(int), unsigned flags = 0);
  SignalScope(const SignalScope&) = delete;
  SignalScope& operator=(const SignalScope&) = delete;
  ~SignalScope();

 private:
  int signal_;
  struct sigaction before_ = {};
};

/// While it lives, Ctrl-C throws Stopped out of the work. Where that takes more than a second, as a
/// read from a pipe may, the process ends there and then; a second Ctrl-C ends it at once. A
/// process that was told to ignore Ctrl-C (nohup) goes on doing so.
class InterruptScope {
 public:
  explicit InterruptScope(const std::string& called);
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
  ~InterruptScope();

 private:
  std::optional<SignalScope> alarm_;
  std::optional<SignalScope> interrupt_;
  StopScope stop_;
};

}  // namespace sepcal::app
