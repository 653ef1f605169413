// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/worst_windows.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_windows = 20;
constexpr std::size_t rows_of_shortest_window = 5;
constexpr std::size_t shown = 5;

/// One over each output's noise.
VectorXd weights(const std::vector<Misfit>& overall, const std::vector<OutputValue>& noise) {
  VectorXd result(static_cast<Index>(overall.size()));
  for (std::size_t j = 0; j < overall.size(); ++j) {
    const auto known = std::ranges::find(noise, overall[j].output, &OutputValue::name);
    const double scale = known == noise.end() ? overall[j].rmse : known->value;
    result[static_cast<Index>(j)] = scale > 0.0 && std::isfinite(1.0 / scale) ? 1.0 / scale : 1.0;
  }
  return result;
}

}  // namespace

std::vector<Window> find_worst_windows(const std::vector<double>& time, const MatrixXd& residuals,
                                       const std::vector<Misfit>& overall,
                                       const std::vector<OutputValue>& noise) {
  struct Rated {
    double badness;  // mean square over outputs and rows, in units of noise
    Window window;
  };
  const VectorXd weight = weights(overall, noise);
  const std::size_t rows = time.size();
  const std::size_t count =
      std::clamp<std::size_t>(rows / rows_of_shortest_window, 1, most_windows);
  std::vector<Rated> rated;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = rows * i / count;
    const std::size_t last = rows * (i + 1) / count;
    const auto part =
        residuals.middleRows(static_cast<Index>(first), static_cast<Index>(last - first));
    const auto is_there = !part.array().isNaN();
    const MatrixXd known = is_there.select(part, 0.0);
    Rated next{(known * weight.asDiagonal()).squaredNorm() / static_cast<double>(is_there.count()),
               {.first_s = time[first], .last_s = time[last - 1], .rows = last - first}};
    for (std::size_t j = 0; j < overall.size(); ++j) {
      const auto column = static_cast<Index>(j);
      const auto r = known.col(column);
      const auto readings = static_cast<double>(is_there.col(column).count());
      next.window.rmse.push_back({overall[j].output, std::sqrt(r.squaredNorm() / readings)});
      next.window.mean.push_back({overall[j].output, r.sum() / readings});
    }
    rated.push_back(std::move(next));
  }
  std::ranges::stable_sort(rated, std::ranges::greater{}, &Rated::badness);
  std::vector<Window> worst;
  for (std::size_t i = 0; i < std::min(shown, count); ++i) worst.push_back(rated[i].window);
  return worst;
}

}  // namespace sepcal::verbs
