// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/coefficient_diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "flight/aircraft/aircraft_effects.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/aircraft/aero_model.hpp"

namespace sepcal::aircraft_log {
namespace {

bool is_moment(const std::string& coefficient) {
  return coefficient == "Cl" || coefficient == "Cm" || coefficient == "Cn";
}

/// The rows from one on to the next that no differentiation takes a reading of both for.
std::size_t rows_apart(const LaidAircraft& laid) {
  if (std::isnan(laid.window)) return 1;
  const auto time = laid.record.column("time");
  std::vector<double> steps;
  for (const Segment& segment : laid.record.segments()) {
    for (std::size_t row = segment.first + 1; row < segment.last; ++row) {
      steps.push_back(time[row] - time[row - 1]);
    }
  }
  if (steps.empty()) return 1;
  constexpr double rounding = 1e-6;
  return 1 +
         static_cast<std::size_t>(laid.window / numerics::select_quantile(steps, 0.5) + rounding);
}

/// Every so many rows of each segment.
Record thin_out(const Record& record, std::size_t apart) {
  std::vector<std::size_t> kept;
  std::vector<Segment> segments;
  for (const Segment& segment : record.segments()) {
    const std::size_t first = kept.size();
    for (std::size_t row = segment.first; row < segment.last; row += apart) kept.push_back(row);
    segments.push_back({segment.label, first, kept.size()});
  }
  Record thin;
  for (const std::string& name : record.names()) {
    const auto column = record.column(name);
    std::vector<double> values;
    values.reserve(kept.size());
    for (const std::size_t row : kept) values.push_back(column[row]);
    thin.add(name, std::move(values));
  }
  thin.cut(std::move(segments));
  return thin;
}

bool belongs_to(const std::string& coefficient, const std::string& name) {
  return name.starts_with(coefficient + "_") || name.starts_with(coefficient + "[");
}

/// What of the fit is one coefficient's.
Fit fit_of(const Fit& whole, const std::string& coefficient) {
  Fit own;
  own.status = whole.status;
  own.message = whole.message;
  for (const Parameter& parameter : whole.parameters) {
    if (belongs_to(coefficient, parameter.name)) own.parameters.push_back(parameter);
  }
  own.n_1 = static_cast<int>(own.parameters.size());
  own.rows = whole.rows;
  return own;
}

/// One coefficient by itself.
DiagnosedFit diagnosed_coefficient(const DiagnosedFit& all, const AeroEquation& equation) {
  DiagnosedFit own = all;
  own.model = std::make_shared<AeroModel>(std::vector{equation});
  own.kit = coefficient_kit({equation});
  std::erase_if(own.effects, [&](const EffectSetting& effect) {
    return !belongs_to(equation.coefficient, effect.name);
  });
  own.fit = fit_of(all.fit, equation.coefficient);
  return own;
}

/// That what is found, and to be added, stands before the rest.
bool is_surer(const Diagnosis& one, const Diagnosis& other) {
  const auto place = [](const Diagnosis& found) {
    const bool advised = !found.advice.effect.empty();
    double doubt = 0.0;
    if (!found.effects.empty()) {
      const EffectFinding& first = found.effects.front();
      const bool by_f = found.rule == DiagnosisRule::partial_f;
      doubt = by_f ? -first.structure.partial_f : first.log10_p;
    }
    return std::tuple(found.verdict != Verdict::effect_missing, !advised, doubt);
  };
  return place(one) < place(other);
}

/// What of two verdicts speaks for both: a cause that can be added before one that can't.
Verdict worse(Verdict one, Verdict other) {
  constexpr std::array order{Verdict::effect_missing, Verdict::unexplained, Verdict::slow_change,
                             Verdict::adequate};
  return *std::ranges::find_if(order, [&](Verdict at) { return at == one || at == other; });
}

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// The diagnoses of coefficients as one; RMSE and floor over all of them.
Diagnosis join(std::vector<Diagnosis> parts) {
  std::ranges::stable_sort(parts, is_surer);
  Diagnosis all = parts.front();
  double square = 0.0;
  double floor = 0.0;
  for (const Diagnosis& part : parts) {
    square += part.rmse * part.rmse;
    floor += part.floor * part.floor;
    if (&part == &parts.front()) continue;
    all.verdict = worse(all.verdict, part.verdict);
    for (EffectFinding effect : part.effects) {
      effect.beside = Beside::untried;  // it was asked beside another first
      all.effects.push_back(std::move(effect));
    }
    append(all.residual, part.residual);
    append(all.unmeasured, part.unmeasured);
    append(all.limits, part.limits);
    append(all.error_budget, part.error_budget);
    append(all.advice.withheld, part.advice.withheld);
    all.correlation_time = std::max(all.correlation_time, part.correlation_time);
    all.work += part.work;
    if (part.omnibus.p_adjusted < all.omnibus.p_adjusted) all.omnibus = part.omnibus;
  }
  all.rmse = std::sqrt(square / static_cast<double>(parts.size()));
  all.floor = std::sqrt(floor / static_cast<double>(parts.size()));
  if (all.rule == DiagnosisRule::partial_f) {
    std::ranges::stable_sort(all.effects, [](const EffectFinding& a, const EffectFinding& b) {
      if (a.status != b.status) return a.status < b.status;
      return a.structure.partial_f > b.structure.partial_f;
    });
    return all;
  }
  // What is found stands as its coefficient has it; the rest by how sure it is.
  const auto rest = std::ranges::stable_partition(all.effects, [](const EffectFinding& effect) {
    return effect.status == FindingStatus::found;
  });
  std::ranges::stable_sort(rest, {}, [](const EffectFinding& effect) {
    const bool is_seen = effect.status < FindingStatus::not_seen;
    return std::pair(effect.status, is_seen ? -effect.held_out_gain : effect.log10_p);
  });
  return all;
}

}  // namespace

DiagnosedFit diagnosed_coefficients(const AircraftFit& fitted, const LaidAircraft& laid) {
  return {.model = std::make_shared<AeroModel>(laid.equations),
          .kit = coefficient_kit(laid.equations),
          .effects = splines_of(laid.effects),
          .record = laid.record,
          .rows = laid.record.select(fitted.options.calibration.fit.stage_two_segments).segments(),
          .fit = fitted.fit};
}

Diagnosis diagnose_coefficients(const AircraftFit& fitted, const Flight& flight, LaidAircraft& laid,
                                const DiagnosisOptions& options) {
  const DiagnosedFit all = diagnosed_coefficients(fitted, laid);
  DiagnosedFit thinned = all;
  std::vector<std::string> moments;
  for (const AeroEquation& equation : laid.equations) {
    if (is_moment(equation.coefficient)) moments.push_back(equation.coefficient);
  }
  const std::size_t apart = rows_apart(laid);
  if (apart > 1 && !moments.empty() && options.rule == DiagnosisRule::verdict) {
    Record rows = all.record;
    rows.cut(all.rows);
    thinned.record = thin_out(rows, apart);
    thinned.rows = thinned.record.segments();
    laid.notes.push_back(fmt::format(
        "{}: one row in {} is asked, as the rates' differentiation ties those between together",
        fmt::join(moments, ", "), apart));
  }
  for (const std::string& name : options.only)
    find_equation(name, laid.equations, AircraftModel::aero);
  const auto candidates_of = [&](const AeroEquation& equation) {
    if (options.only.empty()) return list_regressors({equation}, laid.record, flight);
    std::vector<std::string> own = options.only;
    std::erase_if(own, [&](const std::string& name) {
      return !belongs_to(equation.coefficient, name) || has_regressor(equation, name) ||
             std::ranges::find(all.effects, name, &EffectSetting::name) != all.effects.end();
    });
    return own;
  };
  const auto is_asked = [&](const AeroEquation& equation) {
    return options.only.empty() || std::ranges::any_of(options.only, [&](const std::string& name) {
             return belongs_to(equation.coefficient, name);
           });
  };
  std::size_t asked = 0;
  for (const AeroEquation& equation : laid.equations) asked += candidates_of(equation).size();
  std::vector<Diagnosis> parts;
  for (const AeroEquation& equation : laid.equations) {
    const std::vector<std::string> candidates = candidates_of(equation);
    if (!is_asked(equation)) continue;
    DiagnosisOptions own = options;
    own.others = asked - candidates.size();
    own.preferred = products_among(candidates);
    own.one_at_a_time = true;
    parts.push_back(
        diagnose(diagnosed_coefficient(is_moment(equation.coefficient) ? thinned : all, equation),
                 candidates, own));
  }
  return join(std::move(parts));
}

}  // namespace sepcal::aircraft_log
