// SPDX-License-Identifier: BSD-3-Clause
// Probabilities too small for a double, and what to do with many of them.
#pragma once

#include <vector>

namespace sepcal::numerics {

/// log10 of the probability that a gamma variable of that shape and unit scale exceeds x, to about
/// ten digits however small it is.
double log10_gamma_tail(double shape, double x);

/// log10 of the probability that chi-squared with `freedom` degrees exceeds x.
double log10_chi_squared_tail(double x, double freedom);

/// The continued fraction of the incomplete beta function without its leading factor, for x below
/// (a + 1) / (a + b + 2) (A&S 26.5.8, by Lentz).
double beta_fraction(double a, double b, double x);

/// log10 of the probability that Fisher's F with k and `freedom` degrees exceeds x, to about ten
/// digits however small it is.
double log10_f_tail(double x, double k, double freedom);

/// What chi-squared with `freedom` degrees exceeds with that probability, above 1e-300.
double chi_squared_point(double probability, double freedom);

/// Holm's step-down and Benjamini & Hochberg's step-up adjusted probabilities, in the order of the
/// logarithms (base 10) given, within [0, 1].
std::vector<double> adjust_by_holm(const std::vector<double>& log10_p);
std::vector<double> adjust_by_benjamini_hochberg(const std::vector<double>& log10_p);

}  // namespace sepcal::numerics
