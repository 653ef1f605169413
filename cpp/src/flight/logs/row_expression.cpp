// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/row_expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "base/utf8.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

constexpr int deepest = 100;  // brackets within brackets

enum class Kind { number, name, label, sign, end };

struct Token {
  Kind kind = Kind::end;
  std::string text = {};  // of a name or label without its quotes
  double value = 0.0;
  std::size_t begin = 0;  // in the condition
};

bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) { advance(); }

  const Token& next() const { return next_; }

  Token take() {
    Token taken = next_;
    advance();
    return taken;
  }

  /// Takes the next one where it is this sign or word.
  bool take(std::string_view sign) {
    const bool is_it = (next_.kind == Kind::sign || next_.kind == Kind::name) && !next_is_quoted_ &&
                       next_.text == sign;
    if (is_it) advance();
    return is_it;
  }

  [[noreturn]] void fail(const std::string& expected) const {
    if (next_.kind == Kind::end) {
      throw Error(fmt::format("'{}' ends where {} should come", text_, expected));
    }
    throw Error(fmt::format("'{}' has '{}' where {} should come", text_,
                            text_.substr(next_.begin, end_ - next_.begin), expected));
  }

 private:
  void advance() {
    while (end_ < text_.size() && (text_[end_] == ' ' || text_[end_] == '\t')) ++end_;
    next_ = {.begin = end_};
    next_is_quoted_ = false;
    if (end_ == text_.size()) return;
    const char c = text_[end_];
    if (begins_name(c)) {
      read_name();
    } else if (is_digit(c) || c == '.') {
      read_number();
    } else if (c == '\'' || c == '"' || c == '`') {
      read_quoted(c);
    } else {
      read_sign();
    }
  }

  void read_name() {
    const std::size_t begin = end_;
    while (end_ < text_.size() &&
           (begins_name(text_[end_]) || is_digit(text_[end_]) || text_[end_] == '.')) {
      ++end_;
    }
    next_.kind = Kind::name;
    next_.text = text_.substr(begin, end_ - begin);
  }

  void read_number() {
    const char* begin = text_.data() + end_;
    const auto [rest, error] = std::from_chars(begin, text_.data() + text_.size(), next_.value);
    if (error != std::errc{}) {
      throw Error(fmt::format("'{}' has no number at '{}'", text_, text_.substr(end_)));
    }
    next_.kind = Kind::number;
    end_ += static_cast<std::size_t>(rest - begin);
    next_.text = text_.substr(next_.begin, end_ - next_.begin);
  }

  void read_quoted(char quote) {
    const std::size_t close = text_.find(quote, end_ + 1);
    if (close == std::string_view::npos) {
      throw Error(fmt::format("'{}' opens {} and does not close it", text_, quote));
    }
    next_.kind = quote == '`' ? Kind::name : Kind::label;
    next_is_quoted_ = true;
    next_.text = text_.substr(end_ + 1, close - end_ - 1);
    end_ = close + 1;
  }

  void read_sign() {
    constexpr std::array<std::string_view, 14> signs{"<=", ">=", "==", "!=", "&&", "||", "<",
                                                     ">",  "+",  "-",  "*",  "/",  "(",  ")"};
    next_.kind = Kind::sign;
    for (const std::string_view sign : signs) {
      if (text_.substr(end_, sign.size()) != sign) continue;
      next_.text = sign;
      end_ += sign.size();
      return;
    }
    // "!", or a character that nobody knows.
    const std::size_t length = std::max<std::size_t>(1, base::utf8_length(text_, end_));
    next_.text = text_.substr(end_, length);
    end_ += length;
  }

  std::string_view text_;
  std::size_t end_ = 0;  // of the next token
  Token next_;
  bool next_is_quoted_ = false;
};

using Relation = bool (*)(double, double);

/// The comparison that a sign stands for; nullptr for another token.
Relation relation_of(const Token& token) {
  if (token.kind != Kind::sign) return nullptr;
  const std::string_view sign = token.text;
  if (sign == "<") return [](double a, double b) { return a < b; };
  if (sign == "<=") return [](double a, double b) { return a <= b; };
  if (sign == ">") return [](double a, double b) { return a > b; };
  if (sign == ">=") return [](double a, double b) { return a >= b; };
  if (sign == "==") return [](double a, double b) { return a == b; };
  if (sign == "!=") return [](double a, double b) { return a < b || a > b; };
  return nullptr;
}

class Parser {
 public:
  Parser(std::string_view text, const RowNames& names) : tokens_(text), names_(names) {}

  RowTruth whole() {
    RowTruth condition = either();
    if (tokens_.next().kind != Kind::end) tokens_.fail("'and', 'or' or the end");
    return condition;
  }

 private:
  /// Counts brackets and signs that are open while it lives.
  class Depth {
   public:
    explicit Depth(int& depth) : depth_(depth) {
      if (++depth_ > deepest) {
        --depth_;
        throw Error(fmt::format("a condition has at most {} brackets within each other", deepest));
      }
    }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    ~Depth() { --depth_; }

