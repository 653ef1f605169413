// SPDX-License-Identifier: BSD-3-Clause
// What is derived from the tables of effects beside the kit and the catalogue: sentences, and what
// acts on the world.
#include "flight/catalogue/effect_table.hpp"

#include <doctest/doctest.h>

#include <map>
#include <set>

#include "flight/catalogue/effect_candidates.hpp"
#include "flight/catalogue/effect_channels.hpp"
#include "sepcal/error.hpp"

namespace effect_table_test {

using namespace sepcal;
using namespace sepcal::catalogue;

TEST_CASE("an effect means the same on every probe that has it") {
  std::map<std::string, std::string> sentences;
  for (const auto& [probe, table] : effect_tables()) {
    CAPTURE(probe);
    for (const EffectRow& row : table.effects) {
      CAPTURE(row.name());
      const auto sentence = describe_effect(table, row.name());
      CHECK(!sentence.empty());
      CHECK(sentences.try_emplace(row.name(), sentence).first->second == sentence);
    }
    for (const PortRow& row : table.ports) {
      CAPTURE(row.port.name);
      const auto sentence = describe_effect(table, row.port.name + "[throttle]");
      CHECK(sentence.ends_with(" with throttle"));
      CHECK(sentences.try_emplace(row.port.name + "[]", sentence).first->second == sentence);
    }
  }
}

TEST_CASE("a sentence says what changes, and with what") {
  const EffectTable& air = effect_table("five-hole");
  CHECK(describe_effect(air, "wind[altitude_m]") == "the wind changes with altitude_m");
  CHECK(describe_effect(air, "pressure_offset") == "the zero of the pressure difference is off");
  CHECK(describe_effect(air, "pressure_offset[q]") ==
        "the pressure difference is off, changing with q");
  CHECK(describe_effect(air, "wind[maneuver]") == "the wind is another one in every maneuver");
  CHECK(describe_effect(air, "wind[time^2]+time_offset") ==
        "the wind changes with time^2, and the sensor's time is late");
  CHECK(describe_effect(air, "motor") == "your own effect motor");
  CHECK(describe_effect(air, "eddy_currents") == "your own effect eddy_currents");
}

TEST_CASE("what acts on the world is what docs/effects.md leaves uncorrected") {
  std::set<std::string> world;
  for (const auto& [probe, table] : effect_tables()) {
    for (const EffectRow& row : table.effects) {
      if (acts_on_the_world(table, parse_effect_name(row.name()))) world.insert(row.name());
    }
    for (const PortRow& row : table.ports) {
      const auto driven = parse_effect_name(row.port.name + "[throttle]");
      if (acts_on_the_world(table, driven)) world.insert(row.port.name);
    }
  }
  CHECK(world == std::set<std::string>{"wind", "heading_bias", "lever_arm", "mounting_error",
                                       "field_declination", "attitude_bias"});
}

TEST_CASE("there is no table of another probe") {
  CHECK_THROWS_WITH_AS(effect_table("venturi"), "there is no model 'venturi'", Error);
}

}  // namespace effect_table_test
