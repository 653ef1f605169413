// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/probe_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sepcal/detail/path_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

namespace {

/// Throws Error for a driver that the log has and the record does not, as a cell is no number.
void check_driver(const EffectSetting& setting, const Flight& flight, const Record& record) {
  const EffectName name = parse_effect_name(setting.name);
  const Flight::Column* column = name.base.empty() ? nullptr : flight.find(name.base);
  if (column == nullptr || record.has(name.base)) return;
  const auto is_number = [](double value) { return std::isfinite(value); };
  const auto bad = std::ranges::find_if_not(column->values, is_number);
  if (bad == column->values.end()) return;
  const auto row = static_cast<std::size_t>(bad - column->values.begin());
  throw Error(
      fmt::format("effect {}: column '{}' holds no number at {}; fill it in or delete the row",
                  setting.name, column->header, flight.locate(row)));
}

}  // namespace

std::shared_ptr<const BlockModel> model_of(const Probe& probe) {
  return {std::shared_ptr<const BlockModel>(), &probe.model()};
}

EffectiveFlight with_effects(const Probe& probe, const Record& record,
                             std::vector<EffectSetting>& settings, const OwnEffects& own,
                             const std::map<std::string, Interval>& bounds) {
  EffectiveFlight result;
  Record& extended = result.prepared.record = record;
  const auto model = model_of(probe);
  result.effects = make_effects(effect_kit(probe, own), *model, settings, extended);
  result.model = compose(model, result.effects, extended);
  const bool goes_on = dynamic_cast<const PathModel*>(model.get()) != nullptr;
  if (!goes_on) extended = without_edges(std::move(extended), reach(result.effects, bounds));
  return result;
}

EffectiveFlight with_effects(const Probe& probe, const Flight& flight, const ProbeRecord& prepared,
                             std::vector<EffectSetting>& settings, const OwnEffects& own,
                             const std::map<std::string, Interval>& bounds) {
  try {
    for (const EffectSetting& setting : settings) check_driver(setting, flight, prepared.record);
    EffectiveFlight result = with_effects(probe, prepared.record, settings, own, bounds);
    result.prepared.notes = prepared.notes;
    return result;
  } catch (const Error& error) {
    throw_within(flight.name() + ": ", error);
  }
}

}  // namespace sepcal