   private:
    int& depth_;
  };

  RowTruth either() {
    const Depth depth(depth_);
    RowTruth left = both();
    while (tokens_.take("or") || tokens_.take("||")) {
      left = [left = std::move(left), right = both()](std::size_t row) {
        return left(row) || right(row);
      };
    }
    return left;
  }

  RowTruth both() {
    RowTruth left = one();
    while (tokens_.take("and") || tokens_.take("&&")) {
      left = [left = std::move(left), right = one()](std::size_t row) {
        return left(row) && right(row);
      };
    }
    return left;
  }

  RowTruth one() {
    const Depth depth(depth_);
    if (tokens_.take("not") || tokens_.take("!")) {
      return [inner = one()](std::size_t row) { return !inner(row); };
    }
    return comparison();
  }

  RowTruth comparison() {
    if (is_bracketed_condition()) {
      tokens_.take("(");
      RowTruth inner = either();
      if (!tokens_.take(")")) tokens_.fail("')'");
      return inner;
    }
    if (tokens_.take("maneuver")) return compare_label();
    RowNumber left = sum();
    if (relation_of(tokens_.next()) == nullptr) tokens_.fail("<, <=, >, >=, == or !=");
    RowTruth all;
    while (const Relation relation = relation_of(tokens_.next())) {
      tokens_.take();
      RowNumber right = sum();
      const auto holds = [left, right, relation](std::size_t row) {
        return relation(left(row), right(row));
      };
      if (all) {
        all = [all = std::move(all), holds](std::size_t row) { return all(row) && holds(row); };
      } else {
        all = holds;
      }
      left = std::move(right);
    }
    return all;
  }

  /// Whether "(" comes and opens a condition, not a sum: something before its ")" compares.
  bool is_bracketed_condition() const {
    Tokens ahead = tokens_;
    if (!ahead.take("(")) return false;
    for (int open = 1; open > 0 && ahead.next().kind != Kind::end;) {
      if (relation_of(ahead.next()) != nullptr) return true;
      if (ahead.take("(")) {
        ++open;
      } else if (ahead.take(")")) {
        --open;
      } else {
        ahead.take();
      }
    }
    return false;
  }

  RowTruth compare_label() {
    const bool equal = tokens_.take("==");
    if (!equal && !tokens_.take("!=")) tokens_.fail("== or !=");
    if (tokens_.next().kind != Kind::label) tokens_.fail("a label in quotes, as in 'turn',");
    if (!names_.maneuver) throw Error("there is no column maneuver");
    return [label = tokens_.take().text, equal, own = names_.maneuver](std::size_t row) {
      return (own(row) == label) == equal;
    };
  }

  RowNumber sum() {
    RowNumber left = product();
    for (;;) {
      if (tokens_.take("+")) {
        left = [left = std::move(left), right = product()](std::size_t row) {
          return left(row) + right(row);
        };
      } else if (tokens_.take("-")) {
        left = [left = std::move(left), right = product()](std::size_t row) {
          return left(row) - right(row);
        };
      } else {
        return left;
      }
    }
  }

  RowNumber product() {
    RowNumber left = factor();
    for (;;) {
      if (tokens_.take("*")) {
        left = [left = std::move(left), right = factor()](std::size_t row) {
          return left(row) * right(row);
        };
      } else if (tokens_.take("/")) {
        left = [left = std::move(left), right = factor()](std::size_t row) {
          return left(row) / right(row);
        };
      } else {
        return left;
      }
    }
  }

  RowNumber factor() {
    const Depth depth(depth_);
    if (tokens_.take("-")) {
      return [inner = factor()](std::size_t row) { return -inner(row); };
    }
    if (tokens_.take("(")) {
      RowNumber inner = sum();
      if (!tokens_.take(")")) tokens_.fail("')'");
      return inner;
    }
    if (tokens_.next().kind == Kind::number) {
      return [value = tokens_.take().value](std::size_t) { return value; };
    }
    if (tokens_.next().kind != Kind::name) tokens_.fail("a number, a name or '('");
    const Token name = tokens_.take();
    if (name.text == "abs" && tokens_.take("(")) {
      RowNumber inner = sum();
      if (!tokens_.take(")")) tokens_.fail("')'");
      return [inner = std::move(inner)](std::size_t row) { return std::abs(inner(row)); };
    }
    return names_.number(name.text);
  }

  Tokens tokens_;
  const RowNames& names_;
  int depth_ = 0;
};

}  // namespace

RowTruth parse_condition(std::string_view text, const RowNames& names) {
  constexpr std::size_t longest = 4'000;
  if (text.size() > longest) {
    throw Error(fmt::format("a condition has at most {} characters, not {}", longest, text.size()));
  }
  return Parser(text, names).whole();
}

}  // namespace sepcal::logs
