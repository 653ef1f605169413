// SPDX-License-Identifier: BSD-3-Clause
// Pages on a terminal: lines that are too wide are broken, and what matters has a colour. Elsewhere
// a page stays as it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sepcal::app {

/// Text broken at blanks, no line wider than `width` where a blank allows it; all lines but the
/// first are indented so far.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

/// A page whose lines are at most so wide: what is over goes on below, under the sentence's
/// beginning or a table's second column.
std::string laid_out(std::string_view page, std::size_t width);

/// With the words of a status or a verdict in green, yellow or red.
std::string coloured(std::string_view page);

/// Whether a stream is a terminal that shows colours: NO_COLOR is not set, and TERM is not "dumb".
bool takes_colour(int descriptor);

/// The columns of a stream's terminal; 0 where it is none.
std::size_t width_of(int descriptor);

enum class Colour { red, green, yellow, bold };
std::string in_colour(Colour colour, std::string_view text);

}  // namespace sepcal::app
