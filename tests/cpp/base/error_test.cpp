// SPDX-License-Identifier: BSD-3-Clause
// The one exception that the library throws.
#include "sepcal/error.hpp"

#include <doctest/doctest.h>

#include <string>

namespace error_test {

TEST_CASE("an Error carries its line and is caught as a standard exception") {
  const auto fail = [] { throw sepcal::Error("column 'yaw' is missing"); };
  CHECK_THROWS_AS(fail(), const std::runtime_error&);
  try {
    fail();
  } catch (const std::exception& error) {
    CHECK(std::string(error.what()) == "column 'yaw' is missing");
  }
}

TEST_CASE("a message is one printable line, whatever it quotes") {
  const auto line = [](const std::string& message) {
    return std::string(sepcal::Error(message).what());
  };
  CHECK(line("status 'a\nb\r\tc' is unknown") == "status 'a\\nb\\r\\tc' is unknown");
  CHECK(line(std::string("\0\x1B[31m\x7F", 7)) == "\\x00\\x1b[31m\\x7f");
  // C1 controls and Unicode's line and paragraph separators end lines and steer terminals as well.
  CHECK(line("a\xC2\x85\xC2\x9B\xE2\x80\xA8\xE2\x80\xA9z") ==
        "a\\xc2\\x85\\xc2\\x9b\\xe2\\x80\\xa8\\xe2\\x80\\xa9z");
  CHECK(line("\xC3\xBC \xE2\x82\xAC \xF0\x9F\x9B\xA9 \xC2\xA0") ==
        "\xC3\xBC \xE2\x82\xAC \xF0\x9F\x9B\xA9 \xC2\xA0");
  CHECK(line("caf\xE9 \xED\xA0\x80 \xE2\x82") == "caf\\xe9 \\xed\\xa0\\x80 \\xe2\\x82");
}

}  // namespace error_test
