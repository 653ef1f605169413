// SPDX-License-Identifier: BSD-3-Clause
// Noises drawn without the library, and their statistics: what the noise model is judged by.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "sepcal/record.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

inline const std::vector<std::string> noise_kinds{"white", "AR(0.9)", "pink", "random walk",
                                                  "bursty"};

/// First-order noise of unit variance.
Eigen::VectorXd draw_autoregression(double correlation, Eigen::Index rows, Draws& draws);

/// `rows` of a noise whose innovations have a standard deviation near 1. Pink: first-order
/// processes whose time constants double sum to a spectrum 1/f. Bursty: white, a tenth of it four
/// times as loud.
Eigen::VectorXd draw_noise(const std::string& kind, Eigen::Index rows, Draws& draws);

std::span<const double> as_span(const Eigen::VectorXd& e);

/// Segments of the given lengths, `gap` rows between them that belong to none.
std::vector<Segment> make_segments(const std::vector<std::size_t>& lengths, std::size_t gap = 0);

/// Whether k events of probability p in n trials lie outside the central 99.9 %.
bool outside_binomial(int k, int n, double p);

}  // namespace sepcal::test
