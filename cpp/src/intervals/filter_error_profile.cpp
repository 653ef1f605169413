// SPDX-License-Identifier: BSD-3-Clause
#include "intervals/filter_error_profile.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "estimation/scoring.hpp"
#include "estimation/theta_layout.hpp"
#include "numerics/quantiles.hpp"
#include "sepcal/error.hpp"

namespace sepcal::intervals {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Scored;
using estimation::Scoring;

class Profile {
 public:
  Profile(const BlockModel& model, const Record& record, const Fit& fit, const FitOptions& options)
      : fit_(fit),
        problem_(model, options),
        innovations_(model.innovations(record)),
        layout_(laid_out(model, fit)),
        box_(layout_.box(layout_.floor_of(fit))),
        minimum_(estimation::minimise_by_scoring(scoring(-1), estimation::theta_of(fit))) {
    for (const Index k : layout_.free()) {
      if (k >= layout_.n()) break;
      const Parameter& parameter = fit.parameters[static_cast<std::size_t>(k)];
      const double moved = std::abs(minimum_.theta[k] - parameter.value);
      if (fit.status == FitStatus::converged && moved > parameter.standard_error_white) {
        throw Error("the estimates are no minimum here, '" + parameter.name +
                    "' moves; give the model, the record and the options of the fit");
      }
    }
  }

  std::size_t place_of(const std::string& name) const {
    if (fit_[name].fixed) {
      throw Error("'" + name + "' is fixed: it was not estimated and has no interval; free it");
    }
    const auto at = std::ranges::find(fit_.parameters, name, &Parameter::name);
    return static_cast<std::size_t>(at - fit_.parameters.begin());
  }

  ProfileInterval find(std::size_t place, double level) const {
    const Parameter& parameter = fit_.parameters[place];
    const double z = numerics::normal_reach(level);
    const double half = z * parameter.standard_error;
    ProfileInterval interval{.name = parameter.name,
                             .unit = parameter.unit,
                             .value = parameter.value,
                             .gaussian = {parameter.value - half, parameter.value + half}};
    // Blocks that move it farther than the likelihood says stretch the profile too.
    const double colour = parameter.standard_error / parameter.standard_error_white;
    const double reach = z * (std::isfinite(colour) ? colour : 1.0);
    const auto k = static_cast<Index>(place);
    interval.lower_end = walk(k, -1.0, reach, interval.profile.lower);
    interval.upper_end = walk(k, 1.0, reach, interval.profile.upper);
    if (interval.lower_end == IntervalEnd::failed || interval.upper_end == IntervalEnd::failed) {
      interval.message = "with '" + parameter.name +
                         "' held away from its estimate the others "
                         "could not be fitted";
    }
    return interval;
  }

 private:
  estimation::ThetaLayout laid_out(const BlockModel& model, const Fit& fit) const {
    estimation::ThetaLayout layout(model, problem_, *innovations_);
    layout.hold_silent(estimation::theta_of(fit));
    return layout;
  }

  /// Of all that is free but `held`.
  Scoring scoring(Index held) const {
    Scoring scoring{.model = *innovations_,
                    .free = layout_.free(),
                    .box = box_,
                    .prior = layout_.prior(),
                    .iterations = problem_.options().iterations,
                    .promise = 1e-8};
    std::erase(scoring.free, held);
    return scoring;
  }

  /// The prior of what is held counts too.
  double whole(const Scored& at) const { return estimation::cost_with_prior(scoring(-1), at); }

  /// The signed root of twice the rise grows like the distance over the standard error: its secant
  /// finds where it is `reach`.
  IntervalEnd walk(Index k, double side, double reach, double& end) const {
    constexpr int most_trials = 25;
    constexpr double close = 1e-4;
    constexpr double far = 1e6;  // times the first step
    const double value = minimum_.theta[k];
    const double bound = side < 0 ? box_.lower[k] : box_.upper[k];
    const double white = fit_.parameters[static_cast<std::size_t>(k)].standard_error_white;
    const double first =
        reach *
        (std::isfinite(white) && white > 0.0 ? white : 0.1 * std::max(1.0, std::abs(value)));
    double inside = 0.0;  // distance and root within the interval
    double root_inside = 0.0;
    double outside = infinity;
    double root_outside = infinity;
    double distance = first;
    Scored from = minimum_;
    for (int trial = 0; trial < most_trials; ++trial) {
      const bool at_bound = distance >= std::abs(bound - value);
      if (at_bound) distance = std::abs(bound - value);
      VectorXd theta = from.theta;
      theta[k] = value + side * distance;
      Scored held = estimation::minimise_by_scoring(scoring(k), theta);
      if (!std::isfinite(held.cost) || !held.converged) {
        end = not_a_number;
        return IntervalEnd::failed;
      }
      const double root = std::sqrt(2.0 * std::max(0.0, whole(held) - whole(minimum_)));
      if (std::abs(root - reach) < close * reach) break;
      if (root < reach && at_bound) {
        end = bound;
        return IntervalEnd::bound;
      }
      if (root < reach) {
        inside = distance;
        root_inside = root;
        from = std::move(held);
      } else {
        outside = distance;
        root_outside = root;
      }
      if (std::isinf(outside)) {
        if (distance > far * first) {
          end = side * infinity;
          return IntervalEnd::open;
        }
        distance *= root > 0.3 * reach ? std::min(4.0, 1.05 * reach / root) : 4.0;
      } else {
        const double share = (reach - root_inside) / (root_outside - root_inside);
        distance = inside + std::clamp(share, 0.02, 0.98) * (outside - inside);
      }
    }
    end = value + side * distance;
    return IntervalEnd::crossed;
  }

  const Fit& fit_;
  estimation::Problem problem_;
  std::unique_ptr<InnovationModel> innovations_;
  estimation::ThetaLayout layout_;
  numerics::Box box_;
  Scored minimum_;
};

}  // namespace

std::vector<ProfileInterval> profile_filter_error(const BlockModel& model, const Record& record,
                                                  const Fit& fit, const FitOptions& options,
                                                  const ProfileOptions& asked) {
  const Profile profile(model, record, fit, options);
  std::vector<std::string> names = asked.names;
  for (const Parameter& parameter : fit.parameters) {
    if (asked.names.empty() && !parameter.fixed) names.push_back(parameter.name);
  }
  std::vector<ProfileInterval> intervals;
  for (const std::string& name : names) {
    intervals.push_back(profile.find(profile.place_of(name), asked.level));
    if (asked.progress) {
      asked.progress("profiling",
                     static_cast<double>(intervals.size()) / static_cast<double>(names.size()));
    }
  }
  return intervals;
}

}  // namespace sepcal::intervals
