// SPDX-License-Identifier: BSD-3-Clause
// An option as the user of this process types it: `drop_invalid` in code, `--drop-invalid` on a
// command line. Messages that offer an option as the way out ask here.
#pragma once

#include <string>
#include <string_view>

namespace sepcal::files {

/// From now on as on a command line; an app calls it before anything else.
void spell_options_for_command_line();

/// `name` as in code: "drop_invalid".
std::string spell_option(std::string_view name);

}  // namespace sepcal::files
