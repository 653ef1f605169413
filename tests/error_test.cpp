// SPDX-License-Identifier: BSD-3-Clause
// The one exception that the library throws.
#include "sepcal/error.hpp"

#include <doctest/doctest.h>

#include <string>

TEST_CASE("an Error carries its line and is caught as a standard exception") {
  const auto fail = [] { throw sepcal::Error("column 'yaw' is missing"); };
  CHECK_THROWS_AS(fail(), const std::runtime_error&);
  try {
    fail();
  } catch (const std::exception& error) {
    CHECK(std::string(error.what()) == "column 'yaw' is missing");
  }
}
