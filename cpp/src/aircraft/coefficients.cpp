// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/aircraft/coefficients.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "aircraft/motion.hpp"
#include "base/columns.hpp"
#include "base/name_list.hpp"
#include "base/short_number.hpp"
#include "sepcal/detail/aircraft/equations.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace aircraft;  // this room's own

namespace {

using Eigen::Vector3d;

/// The six of a row, whether asked for or not; NaN where their channels are.
std::array<double, 6> coefficients_of(const Motion& at, const AircraftGeometry& of) {
  const Inertia& I = of.inertia;
  const auto [p, q, r] = std::array{at.rates[0], at.rates[1], at.rates[2]};
  const auto [pd, qd, rd] = std::array{at.rates_dot[0], at.rates_dot[1], at.rates_dot[2]};
  const double force = at.qbar * of.area;  // N
  const Vector3d a = at.acceleration;
  const double rolling = I.Ix * pd - I.Ixz * (rd + p * q) + (I.Iz - I.Iy) * q * r;
  const double pitching = I.Iy * qd + (I.Ix - I.Iz) * p * r + I.Ixz * (p * p - r * r);
  const double yawing = I.Iz * rd - I.Ixz * (pd - q * r) + (I.Iy - I.Ix) * p * q;
  return {(at.mass * a[0] - at.thrust) / force,
          at.mass * a[1] / force,
          at.mass * a[2] / force,
          rolling / (force * of.span),
          pitching / (force * of.chord),
          yawing / (force * of.span)};
}

Vector3d hats_of(const Motion& at, const AircraftGeometry& of) {
  const bool twice = of.rate_reference == RateReference::chord_per_twice_speed;
  const Vector3d lengths(of.span / 2.0, of.chord / (twice ? 2.0 : 1.0), of.span / 2.0);
  return at.rates.cwiseProduct(lengths) / at.airspeed;
}

/// What is found at every row; NaN outside the segments.
struct Found {
  std::vector<std::vector<double>> coefficients;  // six
  std::vector<std::vector<double>> hats;          // p q r
  std::vector<std::vector<double>> flow;          // airspeed, alpha, beta
};

Found find_at_rows(const Record& record, const AircraftGeometry& geometry,
                   const Channels& channels) {
  const std::vector<double> empty(record.length(), not_a_number);
  Found found{{6, empty}, {3, empty}, {3, empty}};
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      const Motion at = channels.at(row);
      const auto six = coefficients_of(at, geometry);
      const Vector3d hat = hats_of(at, geometry);
      for (std::size_t i = 0; i < 6; ++i) found.coefficients[i][row] = six[i];
      for (std::size_t i = 0; i < 3; ++i) found.hats[i][row] = hat[static_cast<Eigen::Index>(i)];
      found.flow[0][row] = at.airspeed;
      found.flow[1][row] = at.alpha;
      found.flow[2][row] = at.beta;
    }
  }
  return found;
}

/// The record with what was found in it.
Record add_found(const Record& record, const std::vector<std::string>& names,
                 const Channels& channels, const Found& found) {
  base::Columns columns(record);
  for (const std::string& name : names) {
    columns.set(name, found.coefficients[find_coefficient(name)]);
  }
  const std::array body_rates{"p", "q", "r"};
  const std::array flow{"airspeed", "alpha", "beta"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (record.has(flow[i])) columns.set(flow[i], found.flow[i]);
    if (record.has(body_rates[i])) columns.set(std::string(body_rates[i]) + "_hat", found.hats[i]);
    if (!channels.differentiates()) continue;
    columns.set(std::string(body_rates[i]) + "dot", channels.derivative(i));
  }
  return columns.record();
}

}  // namespace

std::vector<std::string> coefficient_notes(const Record& record, const AircraftGeometry& geometry,
                                           const std::vector<std::string>& coefficients) {
  std::vector<std::string> notes{"q_hat is q " + std::string(to_string(geometry.rate_reference)) +
                                 ", p_hat and r_hat are p b/2V and r b/2V"};
  const bool forward = base::is_among(coefficients, "CX");
  if (forward && !record.has("thrust")) notes.emplace_back("CX holds the thrust: it isn't logged");
  return notes;
}

AeroCoefficients aero_coefficients(const Record& record, const AircraftGeometry& geometry,
                                   const CoefficientOptions& options) {
  check_geometry(geometry);
  const auto& asked = options.coefficients;
  for (const std::string& name : asked) find_coefficient(name);
  std::vector<std::string> names;
  for (const std::string_view name : coefficient_names) {
    if (asked.empty() || base::is_among(asked, name)) names.emplace_back(name);
  }
  const Channels channels(record, geometry, names, options.window);
  std::vector<std::string> notes = coefficient_notes(record, geometry, names);
  if (channels.differentiates()) {
    notes.push_back("p, q and r are differentiated by a local cubic over " +
                    base::short_number(channels.window()) + " s");
  }
  Record with = add_found(record, names, channels, find_at_rows(record, geometry, channels));
  return {std::move(with), std::move(names), channels.window(), std::move(notes)};
}

}  // namespace sepcal
