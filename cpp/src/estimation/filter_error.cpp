// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/filter_error.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "base/name_list.hpp"
#include "base/sentences.hpp"
#include "base/short_number.hpp"
#include "estimation/block_errors.hpp"
#include "estimation/covariance.hpp"
#include "estimation/error_sentences.hpp"
#include "estimation/filter_error_start.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/plausibility.hpp"
#include "estimation/prior_checks.hpp"
#include "estimation/runaway.hpp"
#include "estimation/sampling.hpp"
#include "estimation/scoring.hpp"
#include "estimation/theta_layout.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The likelihood, where there is one.
std::unique_ptr<InnovationModel> checked(const BlockModel& model, const Record& record,
                                         const FitOptions& options) {
  if (options.loss != Loss::squares) {
    throw Error("filter error takes squares alone; leave the loss out, or fit by output error");
  }
  std::unique_ptr<InnovationModel> innovations = model.innovations(record);
  if (innovations == nullptr) {
    throw Error("filter error needs a model with a state; fit this one by output error");
  }
  if (model.process_noises().empty()) {
    throw Error(
        "filter error needs process noise, and the model's table `noise` is empty; name there what "
        "drives its states, or fit by output error");
  }
  return innovations;
}

/// One fit: theta's places, and what comes of them.
class FilterError {
 public:
  FilterError(const BlockModel& model, const Record& record, const FitOptions& options)
      : model_(model),
        record_(record),
        problem_(model, options),
        innovations_(checked(model, record, options)),
        layout_(model, problem_, *innovations_) {}

  Fit run() {
    const FilterErrorStart start = start_filter_error(model_, record_, problem_, *innovations_);
    layout_.hold_silent(start.theta);
    Scoring scoring{.model = *innovations_,
                    .free = free(),
                    .box = layout_.box(start.floor),
                    .prior = layout_.prior(),
                    .iterations = options().iterations};
    if (options().progress) {
      scoring.progress = [this](int iteration) {
        options().progress("filter error", 1.0 - std::exp(-0.1 * iteration));
      };
    }
    Scored at = minimise_by_scoring(scoring, start.theta);
    if (options().hessian == Hessian::observed) at = finish_by_newton(scoring, std::move(at));
    return describe(scoring, at, start);
  }

 private:
  const FitOptions& options() const { return problem_.options(); }
  Index n() const { return layout_.n(); }

  const std::vector<Index>& free() const { return layout_.free(); }

  /// Score rows by blocks that are longer than the innovations remember, for their errors.
  MatrixXd block_covariance(const Scored& at, const std::vector<Index>& inside,
                            const MatrixXd& R) const {
    const auto k = static_cast<Index>(inside.size());
    MatrixXd none = MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
    std::vector<Index> columns;
    for (const Index i : inside) columns.push_back(free()[static_cast<std::size_t>(i)]);
    columns.push_back(innovations_->size());
    const auto samples = static_cast<Index>(record_.rows());
    const double length = memory(at);
    const int blocks = std::isfinite(length) ? choose_blocks(samples, length) : 0;
    if (blocks == 0) return none;
    const std::vector<Index> cuts = cut_blocks(samples, blocks);
    std::vector<TriangularFactor> factors(static_cast<std::size_t>(blocks),
                                          TriangularFactor(static_cast<int>(k) + 1));
    const Index each = innovations_->rows_a_sample();
    std::size_t block = 0;
    Index sample = 0;
    innovations_->scores(at.theta, [&](std::size_t /*row*/, MatrixXd& rows) {
      const Index end = sample + rows.rows() / each;
      for (Index first = sample; first < end;) {
        while (cuts[block + 1] <= first) ++block;
        const Index last = std::min(end, cuts[block + 1]);
        MatrixXd chosen =
            rows.middleRows((first - sample) * each, (last - first) * each)(Eigen::all, columns);
        factors[block].absorb(chosen);
        first = last;
      }
      sample = end;
    });
    return find_block_errors(factors, R).covariance;
  }

