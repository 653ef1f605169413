// SPDX-License-Identifier: BSD-3-Clause
// Names, messages and file names as they leave sepcal: a function for each language that they
// enter. JSON is escaped by its library, HTML by the report.
#pragma once

#include <string>
#include <string_view>

namespace sepcal::base {

/// For a terminal, a page of text or a comment that ends with its line: one line of printable
/// UTF-8. What ends a line, steers a terminal or turns the direction of writing, and bytes that are
/// no UTF-8, are written as \n, \r, \t or \x1b. A line stays as it is.
std::string in_line(std::string_view text);

/// For a comment between /* and */: a line that neither ends nor opens a comment, nor goes on in
/// the next line, under trigraphs either.
std::string in_c_comment(std::string_view text);

/// For a POSIX shell: one word, quoted where it needs quotes.
std::string in_shell(std::string_view text);

/// The same for the name of a file, so that one that begins with - is not taken for an option.
std::string file_in_shell(std::string_view name);

/// An option's name in code as a command line has it: "--drop-invalid" of drop_invalid.
std::string as_typed(const std::string& name);

}  // namespace sepcal::base
