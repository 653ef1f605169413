// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/scored_estimate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/name_list.hpp"
#include "base/short_number.hpp"
#include "estimation/block_errors.hpp"
#include "estimation/covariance.hpp"
#include "estimation/error_sentences.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/plausibility.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd believe(const MatrixXd& white, const MatrixXd& blocks) {
  VectorXd scale = VectorXd::Ones(white.rows());
  for (Index i = 0; i < scale.size(); ++i) {
    const double ratio = std::sqrt(blocks(i, i) / white(i, i));
    if (ratio > far_apart) scale[i] = ratio;
  }
  return scale.asDiagonal() * white * scale.asDiagonal();
}

std::vector<std::string> describe_blocks(const ScoredErrors& errors,
                                         const std::vector<Estimated>& estimated) {
  double most = far_apart;
  std::string name;
  for (std::size_t i = 0; i < errors.inside.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double ratio = std::sqrt(errors.blocks(at, at) / errors.white(at, at));
    if (!(ratio > most)) continue;
    most = ratio;
    name = estimated[static_cast<std::size_t>(errors.inside[i])].name;
  }
  if (name.empty()) return {};
  return {"leaving out blocks of the record moves '" + name + "' " + base::short_number(most) +
          " times as far as its likelihood says: the larger error counts, and the noise or the "
          "model is another than was assumed"};
}

}  // namespace

ScoredErrors find_scored_errors(const Scoring& scoring, const Scored& at,
                                const std::vector<Estimated>& estimated, const FitOptions& options,
                                const FindBlocks& find_blocks) {
  ScoredErrors errors;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    if (std::isfinite(at.cost) && !at.at_bound[i]) errors.inside.push_back(static_cast<Index>(i));
  }
  const Index all = at.factor.columns() - 1;
  const MatrixXd R =
      select_columns(MatrixXd(at.factor.matrix().topLeftCorner(all, all)), errors.inside);
  MatrixXd white = inverse_of_square(R);
  if (options.hessian == Hessian::observed && white.allFinite()) {
    const Eigen::LLT<MatrixXd> root(
        MatrixXd(observed_hessian(scoring, at)(errors.inside, errors.inside)));
    if (root.info() == Eigen::Success) {
      white = root.solve(MatrixXd::Identity(white.rows(), white.cols()));
    } else {
      errors.sentences.emplace_back(
          "the observed Hessian is not positive definite here, and Fisher's stands for it");
    }
  }
  const auto readings = static_cast<double>(at.readings);
  white *= readings / std::max(1.0, readings - static_cast<double>(errors.inside.size()));
  errors.white = errors.believed = white;
  errors.blocks =
      MatrixXd::Constant(white.rows(), white.cols(), std::numeric_limits<double>::quiet_NaN());
  if (options.coloured_errors && white.allFinite() && !errors.inside.empty()) {
    const std::vector<TriangularFactor> blocks = find_blocks(errors.inside);
    if (!blocks.empty()) errors.blocks = find_block_errors(blocks, R).covariance;
    errors.believed = believe(white, errors.blocks);
  }
  for (std::string& sentence : describe_blocks(errors, estimated)) {
    errors.sentences.push_back(std::move(sentence));
  }
  return errors;
}

Identifiability judge_scored(const Scored& at, const std::vector<Estimated>& estimated,
                             double whitened_square) {
  std::vector<Index> columns;  // the noises first, which the parameters' then stand beyond
  std::vector<Index> own;
  std::vector<std::string> names;
  std::vector<Variable> variables;
  std::vector<bool> at_bound;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    if (estimated[i].kind != Estimated::Kind::parameter) {
      if (!at.at_bound[i]) columns.push_back(static_cast<Index>(i));
      continue;
    }
    own.push_back(static_cast<Index>(i));
    names.push_back(estimated[i].name);
    at_bound.push_back(at.at_bound[i]);
    variables.push_back(estimated[i].variable);
  }
  columns.insert(columns.end(), own.begin(), own.end());
  const Index n = at.factor.columns() - 1;
  MatrixXd rows = at.factor.matrix().topLeftCorner(n, n)(Eigen::all, columns);
  TriangularFactor all(static_cast<int>(columns.size()));
  all.absorb(rows);
  const auto count = static_cast<Index>(own.size());
  const MatrixXd beyond = all.matrix().bottomRightCorner(count, count);
  const VectorXd squares = beyond.colwise().squaredNorm();
  const VectorXd scale = plausible_scale(variables, squares, whitened_square);
  return judge_identifiability(beyond, names, scale, at_bound);
}