  /// The rows of innovations that count as one.
  double memory(const Scored& at) const {
    const auto [e, sd] = innovations_->innovations(at.theta);
    Memory memory(e.cols());
    for (const Segment& segment : record_.segments()) {
      const auto first = static_cast<Index>(segment.first);
      const auto rows = static_cast<Index>(segment.rows());
      const MatrixXd w = e.middleRows(first, rows).cwiseQuotient(sd.middleRows(first, rows));
      memory.add(w.array().isNaN().select(0.0, w));
    }
    return memory.rows();
  }

  Fit describe(const Scoring& scoring, const Scored& at, const FilterErrorStart& start) const {
    Fit result;
    result.by = FitMethod::filter_error;
    if (start.output_error) {
      result.stage_one = start.output_error->stage_one;
      result.stage_two_passes = start.output_error->stage_two_passes;
    }
    std::vector<std::string> sentences;
    const Index k = layout_.free_parameters();
    const bool finite = std::isfinite(at.cost);

    std::vector<Index> inside;  // of the free ones
    for (std::size_t i = 0; i < free().size(); ++i) {
      if (finite && !at.at_bound[i]) inside.push_back(static_cast<Index>(i));
    }
    const MatrixXd R =
        at.factor.matrix().topLeftCorner(at.factor.columns() - 1, at.factor.columns() - 1);
    const MatrixXd own = select_columns(R, inside);
    result.identifiability = judge(at);
    MatrixXd white = covariance_of(own);
    if (options().hessian == Hessian::observed && white.allFinite()) {
      const Eigen::LLT<MatrixXd> root(MatrixXd(observed_hessian(scoring, at)(inside, inside)));
      if (root.info() == Eigen::Success) {
        white = root.solve(MatrixXd::Identity(white.rows(), white.cols()));
      } else {
        sentences.emplace_back(
            "the observed Hessian is not positive definite here, and Fisher's stands for it");
      }
    }
    const auto readings = static_cast<double>(at.readings);
    white *= readings / std::max(1.0, readings - static_cast<double>(inside.size()));
    MatrixXd blocks =
        MatrixXd::Constant(white.rows(), white.cols(), std::numeric_limits<double>::quiet_NaN());
    MatrixXd believed = white;
    if (options().coloured_errors && white.allFinite() && !inside.empty()) {
      blocks = block_covariance(at, inside, own);
      believed = believe(white, blocks);
    }
    fill(result, at, inside, k, {believed, white, blocks});
    fill_noise(result, at, inside, believed);

    VectorXd rmse(innovations_->outputs());
    if (finite) {
      const MatrixXd e = innovations_->innovations(at.theta).e;
      for (Index j = 0; j < rmse.size(); ++j) {
        const auto there = e.col(j).array().isFinite();
        rmse[j] = std::sqrt(there.select(e.col(j).array().square(), 0.0).sum() /
                            std::max<double>(1.0, static_cast<double>(there.count())));
      }
    } else {
      rmse.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    result.rmse = by_output(model_.tables(), rmse);
    result.noise = by_output(model_.tables(), at.theta.tail(innovations_->outputs()).array().exp());
    const double constant = 0.5 * readings * std::log(2.0 * std::numbers::pi);
    result.cost = at.cost;
    result.log_likelihood = -at.cost - constant;
    result.log_likelihood_without = -start.cost_without - constant;
    result.iterations = at.iterations;
    result.rows = record_.rows();

    if (!finite) {
      sentences.push_back("the filter can't go on from row " + std::to_string(at.row) +
                          " (counted from 0); narrow the bounds, or start nearer");
    } else if (!at.converged) {
      sentences.push_back("the likelihood's maximum was not reached within " +
                          std::to_string(options().iterations) + " steps of scoring");
    }
    sentences.push_back(result.identifiability.message());
    std::ranges::move(describe_floors(at), std::back_inserter(sentences));
    std::ranges::move(describe_noises(result), std::back_inserter(sentences));
    std::ranges::move(describe_blocks(inside, white, blocks), std::back_inserter(sentences));
    std::ranges::move(judge_priors(result.parameters, options()), std::back_inserter(sentences));
    result.message = base::join_sentences(sentences);
    result.status = !result.identifiability.unobservable.empty() ? FitStatus::not_identifiable
                    : finite && at.converged                     ? FitStatus::converged
                                                                 : FitStatus::not_converged;
    warn_of_coarse_steps(result, model_, record_);
    return result;
  }

  /// (R'R)^-1; NaN where R is singular.
  static MatrixXd covariance_of(const MatrixXd& R) {
    const Index k = R.cols();
    const bool regular = R.allFinite() && (R.diagonal().array().abs() > 0.0).all();
    if (!regular) return MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
    const MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(k, k));
    return inverse * inverse.transpose();
  }

