// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/excitation.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/short_number.hpp"
#include "flight/checks/column_name.hpp"
#include "flight/checks/suspect_rows.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double degrees = 180 / pi;

// A vehicle that is faster than one of these shares of what it does in flight moves: on the ground
// a tube reads the wind.
constexpr double ground_share = 0.04;
constexpr double air_share = 0.5;

/// Tracks over the ground in the rows that move.
void note_headings(const Log& log, const std::vector<double>& speed, std::vector<LogNote>& notes) {
  const auto* north = log.find("vn");
  const auto* east = log.find("ve");
  std::vector<double> tracks;
  for (const std::size_t row : find_moving_rows(speed, 0.3)) {
    tracks.push_back(std::atan2(east->values[row], north->values[row]));
  }
  constexpr double enough = 170 / degrees;  // two legs to and fro, flown with a drift
  const double covered = covered_arc(std::move(tracks));
  if (covered >= enough) return;
  LogNote note = note_on(log, "headings", Concern::matters, {north->header(), east->header()});
  note.found = fmt::format("tracks over the ground cover {:.0f} of 360 degrees", covered * degrees);
  note.effect = "the wind along them and the errors of the airspeed are hard to tell apart";
  note.advice = "fly a full turn, or the same leg to and fro; or hold what you know with --fix";
  notes.push_back(std::move(note));
}

void note_airspeeds(const Log& log, const Airspeed& airspeed, std::vector<LogNote>& notes) {
  if (is_constant(airspeed.values)) return;  // which is told as what it is
  std::vector<double> speeds;
  for (const std::size_t row : find_moving_rows(airspeed.values, 0.3)) {
    speeds.push_back(airspeed.values[row]);
  }
  if (speeds.empty()) return;
  std::ranges::sort(speeds);
  const double low = numerics::quantile(speeds, 0.05);
  const double high = numerics::quantile(speeds, 0.95);
  constexpr double enough = 0.15;  // of the middle
  if (high - low >= enough * numerics::quantile(speeds, 0.5)) return;
  LogNote note = note_on(log, "airspeeds", Concern::matters, airspeed.headers);
  note.found =
      fmt::format("airspeeds lie within {:.3g} to {:.3g} m/s (the middle 90 %)", low, high);
  note.effect = "the scale and the bias of the airspeed are hard to tell apart";
  note.advice = "fly slow and fast too; or hold one of the two with --fix";
  notes.push_back(std::move(note));
}

/// The speed of flight, where most of the log may stand: the middle one of those that are faster
/// than half of the fastest.
double flight_speed(const std::vector<double>& speed) {
  std::vector<double> values;
  std::ranges::copy_if(speed, std::back_inserter(values),
                       [](double value) { return std::isfinite(value); });
  if (values.empty()) return not_a_number;
  const double slow = 0.5 * numerics::select_quantile(values, 0.99);
  std::erase_if(values, [slow](double value) { return value < slow; });
  return median(std::move(values));
}

/// Slower than this over the ground and in the air, each in m/s, it stands.
struct RestSpeeds {
  double ground;
  double air;

  std::string in_words(const Log& log) const {
    const LoggedColumn& north = *log.find("vn");
    const double v = ground / north.logged.unit->convert(1.0);
    std::string moves = fmt::format("{0} * {0} + {1} * {1} > {2:.3g}", quote(north.header()),
                                    quote(log.find("ve")->header()), v * v);
    if (const LoggedColumn* read = log.find("airspeed")) {
      moves += fmt::format(" or {} > {:.3g}", quote(read->header()),
                           air / read->logged.unit->convert(1.0));
    }
    return fmt::format("--where \"{}\"", moves);
  }
};

/// Slow over the ground and in the air: each against what it does in flight, so that units don't
/// matter.
void note_rest(const Log& log, const std::vector<double>& speed, const Airspeed& airspeed,
               std::vector<LogNote>& notes) {
  const RestSpeeds slow{ground_share * flight_speed(speed),
                        air_share * flight_speed(airspeed.values)};
  std::vector<std::size_t> rest;
  std::size_t first = speed.size();
  std::size_t last = 0;
  std::size_t read = 0;
  for (std::size_t row = 0; row < speed.size(); ++row) {
    if (!std::isfinite(speed[row]) || !std::isfinite(airspeed.values[row])) continue;
    ++read;
    if (speed[row] <= slow.ground && airspeed.values[row] <= slow.air) {
      rest.push_back(row);
    } else {
      first = std::min(first, row);
      last = row;
    }
  }
  if (rest.size() < 5 || 200 * rest.size() < read || first >= last) return;
  std::vector<std::string> columns = airspeed.headers;
  columns.push_back(log.find("vn")->header());
  columns.push_back(log.find("ve")->header());
  LogNote note = note_on(log, "at_rest", Concern::matters, std::move(columns), rest);
  note.found = fmt::format("{} of {} rows stand on the ground: no speed in {}", rest.size(), read,
                           list_headers(note.columns));
  note.effect =
      "the tube reads its zero or the wind there, not the air of the flight: the bias and the "
      "wind are pulled";
  note.advice = "leave them out";
  const bool between =
      std::ranges::any_of(rest, [&](std::size_t row) { return row > first && row < last; });
  if (between) {
    note.advice += ": " + slow.in_words(log);
  } else if (!log.time().empty()) {
    note.advice += fmt::format(": --stage-one-segments {0}:{1} --stage-two-segments {0}:{1}",
                               base::stamp(log.time()[first]), base::stamp(log.time()[last]));
  }
  notes.push_back(std::move(note));
}

