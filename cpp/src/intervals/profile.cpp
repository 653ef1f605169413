// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/profile.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

#include "base/sentences.hpp"
#include "estimation/covariance.hpp"
#include "estimation/plausibility.hpp"
#include "intervals/filter_error_profile.hpp"
#include "intervals/profile_path.hpp"
#include "numerics/quantiles.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace intervals;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The fit's question once more: what the fit held stays held.
FitOptions as_fitted(FitOptions options, const Fit& fit) {
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.fixed) options.fix[parameter.name] = parameter.value;
  }
  // Jhat and J_p are of an R that has settled, however soon the fit stopped.
  options.noise_tolerance = std::min(options.noise_tolerance, FitOptions{}.noise_tolerance);
  options.noise_iterations = std::max(options.noise_iterations, FitOptions{}.noise_iterations);
  options.second_stage = fit.second_stage;
  // A loss has no likelihood: its scale stays that of the fit, and heights are those of its
  // sandwich.
  if (options.loss != Loss::squares && options.noise.empty()) {
    for (const OutputValue& output : fit.noise) options.noise[output.name] = output.value;
  }
  options.progress = {};
  return options;
}

/// The fit's estimates of the problem's free parameters. Throws Error where it has others.
VectorXd free_values(const estimation::Problem& problem, const Fit& fit) {
  VectorXd x(static_cast<Index>(problem.parameters().size()));
  Index k = 0;
  for (const Variable& parameter : problem.parameters()) x[k++] = fit[parameter.name].value;
  return x;
}

VectorXd noise_of(const estimation::Problem& problem, const Fit& fit) {
  const auto n_z = static_cast<Index>(fit.noise.size());
  if (n_z != problem.model().tables().n_z()) {
    throw Error("the fit has " + std::to_string(n_z) + " outputs and the model " +
                std::to_string(problem.model().tables().n_z()) + "; give the fit's own model");
  }
  VectorXd noise(n_z);
  for (Index j = 0; j < n_z; ++j) noise[j] = fit.noise[static_cast<std::size_t>(j)].value;
  return noise;
}

/// A converged fit whose estimates move by a standard error when it is repeated is another's.
void check_same(const estimation::Problem& problem, const Fit& fit, const VectorXd& x,
                const estimation::StageTwo& two) {
  if (fit.status != FitStatus::converged) return;
  for (Index k = 0; k < x.size(); ++k) {
    const Parameter& parameter = fit[problem.parameters()[static_cast<std::size_t>(k)].name];
    if (!(std::abs(two.x[k] - x[k]) > parameter.standard_error_white)) continue;
    std::ostringstream moved;
    moved << parameter.name << " goes from " << x[k] << " to " << two.x[k];
    throw Error("the estimates are no minimum here, " + moved.str() +
                "; give the model, the record and the options of the fit");
  }
}

/// How much more each of the free parameters varies than the cost's curvature says, as a ratio of
/// variances; of a parameter without a variance, the largest of the others' and 1.
VectorXd find_colours(const estimation::Problem& problem, const Fit& fit,
                      const VectorXd& curvature_errors) {
  VectorXd colours(static_cast<Index>(problem.parameters().size()));
  double largest = 1.0;
  for (Index k = 0; k < colours.size(); ++k) {
    const Parameter& parameter = fit[problem.parameters()[static_cast<std::size_t>(k)].name];
    const double ratio = parameter.standard_error / curvature_errors[k];
    colours[k] = ratio * ratio;
    if (std::isfinite(colours[k])) largest = std::max(largest, colours[k]);
  }
  return colours.unaryExpr([&](double c) { return std::isfinite(c) ? c : largest; });
}

/// Standard errors by the cost's curvature alone, of the free parameters; NaN where there is none.
/// Without a loss the white ones.
VectorXd find_curvature_errors(const estimation::Problem& problem,
                               const model::Measurements& measurements, const Fit& fit,
                               const estimation::StageTwo& two, base::ThreadPool& pool) {
  VectorXd errors = VectorXd::Constant(two.x.size(), not_a_number);
  if (problem.options().loss != Loss::squares) {
    const model::Sweep sweep(problem.model(), measurements, pool);
    const estimation::Covariances covariances =
        estimation::find_covariances(problem, sweep, {sweep}, two);
    errors(covariances.inside) = covariances.inverse_hessian.diagonal().cwiseSqrt();
    return errors;
  }
  for (Index k = 0; k < errors.size(); ++k) {
    errors[k] = fit[problem.parameters()[static_cast<std::size_t>(k)].name].standard_error_white;
  }
  return errors;
}

