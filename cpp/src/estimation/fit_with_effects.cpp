// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/fit_with_effects.hpp"

#include <utility>

#include "estimation/step_times.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/path_model.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

Fit fit_with_effects(const std::shared_ptr<const BlockModel>& model, const EffectKit& kit,
                     std::vector<EffectSetting>& settings, Record record,
                     const FitOptions& options) {
  const std::vector<Effect> effects = make_effects(kit, *model, settings, record);
  const auto composed = compose(model, effects, record);
  const bool goes_on = dynamic_cast<const PathModel*>(model.get()) != nullptr;
  if (!goes_on) record = without_edges(std::move(record), reach(effects, options.bounds));
  FitOptions with_effects = options;
  with_effects.unsampled.merge(initial_corrections(effects));
  return fit_with_steps(*composed, *model, effects, settings, record, std::move(with_effects));
}

}  // namespace sepcal
