// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/option_spelling.hpp"

#include <algorithm>
#include <atomic>

namespace sepcal::files {
namespace {

std::atomic<bool> for_command_line = false;

}  // namespace

void spell_options_for_command_line() { for_command_line = true; }

std::string spell_option(std::string_view name) {
  if (!for_command_line) return std::string(name);
  std::string option = "--" + std::string(name);
  std::ranges::replace(option, '_', '-');
  return option;
}

}  // namespace sepcal::files
