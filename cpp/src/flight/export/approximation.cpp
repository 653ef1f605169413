// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/approximation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "base/thread_pool.hpp"
#include "flight/export/bodies.hpp"
#include "flight/export/exporter.hpp"
#include "flight/export/kept_field.hpp"
#include "flight/files/headers.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal::exporting {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

/// Root of the mean square, and the largest by size.
struct Spread {
  double square = 0.0;
  double largest = 0.0;
  std::size_t rows = 0;

  void add(double error) {
    square += error * error;
    largest = std::max(largest, std::abs(error));
    ++rows;
  }
  double rms() const {
    return rows == 0 ? not_a_number : std::sqrt(square / static_cast<double>(rows));
  }
  double most() const { return rows == 0 ? not_a_number : largest; }
};

using Columns = std::vector<CorrectedColumn>;

/// Both corrections in one row; none where either has no value, or the fit left the row out.
class BothCorrected {
 public:
  BothCorrected(Columns full, Columns held) : full_(std::move(full)), held_(std::move(held)) {}

  std::size_t rows() const { return full_.front().values.size(); }
  bool has(std::size_t row) const {
    const auto is_number = [row](const CorrectedColumn& column) {
      return std::isfinite(column.values[row]);
    };
    if (!std::ranges::all_of(full_, is_number) || !std::ranges::all_of(held_, is_number)) {
      return false;
    }
    return full_.back().header != "outside_fit" || full_.back().values[row] == 0.0;
  }
  double full(std::size_t i, std::size_t row) const { return full_[i].values[row]; }
  double held(std::size_t i, std::size_t row) const { return held_[i].values[row]; }

 private:
  Columns full_;
  Columns held_;
};

/// RMS of measured less modelled over all outputs, on the rows that a fit takes.
double residual_of(const Calibration& calibration, const verbs::PreparedFlight& prepared) {
  const EffectiveFlight flight = verbs::with_effects_of(calibration, prepared);
  EffectiveFlight chosen = flight;
  chosen.prepared.record =
      flight.prepared.record.select(calibration.options.fit.stage_two_segments);
  base::ThreadPool pool(calibration.options.fit.threads);
  const Eigen::MatrixXd residuals = verbs::residuals_of(calibration, chosen, pool);
  return std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.size()));
}

/// What both have in common; `anew`: the flight as the other was fitted to it.
Approximation residual_approximation(const Calibration& full, const verbs::PreparedFlight& prepared,
                                     const Calibration& refitted,
                                     const verbs::PreparedFlight& anew) {
  Approximation approximation{.flight = prepared.flight.name()};
  approximation.residual_before = residual_of(full, prepared);
  approximation.residual_after = residual_of(refitted, anew);
  approximation.residual_unit = full.probe->model().tables().outputs.front().unit;
  return approximation;
}

Approximation residual_approximation(const Calibration& full, const Calibration& refitted,
                                     const Flight& flight) {
  const verbs::PreparedFlight prepared = verbs::prepare(full, flight);
  if (mounting_of(full) == mounting_of(refitted)) {
    return residual_approximation(full, prepared, refitted, prepared);
  }
  return residual_approximation(full, prepared, refitted, verbs::prepare(refitted, flight));
}

std::vector<double> pick(const Record& record, const char* name,
                         const std::vector<std::size_t>& rows) {
  const std::span<const double> all = record.column(name);
  std::vector<double> values;
  values.reserve(rows.size());
  for (const std::size_t row : rows) values.push_back(all[row]);
  return values;
}

/// As the calibration reads its flight.
ReadFlight read_flight(const Calibration& calibration, const Flight& flight) {
  std::vector<std::string> unused;
  return probes::read_for(*calibration.probe, flight,
                          verbs::choice_for(calibration, flight, unused));
}

ProbeReadings readings_of(const Calibration& calibration, const Flight& read,
                          const Flight& flight) {
  std::vector<std::string> unused;
  return calibration.probe->read(read, verbs::choice_for(calibration, flight, unused));
}

Columns correct(const HeldField& held, const ProbeReadings& readings, const Flight& read) {
  Columns columns{{"x", {}}, {"y", {}}, {"z", {}}};
  const std::array m{readings.record.column("mx"), readings.record.column("my"),
                     readings.record.column("mz")};
  const Flight::Column* const driver = held.column.empty() ? nullptr : read.find(held.column);
  for (std::size_t row = 0; row < m[0].size(); ++row) {
    const double x = driver == nullptr ? 0.0 : driver->values[row] * held.unit;
    const Eigen::Vector3d h =
        held.W * (Eigen::Vector3d(m[0][row], m[1][row], m[2][row]) - held.n - held.kappa * x);
    for (std::size_t i = 0; i < 3; ++i) {
      columns[i].values.push_back(readings.valid[row] ? h[static_cast<Eigen::Index>(i)]
                                                      : not_a_number);
    }
  }
  return columns;
}

