// SPDX-License-Identifier: BSD-3-Clause
// What a compiler sees of a header of C or C++: trigraphs, lines that go on, comments and tokens by
// ISO C99 5.1.1.2 and 6.4.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzzing.hpp"

namespace sepcal::fuzz {

inline bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

class CTokens {
 public:
  explicit CTokens(std::string_view source) : rest_(spliced(source)) {
    while (at_ < rest_.size()) read();
  }

  /// "\n#" begins a directive and "\n" ends it; strings stand whole, other marks one by one.
  const std::vector<std::string>& list() const { return tokens_; }

 private:
  /// Phases 1 and 2. gcc lets blanks stand between the backslash and the end of the line.
  static std::string spliced(std::string_view source) {
    constexpr std::array<std::pair<char, char>, 9> trigraphs{{{'=', '#'},
                                                              {'/', '\\'},
                                                              {'\'', '^'},
                                                              {'(', '['},
                                                              {')', ']'},
                                                              {'!', '|'},
                                                              {'<', '{'},
                                                              {'>', '}'},
                                                              {'-', '~'}}};
    std::string one;
    for (std::size_t at = 0; at < source.size(); ++at) {
      const auto* const found =
          source.substr(at).starts_with("\?\?") && at + 2 < source.size()
              ? std::ranges::find(trigraphs, source[at + 2], [](const auto& t) { return t.first; })
              : trigraphs.end();
      if (found != trigraphs.end()) {
        one += found->second;
        at += 2;
      } else {
        one += source[at] == '\r' ? '\n' : source[at];
      }
    }
    std::string two;
    for (std::size_t at = 0; at < one.size(); ++at) {
      const std::size_t end = one.find_first_not_of(" \t\v\f", at + 1);
      if (one[at] == '\\' && end != std::string::npos && one[end] == '\n') {
        at = end;
      } else {
        two += one[at];
      }
    }
    return two;
  }

  bool starts(std::string_view text) const {
    return std::string_view(rest_).substr(at_).starts_with(text);
  }

  void read() {
    const char c = rest_[at_];
    if (starts("/*")) {
      const std::size_t end = rest_.find("*/", at_ + 2);
      require(end != std::string::npos, "a comment ends");
      require(std::string_view(rest_).substr(at_ + 2, end - at_ - 2).find("/*") ==
                  std::string_view::npos,
              "no comment opens within another");
      at_ = end + 2;
    } else if (starts("//")) {
      at_ = std::min(rest_.find('\n', at_), rest_.size());
    } else if (c == '\n') {
      if (std::exchange(in_directive_, false)) tokens_.emplace_back("\n");
      at_line_start_ = true;
      ++at_;
    } else if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
      ++at_;
    } else {
      read_token(c);
      at_line_start_ = false;
    }
  }

  void read_token(char c) {
    std::size_t end = at_ + 1;
    if (c == '"' || c == '\'') {
      while (end < rest_.size() && rest_[end] != c && rest_[end] != '\n') {
        end += rest_[end] == '\\' ? 2 : 1;
      }
      require(end < rest_.size() && rest_[end] == c, "a string ends on its line");
      ++end;
    } else if (is_letter(c) || is_digit(c) ||
               (c == '.' && end < rest_.size() && is_digit(rest_[end]))) {
      const bool is_number = !is_letter(c);
      const auto goes_on = [&](std::size_t at) {
        const char next = rest_[at];
        const bool is_sign = (next == '+' || next == '-') && is_number &&
                             (rest_[at - 1] == 'e' || rest_[at - 1] == 'E');
        return is_letter(next) || is_digit(next) || (is_number && next == '.') || is_sign;
      };
      while (end < rest_.size() && goes_on(end)) ++end;
    }
    if (c == '#' && at_line_start_) in_directive_ = true;
    tokens_.push_back((c == '#' && at_line_start_ ? "\n" : "") + rest_.substr(at_, end - at_));
    at_ = end;
  }

  std::string rest_;
  std::size_t at_ = 0;
  bool at_line_start_ = true;
  bool in_directive_ = false;
  std::vector<std::string> tokens_;
};

/// Words of C99 (6.4.1) and C++20 (5.11), which are no names.
inline bool is_keyword(std::string_view word) {
  constexpr auto words = std::to_array<std::string_view>({"alignas",
                                                          "alignof",
                                                          "and",
                                                          "and_eq",
                                                          "asm",
                                                          "auto",
                                                          "bitand",
                                                          "bitor",
                                                          "bool",
                                                          "break",
                                                          "case",
                                                          "catch",
                                                          "char",
                                                          "char16_t",
                                                          "char32_t",
                                                          "char8_t",
                                                          "class",
                                                          "co_await",
                                                          "co_return",
                                                          "co_yield",
                                                          "compl",
                                                          "concept",
                                                          "const",
                                                          "const_cast",
                                                          "consteval",
                                                          "constexpr",
                                                          "constinit",
                                                          "continue",
                                                          "decltype",
                                                          "default",
                                                          "delete",
                                                          "do",
                                                          "double",
                                                          "dynamic_cast",
                                                          "else",
                                                          "enum",
                                                          "explicit",
                                                          "export",
                                                          "extern",
                                                          "false",
                                                          "float",
                                                          "for",
                                                          "friend",
                                                          "goto",
                                                          "if",
                                                          "inline",
                                                          "int",
                                                          "long",
                                                          "mutable",
                                                          "namespace",
                                                          "new",
                                                          "noexcept",
                                                          "not",
                                                          "not_eq",
                                                          "nullptr",
                                                          "operator",
                                                          "or",
                                                          "or_eq",
                                                          "private",
                                                          "protected",
                                                          "public",
                                                          "register",
                                                          "reinterpret_cast",
                                                          "requires",
                                                          "restrict",
                                                          "return",
                                                          "short",
                                                          "signed",
                                                          "sizeof",
                                                          "static",
                                                          "static_assert",
                                                          "static_cast",
                                                          "struct",
                                                          "switch",
                                                          "template",
                                                          "this",
                                                          "thread_local",
                                                          "throw",
                                                          "true",
                                                          "try",
                                                          "typedef",
                                                          "typeid",
                                                          "typename",
                                                          "union",
                                                          "unsigned",
                                                          "using",
                                                          "virtual",
                                                          "void",
                                                          "volatile",
                                                          "wchar_t",
                                                          "while",
                                                          "xor",
                                                          "xor_eq"});
  return std::ranges::find(words, word) != words.end();
}

}  // namespace sepcal::fuzz
