// SPDX-License-Identifier: BSD-3-Clause
// The terminal. Whatever the apps print goes through here: results to standard output, everything
// else to standard error.
#pragma once

#include <string>
#include <vector>

#include "base/page.hpp"

namespace sepcal::app {

/// Prints a result, JSON or a page, and makes sure that it arrived: a full disc behind a
/// redirection is an error.
void print(const std::string& result);
void print(const base::Page& page);

/// Says something beside the result. Where standard error can't be written there is nobody to tell.
void tell(const base::Page& page);
void tell_notes(const std::vector<std::string>& notes);

}  // namespace sepcal::app
