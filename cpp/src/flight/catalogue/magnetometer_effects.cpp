// SPDX-License-Identifier: BSD-3-Clause
// The effects on a magnetometer with attitude. x is a driver about its centre, s a coefficient, h
// the true field in body axes.
#include <array>
#include <utility>

#include "flight/catalogue/effect_channels.hpp"
#include "flight/catalogue/effect_makers.hpp"
#include "flight/catalogue/magnetic_rows.hpp"
#include "numerics/interpolated_column.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/run_time_effect.hpp"

namespace sepcal::catalogue {
namespace {

constexpr std::array<const char*, 3> field_names{"hx", "hy", "hz"};
constexpr std::array<const char*, 3> field_rate_names{"hx_dot", "hy_dot", "hz_dot"};

/// dh/dt in body axes: -w x h where the rates are logged, else from the field itself. Nothing where
/// there is no field: who corrects a reading finds both.
void derive_field_rate(Record& record) {
  if (record.has(field_rate_names[0]) || !record.has(field_names[0])) return;
  std::array<std::vector<double>, 3> rate;
  for (std::vector<double>& column : rate) column.assign(record.length(), 0.0);
  const auto logged = [&](const char* rate_name) { return is_logged(record, rate_name); };
  if (record.has("r") && (logged("p") || logged("q") || logged("r"))) {
    const std::array w{record.column("p"), record.column("q"), record.column("r")};
    const std::array h{record.column("hx"), record.column("hy"), record.column("hz")};
    for (std::size_t row = 0; row < record.length(); ++row) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        rate[i][row] = w[k][row] * h[j][row] - w[j][row] * h[k][row];
      }
    }
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      const numerics::InterpolatedColumn column(record, field_names[i]);
      for (const Segment& segment : record.segments()) {
        std::vector<NaturalSpline::Value> values(segment.rows());
        column.fill(segment.first, 0.0, values);
        for (std::size_t n = 0; n < values.size(); ++n) {
          rate[i][segment.first + n] = values[n].slope;
        }
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) record.add(field_rate_names[i], std::move(rate[i]));
}

Effect eddy_currents(const BlockModel& /*model*/, EffectSetting& setting, Record& record) {
  derive_field_rate(record);
  return effect(setting.name, effects::EddyCurrents{});
}

/// The logged angles less the true ones, small. Each turns the field about its own axis: roll's is
/// body x, pitch's lies level across the heading, yaw's points down.
struct AngleErrors {
  static constexpr int corrected = 3;
  static constexpr std::array inputs = composing::join(
      effects::true_field, std::array{Quantity{"roll", "rad"}, Quantity{"pitch", "rad"}});
  static constexpr std::array nonlinear{Quantity{"angle_errors.roll", "rad", -0.175, 0.175},
                                        Quantity{"angle_errors.pitch", "rad", -0.175, 0.175},
                                        Quantity{"angle_errors.yaw", "rad", -0.175, 0.175}};

  template <class T>
  Vec<T, 3> correct(const Vec<T, 5>& u, const Vec<T, 3>& error) const {
    using std::cos;
    using std::sin;
    const Vec<T, 3> h = u.template head<3>();
    const Vec<T, 3> level(T(0.0), cos(u[3]), -sin(u[3]));
    const Vec<T, 3> down(-sin(u[4]), sin(u[3]) * cos(u[4]), cos(u[3]) * cos(u[4]));
    const Vec<T, 3> turned =
        error[1] * level + error[2] * down + Vec<T, 3>(error[0], T(0.0), T(0.0));
    return h + turned.cross(h);
  }
};

constexpr Interval cubic{-1e-4, 1e-4};   // [1/uT^2]: 12 uT in a field of 50
constexpr Interval square{-5e-3, 5e-3};  // [1/uT]: the same
constexpr double slowest = 1.0;          // [s] of a current in the structure

std::map<std::string, Interval> plausible_currents() {
  std::map<std::string, Interval> ranges;
  for (const char* row : axes) {
    for (const char* column : axes) {
      ranges[std::string(row) + column] = {-slowest, slowest};
    }
  }
  return ranges;
}

}  // namespace