  static MatrixXd believe(const MatrixXd& white, const MatrixXd& blocks) {
    VectorXd scale = VectorXd::Ones(white.rows());
    for (Index i = 0; i < scale.size(); ++i) {
      const double ratio = std::sqrt(blocks(i, i) / white(i, i));
      if (ratio > far_apart) scale[i] = ratio;
    }
    return scale.asDiagonal() * white * scale.asDiagonal();
  }

  /// Of the model's parameters, whatever the noises are: those are told by describe_noises().
  /// Noises at their floors take no part: nothing there depends on them.
  Identifiability judge(const Scored& at) const {
    if (!std::isfinite(at.cost)) return {};
    std::vector<Index> columns;  // the noises first, which the parameters' then stand beyond
    std::vector<Index> own;
    std::vector<std::string> names;
    std::vector<Variable> variables;
    std::vector<bool> at_bound;
    for (std::size_t i = 0; i < free().size(); ++i) {
      const Index place = free()[i];
      if (place >= n()) {
        if (!at.at_bound[i]) columns.push_back(static_cast<Index>(i));
        continue;
      }
      own.push_back(static_cast<Index>(i));
      names.push_back(layout_.name_of(place));
      at_bound.push_back(at.at_bound[i]);
      variables.push_back(problem_.parameters()[i]);
    }
    columns.insert(columns.end(), own.begin(), own.end());
    const Index n = at.factor.columns() - 1;
    MatrixXd rows = at.factor.matrix().topLeftCorner(n, n)(Eigen::all, columns);
    TriangularFactor all(static_cast<int>(columns.size()));
    all.absorb(rows);
    const auto count = static_cast<Index>(own.size());
    const MatrixXd beyond = all.matrix().bottomRightCorner(count, count);
    const VectorXd squares = beyond.colwise().squaredNorm();
    const VectorXd scale = plausible_scale(variables, squares, whitened_square(at));
    return judge_identifiability(beyond, names, scale, at_bound);
  }

  /// Sum of the readings' squares over the outputs' noise.
  double whitened_square(const Scored& at) const {
    double sum = 0.0;
    for (Index j = 0; j < innovations_->outputs(); ++j) {
      const auto values = record_.column(model_.tables().outputs[static_cast<std::size_t>(j)].name);
      const double r = std::exp(at.theta[n() + layout_.noises() + j]);
      for (const Segment& segment : record_.segments()) {
        for (std::size_t row = segment.first; row < segment.last; ++row) {
          if (std::isfinite(values[row])) sum += (values[row] / r) * (values[row] / r);
        }
      }
    }
    return sum;
  }

  struct Covariance {
    const MatrixXd& believed;
    const MatrixXd& white;
    const MatrixXd& blocks;
  };

