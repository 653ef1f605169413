// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/rigid_aircraft.hpp"

#include <algorithm>

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

template class TrajectoryModel<RigidAircraft<16>>;
template class TrajectoryModel<RigidAircraft<24>>;
template class TrajectoryModel<RigidAircraft<40>>;

}  // namespace sepcal