NoiseSize size_of(const Scored& at, const Scoring& scoring, const std::vector<Estimated>& estimated,
                  const ScoredErrors& errors, Index i) {
  const Estimated& noise = estimated[static_cast<std::size_t>(i)];
  NoiseSize size{.name = noise.name,
                 .unit = noise.variable.unit,
                 .value = std::exp(at.theta[scoring.free[static_cast<std::size_t>(i)]])};
  size.standard_error = std::numeric_limits<double>::quiet_NaN();
  size.at_floor = at.at_bound.empty() ? false : at.at_bound[static_cast<std::size_t>(i)];
  const auto within = std::ranges::find(errors.inside, i);
  if (within != errors.inside.end()) {
    const Index row = within - errors.inside.begin();
    size.standard_error = size.value * std::sqrt(errors.believed(row, row));
  }
  return size;
}

std::string describe_stop(std::size_t row) {
  return "the filter can't go on from row " + std::to_string(row) +
         " (counted from 0); narrow the bounds, or start nearer";
}

std::string describe_no_maximum(const FitOptions& options) {
  return "the likelihood's maximum was not reached within " + std::to_string(options.iterations) +
         " steps of scoring";
}

std::vector<std::string> describe_floors(const Scored& at, const Scoring& scoring,
                                         const std::vector<Estimated>& estimated,
                                         const FitOptions& options) {
  bool is_output_error = std::ranges::none_of(options.process_noise,
                                              [](const auto& held) { return held.second > 0.0; });
  std::vector<std::string> states;
  std::vector<std::string> outputs;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    const Estimated& noise = estimated[i];
    if (noise.kind == Estimated::Kind::parameter || !std::isfinite(at.cost)) continue;
    if (!at.at_bound[i]) {
      is_output_error = is_output_error && noise.kind == Estimated::Kind::output_noise;
      continue;
    }
    if (noise.kind == Estimated::Kind::process_noise) {
      states.push_back("'" + noise.variable.name + "'");
    } else {
      const std::string value = base::short_number(std::exp(at.theta[scoring.free[i]]));
      outputs.push_back(noise.name + " (" + value + " " + noise.variable.unit + ")");
    }
  }
  std::vector<std::string> sentences;
  if (!states.empty()) {
    sentences.push_back("the record shows no process noise " + base::list_names(states) +
                        ", which ended at the floor" +
                        (is_output_error ? ", where output error is the same" : ""));
  }
  if (!outputs.empty()) {
    const bool one = outputs.size() == 1;
    sentences.push_back(base::list_names(outputs) + " ended at " + (one ? "its" : "their") +
                        " floor: process noise explains " +
                        (one ? "this output" : "these outputs") +
                        " by itself, or there is none in the readings; give " +
                        (one ? "its" : "their") + " noise, or hold the process noise");
  }
  return sentences;
}

std::vector<std::string> describe_noises(const std::vector<NoiseSize>& sizes) {
  std::vector<std::string> names;
  for (const NoiseSize& size : sizes) {
    if (size.standard_error > size.value) names.push_back(size.name);
  }
  if (names.empty()) return {};
  return {base::list_names(names) + (names.size() == 1 ? " is" : " are") +
          " hardly told: the error is larger than the size"};
}

}  // namespace sepcal::estimation
