// SPDX-License-Identifier: BSD-3-Clause
// Equation error: coefficients that a flight had, on regressors that were measured. Linear in every
// parameter; one output a coefficient.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/aircraft/coefficients.hpp"
#include "sepcal/detail/aircraft/equations.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

/// Outputs are the equations' coefficients, inputs their variables, as columns of a record that
/// aero_coefficients() made.
class AeroModel final : public BlockModel {
 public:
  /// Throws Error as check_equations() does.
  explicit AeroModel(const std::vector<AeroEquation>& equations);

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

 private:
  struct Factor {
    std::size_t input;
    int power;
    bool absolute;
  };
  struct Term {
    int output;
    std::vector<Factor> factors;
  };

  std::vector<Term> terms_;  // one a linear parameter
};

/// What equation error and the two-step method must say of their intervals.
inline constexpr std::string_view regressor_warning =
    "errors of the regressors (alpha, beta, rates as measured) and of differentiation are not in "
    "these intervals: they bias the estimates, dampings most; compare with output error";

/// An aerodynamic model that was fitted.
struct AeroFit {
  Fit fit;
  std::vector<AeroEquation> equations;
  std::vector<std::string> notes;  // the rate reference first; see AeroCoefficients::notes
  std::string warning;             // what isn't in the intervals; empty where nothing is known
};

/// Fits the equations to coefficients; of none: standard_equations() of those that there are.
/// Throws Error for an equation of a coefficient that wasn't computed and for a variable that is no
/// column.
AeroFit fit_equation_error(const AeroCoefficients& coefficients,
                           std::vector<AeroEquation> equations = {},
                           const FitOptions& options = {});

}  // namespace sepcal