  /// The model's parameters of what was estimated.
  void fill(Fit& result, const Scored& at, const std::vector<Index>& inside, Index k,
            const Covariance& covariance) const {
    std::vector<Index> own;  // places within `inside`
    std::vector<Index> places;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside[i] >= k) continue;
      own.push_back(static_cast<Index>(i));
      places.push_back(inside[i]);
    }
    const VectorXd x = at.theta(std::vector<Index>(free().begin(), free().begin() + k));
    const std::vector<bool> at_bound(at.at_bound.begin(), at.at_bound.begin() + k);
    const MatrixXd white = covariance.white(own, own);
    fill_parameters(result, model_, problem_,
                    {x, at_bound, places, covariance.believed(own, own), white, white,
                     covariance.blocks(own, own)});
  }

  void fill_noise(Fit& result, const Scored& at, const std::vector<Index>& inside,
                  const MatrixXd& covariance) const {
    for (Index k = n(); k < innovations_->size(); ++k) {
      NoiseSize size{.name = layout_.name_of(k),
                     .unit = layout_.noise(k - n()).unit,
                     .value = std::exp(at.theta[k])};
      size.standard_error = std::numeric_limits<double>::quiet_NaN();
      const auto place = std::ranges::find(free(), k);
      if (place != free().end()) {
        const Index i = place - free().begin();
        size.at_floor = at.at_bound.empty() ? false : at.at_bound[static_cast<std::size_t>(i)];
        const auto within = std::ranges::find(inside, i);
        if (within != inside.end()) {
          const Index row = within - inside.begin();
          size.standard_error = size.value * std::sqrt(covariance(row, row));
        }
      }
      result.noise_sizes.push_back(std::move(size));
    }
  }

  /// Whether every process noise is none, or at its floor.
  bool is_output_error(const Scored& at) const {
    for (Index k = n(); k < n() + layout_.noises(); ++k) {
      const auto place = std::ranges::find(free(), k) - free().begin();
      const bool estimated = place < std::ssize(free());
      const bool none = estimated ? static_cast<bool>(at.at_bound[static_cast<std::size_t>(place)])
                                  : at.theta[k] == -infinity;
      if (!none) return false;
    }
    return true;
  }

  std::vector<std::string> describe_floors(const Scored& at) const {
    std::vector<std::string> sentences;
    for (std::size_t i = 0; i < free().size(); ++i) {
      const Index k = free()[i] - n();
      if (k < 0 || !std::isfinite(at.cost) || !at.at_bound[i]) continue;
      const std::string value = base::short_number(std::exp(at.theta[free()[i]]));
      if (k < layout_.noises()) {
        sentences.push_back("the record shows no process noise '" + layout_.noise(k).name +
                            "': it ended at its floor" +
                            (is_output_error(at) ? ", where output error is the same" : ""));
      } else {
        sentences.push_back("r_" + layout_.noise(k).name + " ended at its floor (" + value + " " +
                            layout_.noise(k).unit +
                            "): process noise explains this output by itself; " +
                            "give its noise, or hold the process noise");
      }
    }
    return sentences;
  }

  /// Those that are all but none, or that others do for as well.
  static std::vector<std::string> describe_noises(const Fit& result) {
    std::vector<std::string> names;
    for (const NoiseSize& size : result.noise_sizes) {
      if (size.standard_error > size.value) names.push_back(size.name);
    }
    if (names.empty()) return {};
    return {base::list_names(names) + (names.size() == 1 ? " is" : " are") +
            " hardly told: the error is larger than the size"};
  }

  std::vector<std::string> describe_blocks(const std::vector<Index>& inside, const MatrixXd& white,
                                           const MatrixXd& blocks) const {
    double most = far_apart;
    std::string name;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const auto at = static_cast<Index>(i);
      const double ratio = std::sqrt(blocks(at, at) / white(at, at));
      if (!(ratio > most)) continue;
      most = ratio;
      name = layout_.name_of(free()[static_cast<std::size_t>(inside[i])]);
    }
    if (name.empty()) return {};
    return {"leaving out blocks of the record moves '" + name + "' " + base::short_number(most) +
            " times as far as its likelihood says: the larger error counts, and the noise or the "
            "model is another than was assumed"};
  }

  const BlockModel& model_;
  const Record& record_;
  Problem problem_;
  std::unique_ptr<InnovationModel> innovations_;
  ThetaLayout layout_;
};

}  // namespace

Fit fit_filter_error(const BlockModel& model, const Record& record, const FitOptions& given) {
  const Record fitted = record.select(given.stage_two_segments);
  FitOptions options = with_starting_values(model, record, given.stage_two_segments, given);
  options.stage_one_segments.clear();  // one record for all of it
  options.stage_two_segments.clear();
  return FilterError(model, fitted, options).run();
}

}  // namespace sepcal::estimation
