// SPDX-License-Identifier: BSD-3-Clause
// Pages for people. A page is made of literals and of what page() formats, and page() writes every
// string that it is given in one line: no name, message or file name forges a line or steers a
// terminal. A std::string is no page, so that none gets there by another way.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/escaping.hpp"

namespace sepcal::base {

class Page {
 public:
  Page() = default;
  template <std::size_t size>
  Page(const char (&literal)[size]) : text_(literal) {}  // NOLINT(google-explicit-constructor)

  Page& operator+=(const Page& other) {
    text_ += other.text_;
    return *this;
  }
  friend Page operator+(Page left, const Page& right) { return left += right; }

  bool empty() const { return text_.empty(); }
  const std::string& text() const { return text_; }

  /// Without blanks at its end.
  Page trimmed() const {
    Page page;
    page.text_ = text_.substr(0, text_.find_last_not_of(' ') + 1);
    return page;
  }

 private:
  template <class... Arguments>
  friend Page format_page(fmt::string_view format, const Arguments&... arguments);

  std::string text_;
};

/// A string in one line; a page, a number or a character as it is.
template <class Value>
decltype(auto) shown(const Value& value) {
  if constexpr (std::same_as<Value, Page>) {
    return (value.text());
  } else if constexpr (std::convertible_to<const Value&, std::string_view>) {
    return in_line(value);
  } else {
    static_assert(std::is_arithmetic_v<Value>, "a page shows strings, numbers and pages");
    return (value);
  }
}

template <class Value>
using Shown = std::remove_cvref_t<decltype(shown(std::declval<const Value&>()))>;

template <class... Arguments>
Page format_page(fmt::string_view format, const Arguments&... arguments) {
  Page page;
  page.text_ = fmt::vformat(format, fmt::make_format_args(arguments...));
  return page;
}

/// As fmt::format.
template <class... Values>
Page page(fmt::format_string<Shown<Values>...> format, const Values&... values) {
  return format_page(format, shown(values)...);
}

/// Names in a line, a piece of text between each and the next.
template <std::size_t size>
Page joined(const std::vector<std::string>& names, const char (&between)[size]) {
  Page all;
  for (const std::string& name : names) {
    if (!all.empty()) all += between;
    all += page("{}", name);
  }
  return all;
}

}  // namespace sepcal::base
