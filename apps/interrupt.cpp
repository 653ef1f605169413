// SPDX-License-Identifier: BSD-3-Clause
#include "interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>

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

void handle(int signal, void (*handler)(int), unsigned flags) {
  struct sigaction action{};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(flags);
  ::sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction now{};
  ::sigaction(signal, nullptr, &now);
  return now.sa_handler == SIG_IGN;
}

}  // namespace

StopScope heed_interrupts(const std::string& app) {
  last_words = app + ": stopped by Ctrl-C\n";
  if (!is_ignored(SIGINT)) {
    handle(SIGALRM, &end_here, 0);
    handle(SIGINT, &interrupt, unsigned{SA_RESTART} | SA_RESETHAND);
  }
  return StopScope([] {
    if (was_interrupted) throw Stopped();
  });
}

}  // namespace sepcal::app
