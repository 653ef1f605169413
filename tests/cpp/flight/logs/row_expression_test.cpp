// SPDX-License-Identifier: BSD-3-Clause
// Conditions on rows: what they mean, by hand, and what is refused.
#include "flight/logs/row_expression.hpp"

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <map>

#include "sepcal/error.hpp"

namespace row_expression_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::logs::parse_condition;
using sepcal::logs::RowNames;
using sepcal::logs::RowNumber;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

RowNames names() {
  const auto number = [](const std::string& name) -> RowNumber {
    static const std::map<std::string, std::array<double, 4>> columns{
        {"airspeed", {10, 20, 30, nan}}, {"roll_deg", {-50, 0, 50, 1}}, {"Mag X", {1, 2, 3, 4}}};
    const auto found = columns.find(name);
    if (found == columns.end()) throw Error("'" + name + "' is no column");
    return [&values = found->second](std::size_t row) { return values[row]; };
  };
  const auto label = [](std::size_t row) -> std::string_view {
    return row < 2 ? "taxi" : "left turn";
  };
  return {number, label};
}

/// Rows 0 to 3: "0110" where it holds in 1 and 2.
std::string rows_of(std::string_view text) {
  const auto condition = parse_condition(text, names());
  std::string rows;
  for (std::size_t row = 0; row < 4; ++row) rows += condition(row) ? '1' : '0';
  return rows;
}

std::string refusal(std::string_view text) {
  try {
    static_cast<void>(parse_condition(text, names()));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("comparisons, chains, arithmetic and labels mean what they say") {
  CHECK(rows_of("airspeed > 20") == "0010");
  CHECK(rows_of("airspeed >= 20") == "0110");
  CHECK(rows_of("15 < airspeed < 25") == "0100");
  CHECK(rows_of("airspeed == 20") == "0100");
  CHECK(rows_of("airspeed != 20") == "1010");
  CHECK(rows_of("abs(roll_deg) < 45") == "0101");
  CHECK(rows_of("-roll_deg > 1e1") == "1000");
  CHECK(rows_of("2*airspeed - 10/2 + 1 > 40") == "0010");
  CHECK(rows_of("(airspeed + 1) * 2 < 23") == "1000");
  CHECK(rows_of("`Mag X`>=3") == "0011");
  CHECK(rows_of("maneuver == 'left turn'") == "0011");
  CHECK(rows_of("maneuver != \"taxi\"") == "0011");
}

TEST_CASE("'not' binds closer than 'and', and that closer than 'or'") {
  CHECK(rows_of("airspeed > 20 or airspeed < 15 and roll_deg > 0") == "0010");
  CHECK(rows_of("(airspeed > 20 or airspeed < 15) and roll_deg < 0") == "1000");
  CHECK(rows_of("not airspeed > 20 and roll_deg < 0") == "1000");
  CHECK(rows_of("not (airspeed > 20 and roll_deg > 0)") == "1101");
  CHECK(rows_of("!(airspeed>20)&&airspeed>0||`Mag X`==4") == "1101");
  CHECK(rows_of("((airspeed > 20))") == "0010");
}

TEST_CASE("a comparison with no number does not hold") {
  CHECK(rows_of("airspeed < 1e9")[3] == '0');
  CHECK(rows_of("airspeed != 0")[3] == '0');
  CHECK(rows_of("not airspeed < 1e9")[3] == '1');
}

TEST_CASE("what is no condition is refused with what should come where") {
  CHECK(refusal("airspeed >") == "'airspeed >' ends where a number, a name or '(' should come");
  CHECK(refusal("airspeed") == "'airspeed' ends where <, <=, >, >=, == or != should come");
  CHECK(refusal("airspeed = 20") ==
        "'airspeed = 20' has '=' where <, <=, >, >=, == or != should "
        "come");
  CHECK(refusal("airspeed > 20 roll_deg < 3") ==
        "'airspeed > 20 roll_deg < 3' has 'roll_deg' where 'and', 'or' or the end should come");
  CHECK(refusal("(airspeed > 20") == "'(airspeed > 20' ends where ')' should come");
  CHECK(refusal("maneuver == turn") ==
        "'maneuver == turn' has 'turn' where a label in quotes, as in 'turn', should come");
  CHECK(refusal("airsped > 3") == "'airsped' is no column");
  CHECK(refusal("'turn' == 3").find("'turn'") != std::string::npos);
  CHECK(refusal("maneuver == 'turn").find("does not close it") != std::string::npos);
  CHECK(refusal("") == "'' ends where a number, a name or '(' should come");
  CHECK(refusal(std::string(200, '(') + "1<2").find("at most 100 brackets") != std::string::npos);
  CHECK(refusal(std::string(5'000, ' ')).find("at most 4000 characters") != std::string::npos);
  const RowNames unlabelled{names().number, {}};
  CHECK_THROWS_WITH_AS(parse_condition("maneuver == 'a'", unlabelled),
                       "there is no column maneuver", Error);
}

}  // namespace row_expression_test
