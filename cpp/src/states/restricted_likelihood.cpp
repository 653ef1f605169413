// SPDX-License-Identifier: BSD-3-Clause
#include "states/restricted_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace sepcal::states {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double least_known = 0.25;  // a standard error, of the size that it is of

struct Process {
  std::string name;  // of the model's table `noise`
  double size = 0.0;
  double least = 0.0;
};

/// Process noises that a fit estimated; where none showed, as large as the whole residual would
/// make them: their floors are a thousandth of it.
std::vector<Process> estimated_in(const Fit& fit, const BlockModel& model,
                                  const FitOptions& options) {
  constexpr double floors = 1e3;
  std::vector<Process> processes;
  const std::span<const Variable> noises = model.process_noises();
  for (std::size_t k = 0; k < noises.size(); ++k) {
    const NoiseSize& found = fit.noise_sizes[k];
    if (options.process_noise.contains(noises[k].name) || !(found.value > 0.0)) continue;
    const double unit = found.at_floor ? floors * found.value : found.value;
    processes.push_back({noises[k].name, unit, unit / floors});
  }
  return processes;
}

/// Of a fit with the process noise held.
double restricted_likelihood(const Fit& fit) {
  std::vector<Index> free;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const auto place = static_cast<Index>(k);
    if (fit.covariance_white(place, place) > 0.0) free.push_back(place);
  }
  const Eigen::LDLT<MatrixXd> ldlt(fit.covariance_white(free, free));
  const double log_det = ldlt.vectorD().array().abs().log().sum();
  const double value = fit.log_likelihood + 0.5 * log_det;
  return std::isfinite(value) ? value : -std::numeric_limits<double>::infinity();
}

}  // namespace

bool tells_process_noises(const Fit& fit) {
  const std::size_t outputs = fit.noise.size();
  return std::all_of(fit.noise_sizes.begin(), fit.noise_sizes.end() - static_cast<Index>(outputs),
                     [](const NoiseSize& size) {
                       return !size.at_floor && !(size.standard_error > least_known * size.value);
                     });
}

Fit fit_restricted(const BlockModel& model, const Record& record, FitOptions options,
                   const Fit& fit) {
  std::vector<Process> processes = estimated_in(fit, model, options);
  if (processes.empty()) return fit;
  for (const Variable& parameter : model.tables().nonlinear) {
    if (!fit[parameter.name].fixed) options.start[parameter.name] = fit[parameter.name].value;
  }
  const auto fit_at = [&] {
    for (const Process& process : processes) options.process_noise[process.name] = process.size;
    return sepcal::fit(model, record, options);
  };
  Fit best = fit_at();
  double highest = restricted_likelihood(best);
  // Each in turn, up and down by a factor, which shrinks where neither helps.
  double factor = 4.0;
  while (factor > 1.15) {
    for (bool moved = true; moved;) {
      moved = false;
      for (Process& process : processes) {
        const double size = process.size;
        for (const double trial : {size * factor, std::max(process.least, size / factor)}) {
          process.size = trial;
          Fit there = fit_at();
          const double here = restricted_likelihood(there);
          if (here > highest) {
            highest = here;
            best = std::move(there);
            moved = true;
            break;
          }
          process.size = size;
        }
      }
    }
    factor = std::sqrt(factor);
  }
  return best;
}

}  // namespace sepcal::states
