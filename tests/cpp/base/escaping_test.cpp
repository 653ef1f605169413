// SPDX-License-Identifier: BSD-3-Clause
// Strings as they leave sepcal, for each language that they enter.
#include "base/escaping.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "base/page.hpp"
#include "flight/export/driver_names.hpp"

namespace escaping_test {

using namespace sepcal::base;

/// Words made of what each language minds.
std::string hostile(std::mt19937_64& generator) {
  constexpr std::array<std::string_view, 24> pieces{"*/",
                                                    "/*",
                                                    "*",
                                                    "/",
                                                    "\\",
                                                    "\n",
                                                    "\r",
                                                    "\t",
                                                    "?"
                                                    "?/",
                                                    "??",
                                                    "'",
                                                    "\"",
                                                    "$(id)",
                                                    "`",
                                                    "\x1b[31m",
                                                    "\x7f",
                                                    "#",
                                                    "a b",
                                                    "<b>",
                                                    "\xc2\x9b",
                                                    "\xff",
                                                    "\xe2\x80\xae",
                                                    "\xe2\x81\xa6",
                                                    "\xc3\xbc"};
  std::string word;
  const auto count = 1 + generator() % 8;
  for (std::uint64_t i = 0; i < count; ++i) word += pieces[generator() % pieces.size()];
  return word;
}

TEST_CASE("a line holds nothing that ends it or steers a terminal") {
  CHECK(in_line("a\nb\x1b[1m") == "a\\nb\\x1b[1m");
  CHECK(in_line("\xe2\x80\xae"
                "gpj.exe \xe2\x81\xa9") == "\\xe2\\x80\\xaegpj.exe \\xe2\\x81\\xa9");
  CHECK(in_line("\xd8\x9c"
                "1") == "\\xd8\\x9c1");  // U+061C, which turns the direction of writing too
  CHECK(in_line("\xe2\x82\xac \xe2\x80\x94") == "\xe2\x82\xac \xe2\x80\x94");
  std::mt19937_64 generator(1);
  for (int i = 0; i < 2000; ++i) {
    const std::string line = in_line(hostile(generator));
    CHECK(in_line(line) == line);
    for (const char c : line) CHECK((static_cast<unsigned char>(c) >= 0x20 && c != 0x7f));
  }
}

TEST_CASE("a C comment ends where it should") {
  CHECK(in_c_comment("*/system(x);/*") == "* /system(x);/ *");
  CHECK(in_c_comment("/*/") == "/ * /");
  CHECK(in_c_comment("**//") == "** //");
  CHECK(in_c_comment("*\\\n/") == "*\\\\n/");
  CHECK(in_c_comment("*\\") == "*\\x5c");
  CHECK(in_c_comment("?"
                     "?"
                     "?/") == "? ? ?/");
  std::mt19937_64 generator(2);
  for (int i = 0; i < 2000; ++i) {
    const std::string comment = in_c_comment(hostile(generator));
    for (const char* const bad : {"*/", "/*", "??", "\n"}) {
      CHECK(comment.find(bad) == std::string::npos);
    }
    CHECK(!comment.ends_with('\\'));
  }
}

/// What the shell makes of a word.
std::string as_the_shell_reads(const std::string& word) {
  FILE* const pipe =
      popen(("bash -c \"$(cat <<'the end'\nprintf %s " + word + "\nthe end\n)\"").c_str(), "r");
  std::string read;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) read += static_cast<char>(c);
  pclose(pipe);
  return read;
}

TEST_CASE("a column's name is an identifier of C and C++") {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  std::mt19937_64 generator(4);
  std::vector<std::string> headers{"NAN",   "INFINITY", "int", "co_await", "restrict", "asm",
                                   "linux", "main",     "at",  "k",        "x_1",      "_Bool",
                                   "EOF",   "A",        "_",   "__LINE__", "1x",       "sepcal_"};
  for (const std::string& taken : headers) CHECK(sepcal::exporting::identifier(taken) != taken);
  headers.insert(headers.end(), {"", "a__b", "\xc3\xbc", std::string(1000, 'x')});
  for (int i = 0; i < 2000; ++i) headers.push_back(hostile(generator));
  for (const std::string& header : headers) {
    CAPTURE(header);
    const std::string name = sepcal::exporting::identifier(header);
    CHECK(is_letter(name.front()));
    CHECK(name.front() != '_');
    CHECK(
        std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); }));
    const bool has_small = std::ranges::any_of(name, [](char c) { return c >= 'a' && c <= 'z'; });
    CHECK(has_small);  // macros have none
  }
}

TEST_CASE("a word is the same to the shell") {
  CHECK(in_shell("logs/flight_1.csv") == "logs/flight_1.csv");
  CHECK(in_shell("") == "''");
  CHECK(in_shell("bias[current_a]") == "'bias[current_a]'");
  CHECK(in_shell("it's") == "'it'\\''s'");
  CHECK(in_shell("a\nb") == "$'a\\nb'");
  std::mt19937_64 generator(3);
  for (int i = 0; i < 100; ++i) {
    const std::string word = hostile(generator);
    CHECK(as_the_shell_reads(in_shell(word)) == word);
    CHECK(in_line(in_shell(word)) == in_shell(word));
  }
}

TEST_CASE("a page escapes what it shows, and no page twice") {
  const std::string name = "x\n\x1b[2J";
  CHECK(page("{:<3}|{}\n", name, 2.5).text() == "x\\n\\x1b[2J|2.5\n");
  CHECK(page("[{}]", page("{}\n", "a")).text() == "[a\n]");
  CHECK(joined({"a", "b\r"}, ", ").text() == "a, b\\r");
  CHECK((page("{}  ", 1).trimmed() + "\n").text() == "1\n");
  static_assert(!std::is_convertible_v<std::string, Page>);
}

}  // namespace escaping_test
