// SPDX-License-Identifier: BSD-3-Clause
// Products of powers of channels: what is one, its values, and how one drives an effect.
#include "sepcal/detail/channel_product.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"
#include "sepcal/static_model.hpp"
#include "small_models.hpp"

namespace channel_product_test {

using namespace sepcal;
using doctest::Approx;
using Factors = std::vector<ChannelFactor>;

namespace {

Record two_channels() {
  Record record;
  record.add("time", {0.0, 0.1, 0.2, 0.3});
  record.add("u", {1.0, 2.0, 3.0, 4.0});
  record.add("a", {-2.0, 0.5, 1.0, 3.0});
  record.add("b", {4.0, -1.0, 0.0, 2.0});
  return record;
}

}  // namespace

TEST_CASE("factors are channels, their powers from 1 to 9, and sizes") {
  CHECK(*read_product("a") == Factors{{"a", 1, false}});
  CHECK(*read_product("a^2*b") == Factors{{"a", 2, false}, {"b", 1, false}});
  CHECK(*read_product("b*abs(b)") == Factors{{"b", 1, false}, {"b", 1, true}});
  CHECK(*read_product("altitude_m^9") == Factors{{"altitude_m", 9, false}});
  for (const char* text : {"", "*", "a*", "*a", "a^0", "a^10", "a^n", "a^-1", "2*a", "a b", "abs(a",
                           "sin(a)", "a+b", "abs(a*b)"}) {
    CAPTURE(text);
    CHECK(!read_product(text));
  }
}

TEST_CASE("the product of a row is that of its values") {
  const Record record = two_channels();
  const std::vector<double> product = multiply(*read_product("a^2*abs(b)"), record);
  const auto a = record.column("a");
  const auto b = record.column("b");
  for (std::size_t row = 0; row < product.size(); ++row) {
    CHECK(product[row] == Approx(std::pow(a[row], 2) * std::abs(b[row])));
  }
  CHECK_THROWS_AS(multiply(*read_product("a*c"), record), Error);
}

TEST_CASE("a product drives an effect, and reads each of its channels") {
  const auto name = parse_effect_name("s[a^2*b]");
  CHECK(name.shape == EffectName::Shape::product);
  CHECK(name.base == "a^2*b");
  CHECK(driver_channels(name) == std::vector<std::string>{"a", "b"});
  CHECK(driver_channels(parse_effect_name("s[b*abs(b)]")) == std::vector<std::string>{"b"});
  CHECK(driver_channels(parse_effect_name("s[b^2]")) == std::vector<std::string>{"b"});

  const auto model = std::make_shared<StaticModel<test::Line>>(test::Line{});
  Record record = two_channels();
  std::vector<EffectSetting> settings{{.name = "s[a^2*b]"}};
  const auto effects = make_effects(plain_kit(model->tables()), *model, settings, record);
  CHECK(effects.front().driver->input()->name == "a^2*b");
  CHECK(record.column("a^2*b")[0] == Approx(16.0));
}

TEST_CASE("a product of what isn't there, of what is measured, or of a label is refused") {
  const auto model = std::make_shared<StaticModel<test::Line>>(test::Line{});
  const auto refused = [&](const char* name, const char* why) {
    Record record = two_channels();
    record.add("z", {1.0, 2.0, 2.0, 1.0});
    std::vector<EffectSetting> settings{{.name = name}};
    CHECK_THROWS_WITH_AS(make_effects(plain_kit(model->tables()), *model, settings, record),
                         doctest::Contains(why), Error);
  };
  refused("s[a*c]", "there is no channel 'c'");
  refused("s[a*z]", "'z' is what is measured");
  refused("s[a*maneuver]", "maneuver is a label");
}

}  // namespace channel_product_test