/// Whether readings of a field that is that strong (NaN: as the Earth's at least) are a patch of
/// what they lie on: nearer to their mean than half of it.
bool is_patch(const Matrix3Xd& read, double least) {
  const Matrix3Xd about = read.colwise() - read.rowwise().mean();
  return about.colwise().norm().maxCoeff() < least;
}

/// The middle of a sphere on which a patch of readings lies: off the patch, across it.
Vector3d centre_of_patch(const Matrix3Xd& read, double radius) {
  const Vector3d mean = read.rowwise().mean();
  const Matrix3Xd about = read.colwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(about * about.transpose());
  return mean + radius * axes.eigenvectors().col(0);
}

/// About the middle of the ellipsoid or sphere that the readings lie on, or else of their box.
Vector3d find_centre(const Matrix3Xd& read, double strength) {
  constexpr double weakest = 22;  // [uT], of the Earth's fields
  const double radius = strength > 0 ? strength : weakest;
  if (is_patch(read, 0.6 * radius)) return centre_of_patch(read, radius);
  const Eigen::MatrixX3d columns = read.transpose();
  const probes::Points points = points_of(columns);
  if (const auto ellipsoid = probes::fit_ellipsoid(points)) {
    if (ellipsoid->elongation() < 3) return ellipsoid->centre;
  }
  if (const auto sphere = probes::fit_sphere(points)) return sphere->centre;
  return probes::box_of(points).middle;
}

void note_sphere(const Log& log, const FieldRows& field, std::vector<LogNote>& notes) {
  if (field.read.cols() == 0) return;
  const bool attitude = field.truth.cols() > 0;
  const double covered = covered_sphere(
      attitude ? field.truth
               : Matrix3Xd(field.read.colwise() - find_centre(field.read, field.strength)));
  constexpr double enough = 0.5;
  if (covered >= enough) return;
  LogNote note = note_on(log, "sphere", Concern::matters, field.headers);
  note.found = fmt::format("the field comes from {:.0f} % of all directions ({})", 100 * covered,
                           attitude ? "by the attitude" : "by the readings about their middle");
  note.effect = attitude ? "soft iron and misalignment are hard to tell from hard iron"
                         : "hard iron, scale errors and soft iron are hard to tell apart";
  note.advice =
      "turn it all round, upside down too; or hold the soft iron: --fix alpha_xy=0 --fix "
      "alpha_xz=0 "
      "--fix alpha_yz=0, or what it is known to be";
  notes.push_back(std::move(note));
}

}  // namespace

double covered_arc(std::vector<double> directions) {
  if (directions.empty()) return 0.0;
  for (double& direction : directions) direction -= 2 * pi * std::floor(direction / (2 * pi));
  std::ranges::sort(directions);
  double widest = directions.front() + 2 * pi - directions.back();
  for (std::size_t i = 1; i < directions.size(); ++i) {
    widest = std::max(widest, directions[i] - directions[i - 1]);
  }
  return 2 * pi - widest;
}

/// A thousand points of Fibonacci's lattice, which are even on the sphere, stand for it.
double covered_sphere(const Matrix3Xd& directions) {
  constexpr int lattice = 1000;
  const double near = std::min(std::cos(10 / degrees),
                               1 - 8 / static_cast<double>(std::max<Index>(directions.cols(), 4)));
  const Matrix3Xd unit = directions.colwise().normalized();
  const Index stride = 1 + unit.cols() / 20000;  // of a long log not every row
  int covered = 0;
  for (int k = 0; k < lattice; ++k) {
    const double z = 1 - (2 * k + 1.0) / lattice;
    const double turn = k * pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vector3d point(r * std::cos(turn), r * std::sin(turn), z);
    for (Index i = 0; i < unit.cols(); i += stride) {
      if (unit.col(i).dot(point) < near) continue;
      ++covered;
      break;
    }
  }
  return static_cast<double>(covered) / lattice;
}

void check_excitation(const Log& log, const Settings& settings, std::vector<LogNote>& notes) {
  if (const auto field = find_field(log, settings)) note_sphere(log, *field, notes);
  const std::vector<double> speed = find_ground_speed(log);
  const auto airspeed = find_airspeed(log);
  if (!speed.empty()) note_headings(log, speed, notes);
  if (airspeed) note_airspeeds(log, *airspeed, notes);
  if (airspeed && !speed.empty()) note_rest(log, speed, *airspeed, notes);
}

}  // namespace sepcal::checks
