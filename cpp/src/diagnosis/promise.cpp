// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "diagnosis/advice.hpp"
#include "diagnosis/finding.hpp"
#include "diagnosis/trial.hpp"

namespace sepcal {

using namespace diagnosis;  // this room's own

namespace {

/// A trial of an effect at a shape; nothing of `added` is visible where the record can't tell it.
Trial trial_of(CandidateRoom& room, const std::string& effect,
               const std::map<std::string, double>& shapes) {
  Trial trial{.candidate = room.make(effect)};
  const auto shape = shapes.find(trial.candidate.shape.parameter);
  if (shape != shapes.end()) trial.shape = shape->second;
  trial.least_visibility = room.visible_from(trial.least_visibility);
  return trial;
}

}  // namespace

std::vector<double> predicted_drops(const DiagnosedFit& fitted,
                                    const std::vector<EffectFinding>& effects, int threads) {
  base::ThreadPool pool(threads);
  CandidateRoom room(fitted, pool);
  const NullHypothesis null = find_plain_null(room.fit());
  std::vector<double> drops;
  for (const EffectFinding& effect : effects) {
    if (effect.drop_is_fitted) {
      drops.push_back(effect.predicted_drop);
      continue;
    }
    const Trial trial = trial_of(room, effect.name, effect.shapes);
    const Projection added = project_trial(room, null, trial, trial.shape);
    drops.push_back(added.visible() == 0 ? not_a_number : predict_drop(null, added.basis));
  }
  return drops;
}

Promise promise(const DiagnosedFit& fitted, const std::string& effect,
                const std::map<std::string, double>& shapes, int threads) {
  base::ThreadPool pool(threads);
  CandidateRoom room(fitted, pool);
  const LinearisedFit& fit = room.fit();
  Promise promised;
  if (fit.layout.outputs.empty()) return promised;  // nothing is left to explain
  Trial trial = trial_of(room, effect, shapes);
  const NullHypothesis null = find_plain_null(fit);
  const Projection added = project_trial(room, null, trial, trial.shape);
  if (added.visible() == 0) {  // whatever it explained would be chance
    promised.against = "this flight can't tell it from what the model has";
    return promised;
  }
  estimate_plainly(fit.layout, added, fit.residual, trial);
  Refits refits(room);
  const Objection objection = find_objection(room, refits, describe(room, trial), visible_from);
  promised.against = objection.reason;
  promised.predicted_drop =
      std::isnan(objection.drop) ? predict_drop(null, added.basis) : objection.drop;
  hold_out(room, null, trial);
  confirm(refits, trial);
  if (!trial.held_out.judged) return promised;
  promised.held_out_before = trial.held_out.before;
  promised.held_out_after = trial.held_out.after;
  return promised;
}

}  // namespace sepcal
