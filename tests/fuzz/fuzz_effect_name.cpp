// SPDX-License-Identifier: BSD-3-Clause
// The names of effects, as options, files and scripts hand them in: a name alone, a list, and the
// effects that a short log makes of the list with every probe.
#include <algorithm>

#include "fuzzing.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/effect_name.hpp"
#include "small_flights.hpp"

namespace sepcal::fuzz {
namespace {

using Shape = EffectName::Shape;

std::string without_blanks(std::string_view text) {
  std::string kept(text);
  std::erase_if(kept, [](char c) { return c == ' ' || c == '\t'; });
  return kept;
}

bool number_fits(const EffectName& name) {
  if (name.shape == Shape::spline) return name.number >= 3 && name.number <= 1000;
  if (name.shape == Shape::power) return name.number >= 1 && name.number <= 9;
  return name.number == 1;
}

void check_name(std::string_view text) {
  const EffectName name = parse_effect_name(text);
  require(name.text == without_blanks(text), "a name is its text without blanks");
  require(!name.port.empty() && name.text.starts_with(name.port), "a name begins with its port");
  require(name.base.empty() == (name.shape == Shape::none), "a driver has a channel");
  require(name.text.find(name.base, name.port.size()) != std::string::npos,
          "the channel stands in the name");
  require(number_fits(name), "a power or a spline has a number within its bounds");
  const EffectName again = parse_effect_name(name.text);
  require(again.text == name.text && again.port == name.port && again.base == name.base &&
              again.shape == name.shape && again.number == name.number,
          "a name's text parses to the same");
}

void check_list(std::string_view text, std::vector<std::string>& names) {
  names = split_effects(text);
  std::string joined;
  for (const std::string& name : names) {
    require(!name.empty(), "a list's names aren't empty");
    joined += (joined.empty() ? "" : "+") + name;
  }
  require(joined == without_blanks(text), "a list is its names, joined by '+'");
}

/// Effects of these names, with what is taken from the flight, made again from that.
void make_effects(const std::shared_ptr<const Probe>& probe,
                  const std::vector<std::string>& names) {
  const Flight& flight = flight_for(*probe);
  const ProbeRecord prepared = probe->prepare(flight, {});
  std::vector<EffectSetting> settings;
  for (const std::string& name : names) settings.push_back({.name = name});
  const EffectiveFlight first = with_effects(*probe, flight, prepared, settings, {});
  require(first.effects.size() == names.size(), "every name makes an effect");
  for (EffectSetting& setting : settings) setting.known = true;
  std::vector<EffectSetting> known = settings;
  const EffectiveFlight second = with_effects(*probe, flight, prepared, known, {});
  require(known == settings, "settings that are known stay as they are");
  require(
      std::ranges::equal(first.model->tables().parameters(), second.model->tables().parameters(),
                         {}, &Variable::name, &Variable::name),
      "the same settings make the same parameters");
}

}  // namespace
}  // namespace sepcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal::fuzz;
  constexpr std::size_t most_names = 6;  // more only take longer
  const std::string_view text = text_of(data, size);
  accepts([&] { check_name(text); });
  std::vector<std::string> names;
  if (!accepts([&] { check_list(text, names); })) return 0;
  if (names.size() > most_names) names.resize(most_names);
  for (const auto& probe : probes()) accepts([&] { make_effects(probe, names); });
  return 0;
}