EffectTable magnetometer_effects() {
  Port bias{"bias", "uT", {}, largest_field};
  Port scale{"scale", "1", {{.name = "s"}}, largest_scale};
  Port axis_scale{"axis_scale", "1", {}, largest_scale};
  for (std::size_t i = 0; i < 3; ++i) {
    const Varying::Share share{static_cast<int>(i), {field_names[i], "uT"}};
    bias.components.push_back({.name = axes[i], .linear = std::string("n_") + axes[i]});
    scale.components.front().shares.push_back(share);
    axis_scale.components.push_back({.name = axes[i], .shares = {share}});
  }
  EffectTable table;
  table.ports = {
      bias_row(bias, {{"current_a", "field of a current: m + s I (x, y, z)", "current_a"},
                      {"throttle^n", "m + s T^n (x, y, z), n fitted", "throttle"},
                      {"delay(current_a)", "m + s I(t - tau) (x, y, z), tau fitted", "current_a"},
                      {"temp_degc", "m + s dT (x, y, z)", "temp_degc"},
                      {"temp_degc^2", "m + s dT^2 (x, y, z)", "temp_degc"},
                      {"time", "drift: m + s (t - t0) (x, y, z)", "time"}}),
      scale_row(scale, "m + s x h"), axis_scale_row(axis_scale, "m_i + s_i x h_i (x, y, z)")};
  table.effects = {
      bias_step_row(bias),
      warm_up_row(bias),
      {.entry = CataloguedEffect{"cubic_nonlinearity", "m_i + d_i h_i^3 + c_i h_i^2", "none",
                                 "1/uT^2, 1/uT"},
       .sentence = "the sensor's response is curved",
       .maker = maker_of(effects::CubicNonlinearity{}),
       .plausible = {{"d_x", cubic},
                     {"d_y", cubic},
                     {"d_z", cubic},
                     {"c_x", square},
                     {"c_y", square},
                     {"c_z", square}}},
      {.entry =
           CataloguedEffect{"eddy_currents", "m + E dh/dt, E 3 x 3", "p, q, r or attitude", "s"},
       .sentence = "eddy currents follow the turning field",
       .channels = {"time"},
       .maker = eddy_currents,
       .better_with = {"p", "q", "r"},
       .plausible = plausible_currents()},
      {.entry = CataloguedEffect{"time_offset", "magnetometer late by tau", "attitude", "s"},
       .sentence = "the sensor's time is late",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::outputs_late, longest_offset)},
      {.entry = CataloguedEffect{"clock_drift", "magnetometer late, from 0 at first to tau at last",
                                 "attitude", "s"},
       .sentence = "the sensor's clock drifts",
       .channels = {"time"},
       .maker = drifting_clock(Delay::Kind::outputs_late, longest_offset)},
      {.entry = CataloguedEffect{"sensor_lag", "tau dm/dt + m = m0", "attitude", "s"},
       .sentence = "the sensor lags",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::outputs_lagging, longest_sensor_lag),
       .plausible = {{"tau", {0.0, longest_sensor_lag}}}},
      {.entry =
           CataloguedEffect{"field_declination", "h turned by delta about down", "attitude", "rad"},
       .sentence = "the field's declination is off",
       .channels = {"roll", "pitch"},
       .acts_on = ActsOn::world,
       .maker = maker_of(effects::FieldDeclination{})},
      {.entry = CataloguedEffect{"attitude_bias", "h + h x (x, y, 0): a misalignment absorbs it",
                                 "none", "rad"},
       .sentence = "the logged roll or pitch is off by a constant",
       .acts_on = ActsOn::world,
       .maker = maker_of(effects::AttitudeBias{})}};
  table.aliases = magnetic_aliases();
  table.channels = magnetic_channels();
  table.attitude_errors = {maker_of(AngleErrors{})};
  table.error_budget = {field_bound({"mx", "my", "mz"}), tilt_bound(), heading_bound()};
  return table;
}

}  // namespace sepcal::catalogue
