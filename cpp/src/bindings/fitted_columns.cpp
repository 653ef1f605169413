// SPDX-License-Identifier: BSD-3-Clause
#include "fitted_columns.hpp"

#include <utility>

#include "flight/verbs/held_options.hpp"
#include "sepcal/composition.hpp"

namespace sepcal::bindings {

FittedColumns bring_to_fit(const Model& model, Record record, const CalibrationOptions& options,
                           std::vector<EffectSetting> settings, const Fit& fit) {
  for (EffectSetting& setting : settings) setting.known = true;
  const CalibrationOptions held = verbs::hold(model.held, model.block->tables(), options);
  FittedColumns result{model.probe, model.block, std::move(record), held.fit};
  EffectKit kit = model.kit();
  for (const auto& [name, maker] : options.own_effects) kit.own[name] = maker;
  if (result.probe) {
    std::shared_ptr<const Probe> told = result.probe->with_noise(fit.noise.front().value);
    if (told) {
      result.probe = std::move(told);
      result.model = {result.probe, &result.probe->model()};
    }
  }
  const std::vector<Effect> effects = make_effects(kit, *result.model, settings, result.record);
  result.model = compose(result.model, effects, result.record);
  result.record = without_edges(std::move(result.record), reach(effects, options.fit.bounds));
  result.options.unsampled.merge(initial_corrections(effects));
  return result;
}

}  // namespace sepcal::bindings
