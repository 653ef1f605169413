// SPDX-License-Identifier: BSD-3-Clause
// The columns of a magnetometer: its three readings and the true field in body axes, h = C_n^b b,
// where C_n^b is the transpose of the 3-2-1 Euler sequence from body to north-east-down.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/probes/mounting.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/record_builder.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

using Vector = std::array<double, 3>;

/// The components of the navigation-frame vector `b` in body axes: turn by yaw about down, by pitch
/// about the new right, by roll about the new forward axis. Angles in rad.
Vector rotate_to_body(const Vector& b, double roll, double pitch, double yaw) {
  const auto [north, east, down] = b;
  const double ahead = std::cos(yaw) * north + std::sin(yaw) * east;
  const double abeam = std::cos(yaw) * east - std::sin(yaw) * north;
  const double below = std::cos(pitch) * down + std::sin(pitch) * ahead;
  return {std::cos(pitch) * ahead - std::sin(pitch) * down,
          std::cos(roll) * abeam + std::sin(roll) * below,
          std::cos(roll) * below - std::sin(roll) * abeam};
}

/// Adds hx, hy, hz from the attitude and a field in the navigation frame, row by row.
template <class Field>
void compute_true_field(RecordBuilder& builder, const Field& field_at) {
  constexpr std::array<const char*, 3> names{"hx", "hy", "hz"};
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    builder.compute(names[axis], [=, roll = builder.logged("roll"), pitch = builder.logged("pitch"),
                                  yaw = builder.logged("yaw")](std::size_t row) {
      return rotate_to_body(field_at(row), roll.at(row), pitch.at(row), yaw.at(row))[axis];
    });
  }
}

void check_field(const Vector& field) {
  if (!std::ranges::all_of(field, [](double component) { return std::isfinite(component); })) {
    throw Error("the field given is not three finite numbers: north, east, down in uT");
  }
  if (std::ranges::all_of(field, [](double component) { return component == 0; })) {
    throw Error("the field given has no strength; give the Earth's: north, east, down in uT");
  }
}

void use_given_field(RecordBuilder& builder, const Vector& field) {
  builder.need({"roll", "pitch", "yaw"});
  if (builder.has({"hx", "hy", "hz"})) builder.note("the field given replaces hx, hy and hz");
  if (builder.has({"bn", "be", "bd"})) builder.note("the field given replaces bn, be and bd");
  constexpr std::array<const char*, 3> names{"bn", "be", "bd"};
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    builder.compute(names[axis], [value = field[axis]](std::size_t) { return value; });
  }
  compute_true_field(builder, [field](std::size_t) { return field; });
}

void use_logged_field(RecordBuilder& builder) {
  builder.need({"roll", "pitch", "yaw", "bn", "be", "bd"});
  compute_true_field(
      builder, [bn = builder.logged("bn"), be = builder.logged("be"), bd = builder.logged("bd")](
                   std::size_t row) { return Vector{bn.at(row), be.at(row), bd.at(row)}; });
}

/// The readings, turned into body axes where the sensor is mounted otherwise.
void need_field_read(RecordBuilder& builder, const Mounting& mounting) {
  if (mounting == Mounting{}) {
    builder.need({"mx", "my", "mz"});
    return;
  }
  builder.consult({"mx", "my", "mz"});
  constexpr std::array<const char*, 3> names{"mx", "my", "mz"};
  const Eigen::Matrix3d turn = turn_by(mounting);
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    builder.compute(names[axis],
                    [row_of_turn = Eigen::RowVector3d(turn.row(static_cast<int>(axis))),
                     x = builder.logged("mx"), y = builder.logged("my"),
                     z = builder.logged("mz")](std::size_t row) {
                      return row_of_turn.dot(Eigen::Vector3d(x.at(row), y.at(row), z.at(row)));
                    });
  }
}

/// Whether a row's is another strength [uT] than the one given, by more than it is known by.
bool differs(const LoggedQuantity& logged, std::size_t rows, double field_strength) {
  constexpr double known_by = 1e-3;
  for (std::size_t row = 0; row < rows; ++row) {
    if (std::abs(logged.at(row) - field_strength) > known_by * field_strength) return true;
  }
  return false;
}

/// Returns whether there is a time. Readings of a sensor that is turned by hand may have none.
bool need_time(RecordBuilder& builder) {
  const bool is_meant = builder.has({"time"}) || !builder.ask_for_near_miss({"time"}).empty();
  if (is_meant) {
    builder.need({"time"});
    return true;
  }
  builder.compute("time", [](std::size_t row) { return static_cast<double>(row); });
  builder.note(
      "no time is logged: the rows are taken for readings a second apart; clocks, gaps and "
      "rates are not checked, and effects of time, delays and rates mean nothing");
  return false;
}

}  // namespace

