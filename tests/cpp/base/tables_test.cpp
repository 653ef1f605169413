// SPDX-License-Identifier: BSD-3-Clause
// Names, units and bounds: the four tables at run time.
#include "sepcal/detail/tables.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/error.hpp"

namespace tables_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::Quantity;
using sepcal::Tables;
using sepcal::Variable;

TEST_CASE("a quantity is unbounded unless it says otherwise") {
  constexpr Quantity plain{"w_n", "m/s"};
  CHECK(plain.lower == -sepcal::infinity);
  CHECK(plain.upper == sepcal::infinity);
}

TEST_CASE("an input has no value where it is absent, a port is zero there") {
  constexpr Quantity plain{"pt", "Pa"};
  CHECK(std::isnan(plain.absent));
  constexpr Quantity driven = sepcal::port("pressure_offset", "Pa");
  CHECK(driven.absent == 0.0);
  CHECK(driven.unit == "Pa");
  CHECK(driven.upper == sepcal::infinity);
  CHECK(Variable(driven).absent == 0.0);
  CHECK(std::isnan(Variable("pt", "Pa").absent));
}

TEST_CASE("a variable keeps its quantity's name, unit and bounds") {
  const Variable variable(Quantity{"b_alpha", "rad", -0.25, 0.5});
  CHECK(variable.name == "b_alpha");
  CHECK(variable.unit == "rad");
  CHECK(variable.lower == -0.25);
  CHECK(variable.upper == 0.5);
}

TEST_CASE("parameters are the linear ones first, then the nonlinear ones") {
  const Tables tables{
      {{"u", "1"}}, {{"z", "1"}, {"y", "1"}}, {{"b", "1"}, {"a", "1"}}, {{"c", "1"}}};
  CHECK(tables.n_u() == 1);
  CHECK(tables.n_z() == 2);
  CHECK(tables.n_1() == 2);
  CHECK(tables.n_2() == 1);
  const auto parameters = tables.parameters();
  REQUIRE(parameters.size() == 3);
  CHECK(parameters[0].name == "b");
  CHECK(parameters[1].name == "a");
  CHECK(parameters[2].name == "c");
}

TEST_CASE("a name that is empty or used twice is an error that names it") {
  const Tables good{{{"u", "1"}}, {{"z", "1"}}, {{"a", "1"}}, {{"c", "1"}}};
  CHECK_NOTHROW(good.check_names());

  Tables tables = good;
  tables.nonlinear.front().name = "a";  // across the two tables of parameters
  CHECK_THROWS_WITH_AS(tables.check_names(), Contains("two parameters named 'a'"), Error);
  tables = good;
  tables.inputs.push_back({"u", "m"});
  CHECK_THROWS_WITH_AS(tables.check_names(), Contains("two inputs named 'u'"), Error);
  tables = good;
  tables.outputs.push_back({"z", "m"});
  CHECK_THROWS_WITH_AS(tables.check_names(), Contains("two outputs named 'z'"), Error);
  tables = good;
  tables.linear.front().name.clear();
  CHECK_THROWS_WITH_AS(tables.check_names(), Contains("parameter has an empty name"), Error);
}

TEST_CASE("an input, an output and a parameter may share a name") {
  const Tables tables{{{"x", "1"}}, {{"x", "1"}}, {{"x", "1"}}, {}};
  CHECK_NOTHROW(tables.check_names());
}

}  // namespace tables_test
