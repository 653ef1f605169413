// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/finding.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/structure.hpp"

namespace sepcal {

using namespace diagnosis;  // this room's own

using Eigen::Index;

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return "adequate";
    case Verdict::effect_missing:
      return "effect_missing";
    case Verdict::slow_change:
      return "slow_change";
    default:
      return "unexplained";
  }
}

std::string_view to_string(FindingStatus status) {
  switch (status) {
    case FindingStatus::found:
      return "found";
    case FindingStatus::slow_change:
      return "slow_change";
    case FindingStatus::undecided:
      return "undecided";
    case FindingStatus::not_seen:
      return "not_seen";
    default:
      return "cannot_be_seen";
  }
}

std::string_view to_string(UnmeasuredKind kind) {
  return kind == UnmeasuredKind::common_cause ? "common_cause" : "spectral_line";
}

std::string_view to_string(Beside beside) {
  switch (beside) {
    case Beside::equivalent:
      return "equivalent";
    case Beside::fades:
      return "fades";
    case Beside::counts:
      return "counts";
    default:
      return "untried";
  }
}

DiagnosisWork& DiagnosisWork::operator+=(const DiagnosisWork& other) {
  screened += other.screened;
  tested += other.tested;
  calibrated += other.calibrated;
  drawn += other.drawn;
  refitted += other.refitted;
  tried_on_some_rows += other.tried_on_some_rows;
  return *this;
}

std::vector<std::string> list_beside(const Diagnosis& diagnosis, Beside beside) {
  std::vector<std::string> names;
  for (const EffectFinding& effect : diagnosis.effects) {
    if (effect.beside == beside) names.push_back(effect.name);
  }
  return names;
}

EffectFinding diagnosis::describe(const CandidateRoom& room, const Trial& trial) {
  EffectFinding finding{.name = trial.candidate.name,
                        .drivers = trial.candidate.drivers,
                        .log10_p = trial.log10_p,
                        .p_value = std::pow(10.0, trial.log10_p),
                        .predicted_drop = not_a_number,
                        .held_out_before = not_a_number,
                        .held_out_after = not_a_number,
                        .held_out_gain = not_a_number,
                        .visibility = trial.visibility};
  finding.status = trial.visible ? FindingStatus::not_seen : FindingStatus::cannot_be_seen;
  for (std::size_t k = 0; k < trial.candidate.coefficients.size(); ++k) {
    const Variable& coefficient = trial.candidate.coefficients[k];
    const auto at = static_cast<Index>(k);
    const bool known = trial.visible && trial.estimate.size() > at;
    finding.coefficients.push_back({coefficient.name, coefficient.unit,
                                    known ? trial.estimate[at] : not_a_number,
                                    known ? std::sqrt(trial.covariance(at, at)) : not_a_number});
  }
  if (!trial.visible) return finding;
  for (const UsedOutput& output : room.fit().layout.outputs) finding.outputs.push_back(output.name);
  finding.predicted_drop = trial.predicted_drop;
  if (!trial.candidate.shape.parameter.empty()) {
    finding.shapes[trial.candidate.shape.parameter] = trial.shape;
  }
  tell_held_out(trial, finding);
  if (trial.tested) {
    for (Index k = 0; k < trial.absorbed.size(); ++k) {
      finding.absorbed_by[room.fit().parameters[static_cast<std::size_t>(k)]] = trial.absorbed[k];
    }
  }
  return finding;
}

void diagnosis::tell_held_out(const Trial& trial, EffectFinding& finding) {
  if (!trial.held_out.judged) return;
  finding.held_out_before = trial.held_out.before;
  finding.held_out_after = trial.held_out.after;
  finding.held_out_gain = trial.held_out.gain;
  finding.held_out_passed = trial.held_out.passed;
  finding.held_out_interleaved = trial.folds.interleaved;
  finding.held_out_refitted = trial.refitted;
}

double diagnosis::left_out(const EffectFinding& finding) {
  return std::isnan(finding.held_out_gain) ? 1.0 : 1.0 - finding.held_out_gain;
}

Structure diagnosis::structure_of(const NullHypothesis& null, const Trial& trial, PseBound bound) {
  if (!trial.visible) return {};
  const auto score = std::ranges::find_if(trial.scores, [&](const ShapeScore& at) {
    return at.shape == trial.shape || (std::isnan(at.shape) && std::isnan(trial.shape));
  });
  return measure_structure(null.fit(), null.residual, score->reduction, score->freedom, bound);
}

}  // namespace sepcal
