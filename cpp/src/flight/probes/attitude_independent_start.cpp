// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/attitude_independent_start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/excerpt.hpp"
#include "base/sentences.hpp"
#include "estimation/check_options.hpp"
#include "flight/probes/ellipsoid.hpp"
#include "model/soft_iron_and_scale.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"

namespace sepcal::probes {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Start = Eigen::Vector<double, 9>;  // lambda, alpha, n: the model's order

constexpr auto& parameters = AttitudeIndependentMagnetometer::nonlinear;
constexpr std::array hard_iron{"n_x", "n_y", "n_z"};

/// The readings of the record's segments.
struct Readings {
  std::array<std::vector<double>, 3> axes;

  explicit Readings(const Record& record) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto column = record.column(std::array{"mx", "my", "mz"}[axis]);
      for (const Segment& segment : record.segments()) {
        const auto part = column.subspan(segment.first, segment.rows());
        axes[axis].insert(axes[axis].end(), part.begin(), part.end());
      }
    }
  }
  Points points() const { return {axes[0], axes[1], axes[2]}; }
};

/// Of the record's readings; piece by piece, as it may be longer than memory.
PointBox box_of_readings(const Record& record) {
  Vector3d low = Vector3d::Constant(infinity);
  Vector3d high = -low;
  base::for_each_piece(record, [&](std::size_t first, std::size_t last) {
    for (Index axis = 0; axis < 3; ++axis) {
      const auto column =
          record.column(std::array{"mx", "my", "mz"}[static_cast<std::size_t>(axis)]);
      const auto [least, largest] = std::ranges::minmax(column.subspan(first, last - first));
      low[axis] = std::min(low[axis], least);
      high[axis] = std::max(high[axis], largest);
    }
  });
  return {0.5 * (low + high), 0.5 * (high - low)};
}

/// Every reading lies |C h| from n, and |C| is below two in any sensor that works.
void bound_hard_iron(FitOptions& options, const PointBox& box, double field_strength) {
  const double reach = 2.0 * field_strength;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double middle = box.middle[static_cast<Index>(axis)];
    options.bounds.try_emplace(hard_iron[axis], Interval{middle - reach, middle + reach});
  }
}

Interval bounds_of(const FitOptions& options, const Quantity& parameter) {
  const auto given = options.bounds.find(std::string(parameter.name));
  if (given == options.bounds.end()) return {parameter.lower, parameter.upper};
  if (std::isfinite(given->second.lower) && std::isfinite(given->second.upper)) {
    return given->second;
  }
  throw Error(fmt::format(
      "the bounds of '{}' are open; a fit to the field's strength alone needs two finite ones",
      parameter.name));
}

/// The point of the box that is nearest to `start`.
Start clip(const FitOptions& options, const Start& start) {
  Start inside;
  for (Index k = 0; k < start.size(); ++k) {
    const auto [lower, upper] = bounds_of(options, parameters[static_cast<std::size_t>(k)]);
    inside[k] = std::clamp(start[k], lower, upper);
  }
  return inside;
}

/// Readings that lie all round the centre of a roundish ellipsoid, and on it, leave no doubt about
/// its size. Those of a patch draw a small flat one into their midst.
bool is_certain(const Points& points, const Ellipsoid& ellipsoid) {
  const Coverage coverage = judge_coverage(points, ellipsoid);
  return ellipsoid.elongation() < 1.5 && coverage.roughness < 0.1 && coverage.one_sided < 0.7 &&
         coverage.thinnest > 0.1;
}

void check_size(const FitOptions& options, const Ellipsoid& ellipsoid, double field_strength) {
  const double scale = ellipsoid.radius() / field_strength;
  Interval widest{infinity, -infinity};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Interval bounds = bounds_of(options, parameters[axis]);
    widest = {std::min(widest.lower, bounds.lower), std::max(widest.upper, bounds.upper)};
  }
  if (scale > 1.0 + widest.lower && scale < 1.0 + widest.upper) return;
  throw OptionError(
      {fmt::format("the readings lie on an ellipsoid of {:.3g} uT mean radius, and ",
                   ellipsoid.radius()),
       Option{"field_strength"},
       fmt::format(" is {:.4g} uT: a scale of {:.3g} is beyond the bounds of lambda; check the "
                   "unit in the headers and the strength, or widen the bounds of lambda_x, "
                   "lambda_y and lambda_z",
                   field_strength, scale)});
}

