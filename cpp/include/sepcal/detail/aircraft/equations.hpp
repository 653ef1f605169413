// SPDX-License-Identifier: BSD-3-Clause
// Aerodynamic coefficients as sums of regressors, C = sum of parameter x regressor: S 6.8 to 6.13
// without the terms that were misprinted, or regressors of one's own.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/channel_product.hpp"

namespace sepcal {

/// Forces forward, right and down, moments to the right wing, nose up and nose right.
inline constexpr std::array<std::string_view, 6> coefficient_names{"CX", "CY", "CZ",
                                                                   "Cl", "Cm", "Cn"};

/// The place of "CX" ... "Cn" among coefficient_names. Throws Error listing them.
std::size_t find_coefficient(std::string_view name);

/// A product of powers of variables: "1", "alpha", "alpha^2", "alpha*elevator", "beta*abs(beta)".
class Regressor {
 public:
  /// Throws Error, which says how to write it, for what is no such product.
  explicit Regressor(std::string text);

  const std::string& text() const { return text_; }
  const std::vector<ChannelFactor>& factors() const { return factors_; }  // none of "1"

 private:
  std::string text_;
  std::vector<ChannelFactor> factors_;
};

/// One coefficient and what it is a sum of.
struct AeroEquation {
  std::string coefficient;              // "Cm"
  std::vector<std::string> regressors;  // {"1", "alpha", "q_hat", "elevator"}
};

/// S 6.8 to 6.13 of these coefficients; of none: of all six. CX, CZ, Cm: 1, alpha (CX also
/// alpha^2), q_hat, elevator. CY, Cl, Cn: 1, beta, p_hat, r_hat, aileron, rudder. CX has no thrust
/// coefficient: the thrust is taken off, or inside where it isn't known.
std::vector<AeroEquation> standard_equations(const std::vector<std::string>& coefficients = {});

/// The equations given, and the standard ones of those of `coefficients` that they leave out: an
/// aircraft that is integrated needs all of its forces. Throws Error as standard_equations() does.
std::vector<AeroEquation> complete_equations(std::vector<AeroEquation> equations,
                                             const std::vector<std::string>& coefficients);

/// "Cm_0" of "1", "Cm_q" of "q_hat" (and p_hat, r_hat), else "Cm_" and the regressor.
std::string parameter_name(std::string_view coefficient, std::string_view regressor);

/// Of the parameter: 1 over the regressor's. Angles and surfaces are in rad, rates without
/// dimension; of what sepcal doesn't know, "1/throttle".
std::string parameter_unit(const Regressor& regressor);

/// Variables of all equations, each once, in order of appearance.
std::vector<std::string> variables_of(const std::vector<AeroEquation>& equations);

/// Throws Error for no equation at all, a coefficient that is unknown or stands twice, an equation
/// without regressors, and a regressor that stands twice or can't be read.
void check_equations(const std::vector<AeroEquation>& equations);

}  // namespace sepcal