/// What all profiles of a fit share.
class Profiles {
 public:
  Profiles(const BlockModel& model, const model::Measurements& measurements,
           const estimation::Problem& problem, const Fit& fit, double level, base::ThreadPool& pool)
      : model_(model),
        measurements_(measurements),
        problem_(problem),
        fit_(fit),
        count_(static_cast<double>(measurements.rows()) *
               static_cast<double>(problem.model().tables().n_z())),
        noise_given_(problem.noise().size() > 0) {
    const VectorXd x = free_values(problem, fit);
    StageOne start;
    start.xi1 = x.head(problem.model().tables().n_1());
    start.xi2 = x.tail(problem.model().tables().n_2());
    start.noise = noise_of(problem, fit);
    const auto n = static_cast<double>(x.size());
    freedom_ = noise_given_ ? infinity : count_ - n;
    reach_ =
        noise_given_ ? numerics::normal_reach(level) : numerics::student_reach(level, freedom_);
    const estimation::Attempt attempt =
        estimation::from_neighbour(problem.options(), fit.second_stage, true);
    const auto found = find_minimum(problem, measurements, start, attempt, pool);
    if (!found) return;
    minimum_ = *found;
    converged_ = true;
    check_same(problem, fit, x, minimum_);
    scale_ = estimation::plausible_scale(problem.parameters(), minimum_.factors, measurements);
    factor_ = combine(minimum_.factors, minimum_.noise.cwiseInverse()).matrix();
    colours_ = find_colours(problem, fit,
                            find_curvature_errors(problem, measurements, fit, minimum_, pool));
  }

  ProfileInterval describe(Index k) const {
    const Parameter& parameter = parameter_of(k);
    ProfileInterval interval{
        .name = parameter.name, .unit = parameter.unit, .value = parameter.value};
    const double half = reach_ * parameter.standard_error;
    interval.gaussian = {parameter.value - half, parameter.value + half};
    return interval;
  }

  std::unique_ptr<ProfilePath> path(Index k, bool up) const {
    return std::make_unique<ProfilePath>(model_, problem_, measurements_, minimum_, k, up);
  }

  ProfileReach reach(Index k) const {
    const double square = colours_[k] * reach_ * reach_;
    const double q = noise_given_ ? square : count_ * std::log1p(square / freedom_);
    // Exact where the model is linear, white and has one output.
    const double inflation = noise_given_ ? 1.0 : count_ / freedom_;
    const double gaussian = std::sqrt(square * inflation) * standard_error(k);
    constexpr double far = 1e4;  // plausible lengths
    const double length = usable(scale_[k]) ? scale_[k] : std::max(1.0, std::abs(minimum_.x[k]));
    const double first = usable(gaussian) ? std::min(gaussian, length) : 1e-2 * length;
    return {.root = freedom_ > 0 ? std::sqrt(q) : infinity,
            .first = first,
            .limit = std::max(far * length, usable(gaussian) ? 4.0 * gaussian : 0.0)};
  }

  /// Whether there is a minimum to profile about; nothing below may be asked without it.
  bool converged() const { return converged_; }

 private:
  static bool usable(double length) { return std::isfinite(length) && length > 0; }

  const Parameter& parameter_of(Index k) const {
    return fit_[problem_.parameters()[static_cast<std::size_t>(k)].name];
  }

  /// White, of R-hat, the parameter's own bound taken away: 1 / |r_kk| with its column last.
  double standard_error(Index k) const {
    std::vector<Index> columns;
    for (Index i = 0; i < scale_.size(); ++i) {
      if (i != k && !minimum_.at_bound[static_cast<std::size_t>(i)]) columns.push_back(i);
    }
    columns.push_back(k);
    TriangularFactor factor(static_cast<int>(columns.size()));
    MatrixXd rows = factor_(Eigen::all, columns);
    factor.absorb(rows);
    return 1.0 / std::abs(factor.matrix().diagonal().tail<1>()[0]);
  }

