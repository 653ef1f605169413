// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/rigid_aircraft.hpp"

#include <algorithm>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {

AeroTerms compile_equations(const std::vector<AeroEquation>& equations) {
  check_equations(equations);
  AeroTerms aero;
  const auto place = [&](const std::string& name) {
    const auto known = std::ranges::find(AeroTerms::variables, name);
    if (known != AeroTerms::variables.end()) {
      return static_cast<std::size_t>(known - AeroTerms::variables.begin());
    }
    auto column = std::ranges::find(aero.columns, name);
    if (column == aero.columns.end()) column = aero.columns.insert(column, name);
    return AeroTerms::variables.size() + static_cast<std::size_t>(column - aero.columns.begin());
  };
  for (const AeroEquation& equation : equations) {
    for (const std::string& text : equation.regressors) {
      const Regressor regressor(text);
      AeroTerms::Term term{find_coefficient(equation.coefficient), {}};
      for (const ChannelFactor& factor : regressor.factors()) {
        term.factors.push_back({place(factor.channel), factor.power, factor.absolute});
      }
      aero.terms.push_back(std::move(term));
      aero.parameters.emplace_back(parameter_name(equation.coefficient, text),
                                   parameter_unit(regressor));
    }
  }
  return aero;
}

namespace {

/// Terms of one aircraft beside those of another; columns are counted off anew.
void append(const AeroTerms& more, AeroTerms& aero) {
  constexpr std::size_t n = AeroTerms::variables.size();
  const auto move = [&](std::size_t& variable) {
    if (variable < n) return;
    const std::string& name = more.columns[variable - n];
    auto column = std::ranges::find(aero.columns, name);
    if (column == aero.columns.end()) column = aero.columns.insert(column, name);
    variable = n + static_cast<std::size_t>(column - aero.columns.begin());
  };
  for (AeroTerms::Term term : more.terms) {
    for (AeroTerms::Factor& factor : term.factors) move(factor.variable);
    if (term.spline) move(term.spline->variable);
    aero.terms.push_back(std::move(term));
  }
  aero.parameters.insert(aero.parameters.end(), more.parameters.begin(), more.parameters.end());
}

template <int Capacity>
const TrajectoryModel<RigidAircraft<Capacity>>* as_aircraft(const BlockModel& model) {
  return dynamic_cast<const TrajectoryModel<RigidAircraft<Capacity>>*>(&model);
}

template <int Capacity>
std::shared_ptr<const BlockModel> rebuilt(const AircraftGeometry& geometry, AeroTerms aero,
                                          double gravity, const TrajectoryOptions& options,
                                          const Record& record) {
  return std::make_shared<const TrajectoryModel<RigidAircraft<Capacity>>>(
      RigidAircraft<Capacity>{geometry, std::move(aero), gravity}, record, options);
}

template <int Capacity>
std::shared_ptr<const BlockModel> rebuild(const RigidAircraft<Capacity>& aircraft,
                                          const AeroTerms& more, const TrajectoryOptions& options,
                                          const Record& record) {
  AeroTerms aero = aircraft.aero;
  append(more, aero);
  check_room(aero);
  if (aero.terms.size() <= 16) {
    return rebuilt<16>(aircraft.geometry, std::move(aero), aircraft.gravity, options, record);
  }
  if (aero.terms.size() <= 24) {
    return rebuilt<24>(aircraft.geometry, std::move(aero), aircraft.gravity, options, record);
  }
  return rebuilt<40>(aircraft.geometry, std::move(aero), aircraft.gravity, options, record);
}

}  // namespace

void check_room(const AeroTerms& aero) {
  if (aero.columns.size() > RigidAircraft<40>::n_columns) {
    throw Error("the equations have " + std::to_string(aero.columns.size()) +
                " columns among their regressors; 8 is the most");
  }
  if (aero.terms.size() > 40) {
    throw Error("the equations have " + std::to_string(aero.terms.size()) +
                " regressors; 40 is the most: fit longitudinal and lateral apart");
  }
}

namespace {

/// `more(aero)`: the terms that join those of the aircraft.
template <class More>
std::shared_ptr<const BlockModel> with_terms(const BlockModel& model, const Record& record,
                                             const More& more) {
  const auto along = [&](const auto* trajectory) {
    const AeroTerms terms = more(trajectory->state_model().aero);
    for (const std::string& column : terms.columns) {
      if (!record.has(column)) throw Error("the record has no column '" + column + "'");
    }
    return rebuild(trajectory->state_model(), terms, trajectory->plan().options(), record);
  };
  if (const auto* small = as_aircraft<16>(model)) return along(small);
  if (const auto* middle = as_aircraft<24>(model)) return along(middle);
  if (const auto* large = as_aircraft<40>(model)) return along(large);
  throw Error("only an aircraft that is integrated has regressors");
}

bool has_line(const AeroTerms& aero, const AeroTerms::Term& line) {
  return std::ranges::any_of(aero.terms, [&](const AeroTerms::Term& term) {
    return term.coefficient == line.coefficient && term.factors.size() == 1 && !term.spline &&
           term.factors.front().variable == line.factors.front().variable &&
           term.factors.front().power == 1 && !term.factors.front().absolute;
  });
}

}  // namespace

std::shared_ptr<const BlockModel> with_regressor(const BlockModel& model,
                                                 const std::string& coefficient,
                                                 const std::string& regressor,
                                                 const Record& record) {
  return with_terms(model, record, [&](const AeroTerms& /*aero*/) {
    return compile_equations({{coefficient, {regressor}}});
  });
}

std::shared_ptr<const BlockModel> with_spline(const BlockModel& model,
                                              const std::string& coefficient,
                                              const std::string& variable,
                                              const std::vector<double>& knots,
                                              const Record& record) {
  const auto basis = std::make_shared<const SplineBasis>(knots);
  const std::string owner =
      coefficient + "[spline(" + variable + "," + std::to_string(knots.size()) + ")].s_";
  return with_terms(model, record, [&](const AeroTerms& aero) {
    AeroTerms terms = compile_equations({{coefficient, {variable}}});
    const AeroTerms::Term line = terms.terms.front();
    AeroTerms known = aero;  // in whose columns the line is told
    append(terms, known);
    const bool spline_has_line = has_line(aero, known.terms.back());
    terms.terms.clear();
    terms.parameters.clear();
    for (int j = 0; j < basis->functions() - (spline_has_line ? 1 : 0); ++j) {
      terms.terms.push_back({line.coefficient, {}, {{line.factors.front().variable, basis, j}}});
      terms.parameters.emplace_back(owner + std::to_string(j + 2), "1");
    }
    return terms;
  });
}

template class TrajectoryModel<RigidAircraft<16>>;
template class TrajectoryModel<RigidAircraft<24>>;
template class TrajectoryModel<RigidAircraft<40>>;

}  // namespace sepcal
