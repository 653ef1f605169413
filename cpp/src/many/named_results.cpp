// SPDX-License-Identifier: BSD-3-Clause
#include "many/named_results.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sepcal::many {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Parameter to_parameter(const Variable& variable, double value, bool at_bound) {
  Parameter parameter{.name = variable.name, .unit = variable.unit};
  parameter.value = value;
  parameter.lower = variable.lower;
  parameter.upper = variable.upper;
  parameter.at_bound = at_bound;
  parameter.standard_error = parameter.standard_error_white = not_a_number;
  return parameter;
}

void set_errors(std::vector<Parameter>& parameters, const std::vector<Index>& places,
                const MatrixXd& coloured, const MatrixXd& white) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto at = static_cast<Index>(k);
    Parameter& parameter = parameters[static_cast<std::size_t>(places[k])];
    parameter.standard_error = parameter.standard_error_noise_model = std::sqrt(coloured(at, at));
    parameter.standard_error_white = std::sqrt(white(at, at));
  }
}

SharedParameters list_shared(const BlockModel& model, const estimation::Problem& problem,
                             const Split& parting, const VectorXd& x,
                             const std::vector<bool>& at_bound) {
  SharedParameters shared;
  for (const Variable& variable : model.tables().parameters()) {
    const auto fixed = problem.options().fix.find(variable.name);
    if (fixed != problem.options().fix.end()) {
      Parameter parameter = to_parameter(variable, fixed->second, false);
      parameter.fixed = true;
      parameter.lower = parameter.upper = fixed->second;
      shared.parameters.push_back(std::move(parameter));
      continue;
    }
    const std::vector<Variable>& free = problem.parameters();
    const auto k =
        static_cast<Index>(std::ranges::find(free, variable.name, &Variable::name) - free.begin());
    const auto at = std::ranges::find(parting.shared, k);
    if (at == parting.shared.end()) continue;
    const Index place = at - parting.shared.begin();
    shared.places.push_back(static_cast<Index>(shared.parameters.size()));
    shared.parameters.push_back(to_parameter(free[static_cast<std::size_t>(k)], x[place],
                                             at_bound[static_cast<std::size_t>(place)]));
  }
  return shared;
}

Departure named(Departure departure, const std::vector<std::string>& names,
                const std::vector<Index>& places) {
  const auto among_all = [&](const VectorXd& values) {
    VectorXd all = VectorXd::Constant(static_cast<Index>(names.size()), not_a_number);
    all(places) = values;
    return all;
  };
  departure.names = names;
  departure.difference = among_all(departure.difference);
  departure.standard_error = among_all(departure.standard_error);
  return departure;
}

}  // namespace sepcal::many
