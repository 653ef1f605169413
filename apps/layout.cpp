// SPDX-License-Identifier: BSD-3-Clause
#include "layout.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

namespace sepcal::app {
namespace {

constexpr std::size_t narrowest = 20;  // below it nothing is broken

/// Printable characters, of which one may be several bytes of UTF-8.
std::size_t count_columns(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Where the second column of a table's row begins, or the text of a line.
std::size_t hanging_indent(std::string_view line, std::size_t width) {
  const std::size_t text = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", text);
  if (gap == std::string_view::npos) return text + 2;
  const std::size_t second = line.find_first_not_of(' ', gap);
  return second == std::string_view::npos || second > width / 2 ? text + 2 : second;
}

/// A page of what `change` makes of each line.
template <class Change>
std::string by_line(std::string_view page, const Change& change) {
  std::string all;
  while (!page.empty()) {
    const std::size_t end = std::min(page.find('\n'), page.size());
    all += change(page.substr(0, end));
    if (end < page.size()) all += '\n';
    page.remove_prefix(std::min(end + 1, page.size()));
  }
  return all;
}

/// Words that say how a line's matter stands, and the beginnings of lines that have them.
struct Mark {
  std::string_view beginning;
  Colour colour;
  bool whole_line;  // else the word after the beginning
};
constexpr std::array marks{
    Mark{"status: converged", Colour::green, true},
    Mark{"status: ", Colour::red, true},
    Mark{"Nothing is missing", Colour::green, true},
    Mark{"warning: ", Colour::yellow, false},
};

}  // namespace

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string lines;
  std::size_t room = width > indent + narrowest ? width : indent + narrowest;
  std::size_t used = indent;
  bool first = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    const std::size_t columns = count_columns(word);
    if (!first && used + 1 + columns > room) {
      lines += '\n' + std::string(indent, ' ');
      used = indent;
    } else if (!first) {
      lines += ' ';
      ++used;
    }
    lines += word;
    used += columns;
    first = false;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string laid_out(std::string_view page, std::size_t width) {
  if (width < narrowest) return std::string(page);
  return by_line(page, [&](std::string_view line) {
    if (count_columns(line) <= width) return std::string(line);
    const std::size_t indent = hanging_indent(line, width);
    std::size_t at = line.rfind(' ', width);
    if (at == std::string_view::npos || at <= line.find_first_not_of(' '))
      at = line.find(' ', width);
    const std::size_t next = line.find_first_not_of(' ', at);
    if (next == std::string_view::npos) return std::string(line);
    const std::string_view kept = line.substr(0, line.find_last_not_of(' ', at) + 1);
    return fmt::format("{}\n{:{}}{}", kept, "", indent, wrapped(line.substr(next), width, indent));
  });
}

std::string coloured(std::string_view page) {
  return by_line(page, [](std::string_view line) {
    const auto* const mark = std::ranges::find_if(
        marks, [&](const Mark& each) { return line.starts_with(each.beginning); });
    if (mark == marks.end()) return std::string(line);
    const std::size_t size = mark->whole_line ? line.size() : mark->beginning.size();
    return in_colour(mark->colour, line.substr(0, size)) + std::string(line.substr(size));
  });
}

bool takes_colour(int descriptor) {
  const char* const refused = std::getenv("NO_COLOR");
  if (refused != nullptr && *refused != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return false;
  return ::isatty(descriptor) == 1;
}

std::size_t width_of(int descriptor) {
  if (::isatty(descriptor) != 1) return 0;
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::string in_colour(Colour colour, std::string_view text) {
  constexpr std::array codes{"31", "32", "33", "1"};
  return fmt::format("\x1b[{}m{}\x1b[0m", codes[static_cast<std::size_t>(colour)], text);
}

}  // namespace sepcal::app
