// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/step_times.hpp"

#include <algorithm>

#include "base/parameter_values.hpp"
#include "estimation/scan.hpp"
#include "sepcal/composition.hpp"

namespace sepcal::estimation {
namespace {

using Times = std::map<std::string, EffectSetting*>;

bool is_step(const Effect& effect) { return effect.driver && effect.driver->is_step(); }

/// The options of a fit without the steps that are sought: what they say of the steps' parameters
/// is left out.
FitOptions without_sought(FitOptions options, const Times& sought) {
  const auto is_of_one = [&](const auto& entry) {
    return std::ranges::any_of(
        sought, [&](const auto& time) { return entry.first.starts_with(time.second->name + "."); });
  };
  std::erase_if(options.bounds, is_of_one);
  std::erase_if(options.fix, is_of_one);
  std::erase_if(options.sampling_distribution, is_of_one);
  std::erase_if(options.start, is_of_one);
  std::erase_if(options.unsampled, is_of_one);
  return options;
}

/// A fit's estimates, with what is held; steps not found yet are in the middle of the record.
ScanPoint point_of(const Fit& fit, const FitOptions& options, const Times& sought) {
  ScanPoint point{fit.by_name(), options.fix, options.threads};
  for (const auto& [name, setting] : sought) {
    if (!setting->span) continue;
    point.held.emplace(name, 0.5 * (setting->span->first + setting->span->second));
  }
  return point;
}

}  // namespace

Times step_times(std::vector<EffectSetting>& settings, const std::vector<Effect>& effects) {
  Times times;
  for (EffectSetting& setting : settings) {
    const auto effect = std::ranges::find(effects, setting.name, &Effect::name);
    if (effect != effects.end() && is_step(*effect)) times[setting.name + ".t0"] = &setting;
  }
  return times;
}

Fit fit_with_steps(const BlockModel& model, const BlockModel& plain,
                   const std::vector<Effect>& effects, std::vector<EffectSetting>& settings,
                   const Record& record, FitOptions options) {
  constexpr int most_rounds = 5;
  Times sought;
  for (const auto& [name, setting] : step_times(settings, effects)) {
    const auto held = options.fix.find(name);
    if (held != options.fix.end()) setting->t0 = held->second;
    if (setting->t0) {
      options.fix[name] = *setting->t0;
    } else {
      sought[name] = setting;
    }
  }
  if (sought.empty()) return fit(model, record, options);

  std::vector<Effect> others;
  std::ranges::copy_if(effects, std::back_inserter(others),
                       [&](const Effect& effect) { return !sought.contains(effect.name + ".t0"); });
  const std::shared_ptr<const BlockModel> host(std::shared_ptr<const BlockModel>(), &plain);
  const Record rows = record.select(options.stage_two_segments);
  Fit fitted = fit(*compose(host, others, record), record, without_sought(options, sought));
  for (int round = 0; round < most_rounds; ++round) {
    bool moved = false;
    for (const auto& [name, setting] : sought) {
      const auto bounds = options.bounds.find(name);
      const double t0 = scan_step(model, rows, point_of(fitted, options, sought), name,
                                  bounds == options.bounds.end() ? Interval{} : bounds->second);
      moved = moved || setting->t0 != t0;
      setting->t0 = t0;
      options.fix[name] = t0;
    }
    if (!moved) break;
    fitted = fit(model, record, options);
  }
  return fitted;
}

}  // namespace sepcal::estimation
