// SPDX-License-Identifier: BSD-3-Clause
#include "interrupt.hpp"

#include <unistd.h>

#include <atomic>

namespace sepcal::app {
namespace {

constexpr unsigned patience = 1;  // s

std::atomic<bool> was_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal's handler may take no lock");
std::string last_words;  // made before any handler needs them

void end_here(int /*signal*/) {
  [[maybe_unused]] const auto said = ::write(STDERR_FILENO, last_words.data(), last_words.size());
  ::_exit(interrupted);
}

void interrupt(int /*signal*/) {
  was_interrupted = true;
  ::alarm(patience);
}

void throw_where_interrupted() {
  if (was_interrupted) throw Stopped();
}

bool is_ignored(int signal) {
  struct sigaction now{};
  ::sigaction(signal, nullptr, &now);
  return now.sa_handler == SIG_IGN;
}

}  // namespace

SignalScope::SignalScope(int signal, void (*handler)(int), unsigned flags) : signal_(signal) {
  struct sigaction action{};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(flags);
  ::sigaction(signal, &action, &before_);
}

SignalScope::~SignalScope() { ::sigaction(signal_, &before_, nullptr); }

InterruptScope::InterruptScope(const std::string& called) : stop_(&throw_where_interrupted) {
  was_interrupted = false;
  if (is_ignored(SIGINT)) return;
  last_words = called + ": stopped by Ctrl-C\n";
  alarm_.emplace(SIGALRM, &end_here);
  interrupt_.emplace(SIGINT, &interrupt, unsigned{SA_RESTART} | SA_RESETHAND);
}

InterruptScope::~InterruptScope() { ::alarm(0); }

}  // namespace sepcal::app
