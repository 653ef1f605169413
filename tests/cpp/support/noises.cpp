// SPDX-License-Identifier: BSD-3-Clause
#include "noises.hpp"

#include <cmath>

namespace sepcal::test {

Eigen::VectorXd draw_autoregression(double correlation, Eigen::Index rows, Draws& draws) {
  Eigen::VectorXd x(rows);
  double last = draws.normal();
  for (double& value : x) {
    value = last;
    last = correlation * last + std::sqrt(1.0 - correlation * correlation) * draws.normal();
  }
  return x;
}

Eigen::VectorXd draw_noise(const std::string& kind, Eigen::Index rows, Draws& draws) {
  Eigen::VectorXd e = Eigen::VectorXd::Zero(rows);
  if (kind == "AR(0.9)") return draw_autoregression(0.9, rows, draws);
  if (kind == "pink") {
    for (Eigen::Index k = 1; k <= 4 * rows; k *= 2) {
      e += draw_autoregression(std::exp(-2.0 / static_cast<double>(k)), rows, draws);
    }
    return e;
  }
  for (double& value : e) value = draws.normal();
  if (kind == "random walk") {
    for (Eigen::Index t = 1; t < rows; ++t) e[t] += e[t - 1];
  }
  if (kind == "bursty") {
    for (Eigen::Index t = 0; t < rows; ++t) {
      if (t % (rows / 4) < rows / 40) e[t] *= 4.0;
    }
  }
  return e;
}

std::span<const double> as_span(const Eigen::VectorXd& e) {
  return {e.data(), static_cast<std::size_t>(e.size())};
}

std::vector<Segment> make_segments(const std::vector<std::size_t>& lengths, std::size_t gap) {
  std::vector<Segment> segments;
  std::size_t first = gap;
  for (const std::size_t length : lengths) {
    segments.push_back({"", first, first + length});
    first += length + gap;
  }
  return segments;
}

bool outside_binomial(int k, int n, double p) {
  double term = std::pow(1.0 - p, n);  // of 0 events
  double below = 0.0;
  for (int i = 0; i < k; ++i) {
    below += term;
    term *= static_cast<double>(n - i) / (i + 1) * p / (1.0 - p);
  }
  return below + term < 0.0005 || 1.0 - below < 0.0005;
}

}  // namespace sepcal::test