Columns correct(const HeldAirspeed& held, const TubeReader& reader, const ProbeReadings& readings,
                const Flight& read) {
  std::vector<std::size_t> valid;
  for (std::size_t row = 0; row < readings.valid.size(); ++row) {
    if (readings.valid[row]) valid.push_back(row);
  }
  Columns columns{{"airspeed", std::vector<double>(readings.valid.size(), not_a_number)}};
  Record record;
  for (const char* name : {"airspeed", "rho"}) record.add(name, pick(readings.record, name, valid));
  const std::vector<TubeRow> rows = tube_rows(reader, read, record, valid);
  for (std::size_t i = 0; i < valid.size(); ++i) {
    columns[0].values[valid[i]] = corrected(held, reader.sensor, rows[i]);
  }
  return columns;
}

/// Of a field in body axes, turned level by roll and pitch: from magnetic north over east [rad].
double heading(const Eigen::Vector3d& h, double roll, double pitch) {
  const double across = std::cos(roll) * h[1] - std::sin(roll) * h[2];
  const double below = std::sin(roll) * h[1] + std::cos(roll) * h[2];
  return std::atan2(-across, std::cos(pitch) * h[0] + std::sin(pitch) * below);
}

void compare_fields(const BothCorrected& both, const Flight& read, bool attitude_is_known,
                    Approximation& approximation) {
  const auto roll = files::read_quantity(read, "roll", files::UnitKind::angle);
  const auto pitch = files::read_quantity(read, "pitch", files::UnitKind::angle);
  Spread turned;
  Spread strength;
  for (std::size_t row = 0; row < both.rows(); ++row) {
    if (!both.has(row)) continue;
    const Eigen::Vector3d full(both.full(0, row), both.full(1, row), both.full(2, row));
    const Eigen::Vector3d held(both.held(0, row), both.held(1, row), both.held(2, row));
    strength.add(held.norm() - full.norm());
    if (!attitude_is_known || roll.empty() || pitch.empty()) continue;
    if (!std::isfinite(roll[row] + pitch[row])) continue;
    const double difference =
        heading(held, roll[row], pitch[row]) - heading(full, roll[row], pitch[row]);
    turned.add(std::remainder(difference, 2.0 * std::numbers::pi) * degrees);
  }
  approximation.rows = strength.rows;
  approximation.heading_rms_deg = turned.rms();
  approximation.heading_largest_deg = turned.most();
  approximation.strength_rms_ut = strength.rms();
}

void compare_airspeeds(const BothCorrected& both, Approximation& approximation) {
  Spread airspeed;
  for (std::size_t row = 0; row < both.rows(); ++row) {
    if (both.has(row)) airspeed.add(both.held(0, row) - both.full(0, row));
  }
  approximation.rows = airspeed.rows;
  approximation.airspeed_rms_mps = airspeed.rms();
  approximation.airspeed_largest_mps = airspeed.most();
}

}  // namespace

Approximation field_approximation(const Calibration& full, const Calibration& refitted,
                                  const HeldField& held, const Flight& flight) {
  Approximation approximation = residual_approximation(full, refitted, flight);
  const bool rotation_is_known = is_of_known_field(full);
  if (rotation_is_known) approximation.rotation_deg = angle_of(lost_rotation(full, refitted));
  const ReadFlight read = read_flight(full, flight);
  const ProbeReadings readings = readings_of(refitted, read.flight, flight);
  compare_fields({apply(full, flight), correct(held, readings, read.flight)}, read.flight,
                 rotation_is_known, approximation);
  return approximation;
}

Approximation airspeed_approximation(const Calibration& full, const FittedAirspeed& fitted,
                                     const TubeReader& reader, const Flight& flight) {
  Approximation approximation = residual_approximation(full, verbs::prepare(full, flight),
                                                       fitted.calibration, fitted.prepared);
  const ReadFlight read = read_flight(full, flight);
  const ProbeReadings readings = readings_of(full, read.flight, flight);
  compare_airspeeds({apply(full, flight), correct(fitted.held, reader, readings, read.flight)},
                    approximation);
  return approximation;
}

Approximation refit_approximation(const Calibration& full, const Calibration& refitted,
                                  const Flight& flight) {
  Approximation approximation = residual_approximation(full, refitted, flight);
  Columns held = apply(refitted, flight);
  held.resize(full.probe->corrected_headers().size());
  const BothCorrected both(apply(full, flight), std::move(held));
  if (is_magnetometer(full)) {
    compare_fields(both, read_flight(full, flight).flight, is_of_known_field(full), approximation);
  } else {
    compare_airspeeds(both, approximation);
  }
  return approximation;
}

}  // namespace sepcal::exporting
