// SPDX-License-Identifier: BSD-3-Clause
// The terminal. Whatever the apps print goes through here: results to standard output, everything
// else to standard error.
#pragma once

#include <string>
#include <vector>

#include "base/page.hpp"

namespace sepcal::app {

/// Prints what was asked for, JSON or a help, and makes sure that it arrived: a full disc behind a
/// redirection is an error.
void print(const std::string& result);
void print(const base::Page& page);

/// Prints a result's page for people, unless that is not wanted (manners.hpp); on a terminal its
/// lines are broken at the width, and its verdict has a colour.
void show(const std::string& page);
void show(const base::Page& page);

/// Says something beside the result. Where standard error can't be written there is nobody to tell.
void tell(const base::Page& page);

/// One line that ends a program: "sepcal-mag: what is wrong".
void tell_refusal(const std::string& called, const std::string& what);

/// "note: ...", unless nobody wants to hear.
void tell_notes(const std::vector<std::string>& notes);

/// What --verbose adds.
void tell_more(const base::Page& page);

}  // namespace sepcal::app