std::span<const ProbeQuantity> probes::magnetometer_quantities() {
  using files::UnitKind;
  static constexpr std::array quantities{
      ProbeQuantity{"time", UnitKind::time},
      ProbeQuantity{.name = "mx", .kind = UnitKind::field, .is_measured = true},
      ProbeQuantity{.name = "my", .kind = UnitKind::field, .is_measured = true},
      ProbeQuantity{.name = "mz", .kind = UnitKind::field, .is_measured = true},
      ProbeQuantity{"hx", UnitKind::field},
      ProbeQuantity{"hy", UnitKind::field},
      ProbeQuantity{"hz", UnitKind::field},
      ProbeQuantity{"roll", UnitKind::angle},
      ProbeQuantity{"pitch", UnitKind::angle},
      ProbeQuantity{"yaw", UnitKind::angle},
      ProbeQuantity{"p", UnitKind::rate, false, true},
      ProbeQuantity{"q", UnitKind::rate, false, true},
      ProbeQuantity{"r", UnitKind::rate, false, true},
      ProbeQuantity{.name = "bn", .kind = UnitKind::field, .taken = Taken::as_known},
      ProbeQuantity{.name = "be", .kind = UnitKind::field, .taken = Taken::as_known},
      ProbeQuantity{.name = "bd", .kind = UnitKind::field, .taken = Taken::as_known},
      ProbeQuantity{.name = "field_strength", .kind = UnitKind::field, .taken = Taken::as_known},
  };
  return quantities;
}

std::span<const ProbeQuantity> probes::attitude_independent_quantities() {
  static const std::vector<ProbeQuantity> quantities = [] {
    const auto all = magnetometer_quantities();
    std::vector<ProbeQuantity> list(all.begin(), all.end());
    for (ProbeQuantity& quantity : list) {
      if (!quantity.name.starts_with('m')) quantity.taken = Taken::never;
    }
    return list;
  }();
  return quantities;
}

ProbeRecord prepare_magnetometer(const Flight& flight, const MagnetometerColumns& options) {
  if (options.field) check_field(*options.field);
  RecordBuilder builder(flight, magnetometer_quantities(), options.log);
  const bool is_timed = need_time(builder);
  need_field_read(builder, options.mounting);
  const bool true_field_logged = !options.field && builder.has({"hx", "hy", "hz"});
  if (options.field) {
    use_given_field(builder, *options.field);
  } else if (true_field_logged) {
    builder.need({"hx", "hy", "hz"});
  } else if (builder.has({"roll", "pitch", "yaw", "bn", "be", "bd"})) {
    use_logged_field(builder);
  } else {
    OptionError::Message message{
        flight.name() +
            ": the true field is missing: log hx_ut, hy_ut, hz_ut, or roll_rad, pitch_rad, "
            "yaw_rad with bn_ut, be_ut, bd_ut or ",
        Option{"field"}, " N,E,D, or fit with ", Option{"field_strength"}, " alone"};
    std::ranges::move(
        builder.ask_for_near_miss({"hx", "hy", "hz", "roll", "pitch", "yaw", "bn", "be", "bd"}),
        std::back_inserter(message));
    message.emplace_back("; " + flight.list_columns());
    throw OptionError(std::move(message));
  }
  builder.keep_valid();
  if (is_timed) builder.check_time();
  builder.offer({"p", "q", "r"});
  if (true_field_logged) {
    builder.offer({"roll", "pitch", "yaw"});
    builder.offer({"bn", "be", "bd"});
  }
  return builder.finish();
}

ProbeRecord prepare_attitude_independent(const Flight& flight, double field_strength,
                                         const LogChoice& log) {
  RecordBuilder builder(flight, magnetometer_quantities(), log);
  builder.expect_field(field_strength);
  const bool is_timed = need_time(builder);
  builder.need({"mx", "my", "mz"});
  if (builder.has({"field_strength"})) {
    builder.consult({"field_strength"});
    builder.compute("field_change",
                    [=, logged = builder.logged("field_strength")](std::size_t row) {
                      return logged.at(row) - field_strength;
                    });
    if (differs(builder.logged("field_strength"), flight.rows(), field_strength)) {
      builder.note(
          fmt::format("field_strength is logged and gives each row's field, not the {} uT given",
                      field_strength));
    }
  }
  builder.keep_valid();
  if (is_timed) builder.check_time();
  builder.compute("field", [](std::size_t) { return 0.0; });
  builder.offer({"p", "q", "r"});
  return builder.finish();
}

ProbeReadings read_magnetometer(const Flight& flight, const LogChoice& log,
                                const Mounting& mounting) {
  RecordBuilder builder(flight, magnetometer_quantities(), log);
  need_field_read(builder, mounting);
  builder.keep_valid();
  return builder.finish_readings();
}

}  // namespace sepcal