  const BlockModel& model_;
  const model::Measurements& measurements_;
  const estimation::Problem& problem_;
  const Fit& fit_;
  estimation::StageTwo minimum_;
  MatrixXd factor_;  // whitened, [A | D | r]
  VectorXd scale_;   // plausible lengths
  VectorXd colours_;
  double count_;  // M
  double freedom_ = 0.0;
  double reach_ = 0.0;
  bool noise_given_;
  bool converged_ = false;
};

/// The places of the named parameters among the free ones.
std::vector<Index> find_places(const estimation::Problem& problem, const Fit& fit,
                               const std::vector<std::string>& names) {
  const std::vector<Variable>& free = problem.parameters();
  std::vector<Index> places;
  if (names.empty()) {
    for (std::size_t k = 0; k < free.size(); ++k) places.push_back(static_cast<Index>(k));
  }
  for (const std::string& name : names) {
    if (fit[name].fixed) {
      throw Error("'" + name + "' is fixed: it was not estimated and has no interval; free it");
    }
    const auto at = std::ranges::find(free, name, &Variable::name);
    places.push_back(at - free.begin());
  }
  return places;
}

/// A refit that came out lower than the fit: its estimates are another minimum's.
std::string tell_of_lower(const ProfilePath& lower, const ProfilePath& upper,
                          const ProfileInterval& interval, const Fit& fit) {
  // Where something is open, a loose prior keeps the fit a little above its minimum.
  const double least = fit.status == FitStatus::not_identifiable ? 0.1 : 1e-4;
  const ProfilePath& path = lower.deficit() > upper.deficit() ? lower : upper;
  if (path.deficit() <= least) return "";
  std::ostringstream message;
  message << "the fit is not the lowest minimum: with " << interval.name << " held at "
          << path.lowest_at() << " the cost is lower by " << path.deficit()
          << "; fit again with more samples, or start there";
  return message.str();
}

}  // namespace

std::string_view to_string(IntervalEnd end) {
  switch (end) {
    case IntervalEnd::crossed:
      return "crossed";
    case IntervalEnd::bound:
      return "bound";
    case IntervalEnd::open:
      return "open";
    default:
      return "failed";
  }
}

std::vector<ProfileInterval> profile_intervals(const BlockModel& model, const Record& record,
                                               const Fit& fit, const FitOptions& options,
                                               const ProfileOptions& asked) {
  if (fit.method == FitMethod::filter_error) {
    const Record fitted = record.select(options.stage_two_segments);
    return profile_filter_error(model, fitted, fit, as_fitted(options, fit), asked);
  }
  const estimation::Problem problem(model, as_fitted(options, fit));
  const std::vector<Index> places = find_places(problem, fit, asked.names);
  const Record second = record.select(options.stage_two_segments);
  const model::Measurements measurements(problem.model(), second);
  problem.check_measurements(measurements.rows());
  base::ThreadPool pool(options.threads);
  const Profiles profiles(model, measurements, problem, fit, asked.level, pool);

  std::vector<std::unique_ptr<ProfilePath>> paths(2 * places.size());
  std::vector<ProfilePath::End> ends(paths.size());
  std::mutex mutex;
  double done = 0.0;
  pool.for_each(paths.size(), [&](std::size_t i) {
    const Index k = places[i / 2];
    if (!profiles.converged()) return;
    paths[i] = profiles.path(k, i % 2 == 1);
    ends[i] = paths[i]->walk(profiles.reach(k));
    const std::lock_guard lock(mutex);
    if (asked.progress) asked.progress("profiling", ++done / static_cast<double>(paths.size()));
  });

  std::vector<ProfileInterval> intervals;
  for (std::size_t i = 0; i < places.size(); ++i) {
    ProfileInterval interval = profiles.describe(places[i]);
    const ProfilePath::End& lower = ends[2 * i];
    const ProfilePath::End& upper = ends[2 * i + 1];
    interval.profile = {lower.value, upper.value};
    interval.lower_end = lower.kind;
    interval.upper_end = upper.kind;
    interval.message =
        profiles.converged()
            ? base::join_sentences({lower.message, upper.message,
                                    tell_of_lower(*paths[2 * i], *paths[2 * i + 1], interval, fit)})
            : "the fit did not converge, so that there is no profile about it";
    intervals.push_back(std::move(interval));
  }
  return intervals;
}

}  // namespace sepcal
