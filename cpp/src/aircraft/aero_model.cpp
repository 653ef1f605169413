// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/aero_model.hpp"

#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

Tables aero_tables(const std::vector<AeroEquation>& equations) {
  check_equations(equations);
  Tables tables;
  for (const std::string& variable : variables_of(equations)) {
    tables.inputs.emplace_back(variable, "");
  }
  for (const AeroEquation& equation : equations) {
    tables.outputs.emplace_back(equation.coefficient, "1");
    for (const std::string& regressor : equation.regressors) {
      tables.linear.emplace_back(parameter_name(equation.coefficient, regressor),
                                 parameter_unit(Regressor(regressor)));
    }
  }
  return tables;
}

void check_columns(const AeroCoefficients& coefficients,
                   const std::vector<AeroEquation>& equations) {
  for (const AeroEquation& equation : equations) {
    if (!base::is_among(coefficients.names, equation.coefficient)) {
      throw Error(equation.coefficient + " wasn't computed; the coefficients are " +
                  base::list_names(coefficients.names));
    }
    for (const std::string& variable : variables_of({equation})) {
      if (coefficients.record.has(variable)) continue;
      throw Error(equation.coefficient + " has the regressor '" + variable +
                  "', which is no column with a number in every row; add or mend it, or give "
                  "equations without it. There are " +
                  base::list_names(coefficients.record.names()));
    }
  }
}

}  // namespace

AeroModel::AeroModel(const std::vector<AeroEquation>& equations)
    : BlockModel(aero_tables(equations)) {
  for (std::size_t j = 0; j < equations.size(); ++j) {
    for (const std::string& text : equations[j].regressors) {
      const Regressor regressor(text);
      Term term{static_cast<int>(j), {}};
      for (const ChannelFactor& factor : regressor.factors()) {
        const auto at = std::ranges::find(tables().inputs, factor.channel, &Variable::name);
        term.factors.push_back({static_cast<std::size_t>(at - tables().inputs.begin()),
                                factor.power, factor.absolute});
      }
      terms_.push_back(std::move(term));
    }
  }
}

void AeroModel::evaluate(const Block& block, const double* /*xi2*/, const double* /*xi1*/,
                         Carry* /*carry*/, Eigen::Ref<Eigen::MatrixXd> rows) const {
  rows.setZero();
  const auto n = static_cast<Eigen::Index>(block.rows);
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    auto column = rows.col(static_cast<Eigen::Index>(k)).segment(terms_[k].output * n, n).array();
    column.setOnes();
    for (const Factor& factor : terms_[k].factors) {
      const Eigen::Map<const Eigen::ArrayXd> values(block.inputs[factor.input], n);
      for (int i = 0; i < factor.power; ++i) {
        column *= factor.absolute ? Eigen::ArrayXd(values.abs()) : Eigen::ArrayXd(values);
      }
    }
  }
}

AeroFit fit_equation_error(const AeroCoefficients& coefficients,
                           std::vector<AeroEquation> equations, const FitOptions& options) {
  if (equations.empty()) equations = standard_equations(coefficients.names);
  check_equations(equations);
  check_columns(coefficients, equations);
  return {fit(AeroModel(equations), coefficients.record, options), std::move(equations),
          coefficients.notes, std::string(regressor_warning)};
}

}  // namespace sepcal