/// A sphere on the side of the readings where a sphere fits best, of its radius or, where that is
/// beyond half to one and a half of it, of the field's strength.
Start start_from_sphere(const Points& points, const PointBox& box, double field_strength) {
  Start start = Start::Zero();
  start.tail<3>() = box.middle;
  const auto sphere = fit_sphere(points);
  if (!sphere) return start;
  const double scale = sphere->radius / field_strength;
  if (scale > 0.5 && scale < 1.5) {
    start.head<3>().setConstant(scale - 1.0);
    start.tail<3>() = sphere->centre;
  } else {
    const Vector3d inwards = sphere->centre - box.middle;
    if (inwards.norm() > field_strength) start.tail<3>() += inwards.normalized() * field_strength;
  }
  return start;
}

std::optional<Start> start_from_ellipsoid(const Ellipsoid& ellipsoid, double field_strength) {
  const auto split = model::split_shape(ellipsoid.shape / (field_strength * field_strength));
  if (!split) return std::nullopt;
  Start start;
  start << split->scale.array() - 1.0, split->soft_iron, ellipsoid.centre;
  return start;
}

}  // namespace

FitOptions start_attitude_independent(const FitOptions& options, const Record& record,
                                      double field_strength) {
  FitOptions completed = options;
  bound_hard_iron(completed, box_of_readings(record.select(options.stage_two_segments)),
                  field_strength);
  if (!options.start.empty()) return completed;
  estimation::refuse_sampling(options, "it begins at the ellipsoid of the readings");

  const Readings readings(base::excerpt(record.select(options.stage_one_segments)));
  const Points points = readings.points();
  const PointBox box = box_of(points);
  Start start = start_from_sphere(points, box, field_strength);
  if (const auto ellipsoid = fit_ellipsoid(points)) {
    if (is_certain(points, *ellipsoid)) check_size(completed, *ellipsoid, field_strength);
    const auto split = start_from_ellipsoid(*ellipsoid, field_strength);
    if (split && clip(completed, *split) == *split) start = *split;
  }
  start = clip(completed, start);
  for (Index k = 0; k < start.size(); ++k) {
    completed.start[std::string(parameters[static_cast<std::size_t>(k)].name)] = start[k];
  }
  return completed;
}

namespace {

/// Parameters whose intervals don't hold: a linearised ellipsoid is one only near its estimate. At
/// standard errors of 0.08 and more, on a small cap of the sphere, 95 % intervals cover 76 to 90 %.
std::vector<std::string> too_loose(const Fit& fit, double field_strength) {
  constexpr double most = 0.08;
  std::vector<std::string> names;
  for (const Quantity& parameter : parameters) {
    const double unit = parameter.name.starts_with("n_") ? field_strength : 1.0;
    const std::string name(parameter.name);
    if (fit[name].standard_error > most * unit) names.push_back(name);
  }
  return names;
}

}  // namespace

void judge_attitude_independent(Fit& fit, double field_strength) {
  const auto say = [&](const std::string& sentence) {
    fit.identifiability.sentences.push_back(sentence);
    fit.message = base::join_sentences({fit.message, sentence});
  };
  std::vector<std::string> stopped;
  for (const Quantity& parameter : parameters) {
    if (fit[parameter.name].at_bound) stopped.emplace_back(parameter.name);
  }
  for (const std::string& name : stopped) {
    fit.identifiability.unobservable.push_back({{name}, name, infinity});
  }
  if (!stopped.empty()) {
    if (fit.status == FitStatus::converged) fit.status = FitStatus::not_identifiable;
    say(fmt::format(
        "only {} of {} kept the ellipsoid from growing, shrinking or moving on: log more "
        "attitudes, or check the field's strength and the unit of the readings",
        stopped.size() == 1 ? "the bound" : "the bounds", fmt::join(stopped, ", ")));
  }
  if (stopped.empty() && fit.status == FitStatus::converged) {
    for (const std::string& name : too_loose(fit, field_strength)) {
      fit.identifiability.unobservable.push_back({{name}, name, fit[name].standard_error});
      fit.status = FitStatus::not_identifiable;
    }
    if (fit.status == FitStatus::not_identifiable) {
      say("the readings cover too little of the ellipsoid for its shape to be trusted: a standard "
          "error exceeds 8 % of the field's strength (n) or 0.08 (lambda, alpha), where intervals "
          "no longer hold; log more attitudes");
    }
  }
  for (const char* name : {"eta_x", "eta_y", "eta_z"}) {
    fit.identifiability.unobservable.push_back({{name}, name, infinity});
  }
  say("eta_x, eta_y and eta_z can't be seen: a rotation leaves the field's strength as it is");
}

}  // namespace sepcal::probes
