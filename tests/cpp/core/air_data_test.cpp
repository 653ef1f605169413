// SPDX-License-Identifier: BSD-3-Clause
// Effects on a five-hole probe: what each does to the prediction, written out or read off the model
// without it on readings that were changed by hand; and its derivatives.
#include "sepcal/detail/effects/air_data.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "composed_checks.hpp"

namespace air_data_test {

using Eigen::AngleAxisd;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sepcal::BlockModel;
using sepcal::Record;
using namespace sepcal::effects;
using namespace sepcal::test;

namespace {

const Record record = five_hole_record();
constexpr Index rows = 60;

std::vector<double> column(const char* name) {
  const auto values = record.column(name);
  return {values.begin(), values.end()};
}

/// Values of all parameters of a model, those given ones, the others as every test has them.
NamedValues values_for(const BlockModel& model, const NamedValues& given) {
  Draws draws(401);
  NamedValues values = draw_values(sepcal::tables_of<sepcal::FiveHoleProbe>(), draws);
  const NamedValues others = draw_values(model.tables(), draws);
  values.insert(others.begin(), others.end());
  for (const auto& [name, value] : given) values.at(name) = value;
  return values;
}

/// Predictions with the effect less `expected`, both at `given`; the largest entry. The effect's
/// derivatives are checked by the way.
template <class Made, class Expected>
double difference(const Made& effect, const NamedValues& given, const Expected& expected) {
  const auto model = sepcal::block_model(five_holes + effect);
  const NamedValues values = values_for(*model, given);
  check_tangent(*model, record, values);
  check_input_tangent(*model, record, values);
  const VectorXd predicted = predict(*model, record, values);
  const VectorXd without = predict(*sepcal::block_model(five_holes), record, values);
  CHECK((predicted - without).norm() > 1e-3 * without.norm());  // it does something
  return (predicted - expected(values)).cwiseAbs().maxCoeff();
}

VectorXd predict_host(const Record& changed, const NamedValues& values) {
  return predict(*sepcal::block_model(five_holes), changed, values);
}

VectorXd predict_host(const NamedValues& values) { return predict_host(record, values); }

}  // namespace

TEST_CASE("wind[d]: W + s phi, north and east") {
  const NamedValues given{{"wind[altitude_m].n", 0.05}, {"wind[altitude_m].e", -0.08}};
  const auto expected = [](const NamedValues& values) {
    VectorXd z = predict_host(values);
    const auto altitude = column("altitude_m");
    for (Index k = 0; k < rows; ++k) {
      const double phi = altitude[static_cast<std::size_t>(k)] - 290.0;
      z[k] += 0.05 * phi;
      z[rows + k] -= 0.08 * phi;
    }
    return z;
  };
  CHECK(difference(Wind<"altitude_m">{290.0}, given, expected) < 1e-12);
}

TEST_CASE("airspeed_scale[d^2] and airspeed_bias[d]: V + s phi v and V + s phi, row by row") {
  // A row at a time: the model without the effect, at another lambda_va or b_va.
  const auto row_by_row = [](const char* parameter, const char* driver, auto size) {
    return [=](const NamedValues& values) {
      VectorXd z(3 * rows);
      const auto d = column(driver);
      for (Index k = 0; k < rows; ++k) {
        NamedValues here = values;
        here.at(parameter) += size(d[static_cast<std::size_t>(k)]);
        const VectorXd all = predict_host(here);
        for (Index j = 0; j < 3; ++j) z[j * rows + k] = all[j * rows + k];
      }
      return z;
    };
  };
  CHECK(difference(AirspeedScale<"flap", 2>{0.1}, {{"airspeed_scale[flap^2].s", 3.0}},
                   row_by_row("lambda_va", "flap",
                              [](double d) { return 3.0 * (d - 0.1) * (d - 0.1); })) < 1e-11);
  CHECK(difference(AirspeedBias<"throttle">{}, {{"airspeed_bias[throttle].s", 2.0}},
                   row_by_row("b_va", "throttle", [](double d) { return 2.0 * d; })) < 1e-11);
}

namespace {

/// A total pressure that is higher by `more` of the driver; the flow angles stay.
template <class More>
auto with_pressure(const char* driver, const More& more) {
  return [=](const NamedValues& values) {
    auto pt = column("pt");
    auto dpa = column("dpa");
    auto dpb = column("dpb");
    const auto ps = column("ps");
    const auto d = column(driver);
    for (std::size_t k = 0; k < pt.size(); ++k) {
      const double before = pt[k] - ps[k];
      pt[k] += more(d[k]);
      dpa[k] *= (pt[k] - ps[k]) / before;
      dpb[k] *= (pt[k] - ps[k]) / before;
    }
    const Record changed = with_column(with_column(record, "pt", pt), "dpa", dpa);
    return predict_host(with_column(changed, "dpb", dpb), values);
  };
}

}  // namespace

TEST_CASE("pressure_offset[d]: the airspeed of (pt - ps) + s phi, the angles as they were read") {
  CHECK(difference(PressureOffset<"throttle">{0.2}, {{"pressure_offset[throttle].s", 40.0}},
                   with_pressure("throttle", [](double d) { return 40.0 * (d - 0.2); })) < 1e-10);
}

TEST_CASE("pressure_offset: the same by a constant") {
  CHECK(difference(PressureZero{}, {{"pressure_offset.s", 25.0}},
                   with_pressure("throttle", [](double) { return 25.0; })) < 1e-10);
}

TEST_CASE("alpha_offset[d] and beta_offset[d]: the angle as read + s phi") {
  const auto expected = [](const char* reading, double sensitivity) {
    return [=](const NamedValues& values) {
      auto dp = column(reading);
      const auto pt = column("pt");
      const auto ps = column("ps");
      const auto q = column("q");
      for (std::size_t k = 0; k < dp.size(); ++k) {
        dp[k] += sensitivity * (pt[k] - ps[k]) * 0.3 * q[k];
      }
      return predict_host(with_column(record, reading, dp), values);
    };
  };
  CHECK(difference(AlphaOffset<"q">{}, {{"alpha_offset[q].s", 0.3}}, expected("dpa", 4.5)) < 1e-11);
  CHECK(difference(BetaOffset<"q">{}, {{"beta_offset[q].s", 0.3}}, expected("dpb", 4.0)) < 1e-11);
}

TEST_CASE("heading_bias: the logged yaw is the true one + delta") {
  const auto expected = [](const NamedValues& values) {
    auto yaw = column("yaw");
    for (double& psi : yaw) psi -= 0.07;
    return predict_host(with_column(record, "yaw", yaw), values);
  };
  CHECK(difference(HeadingBias{}, {{"heading_bias.delta", 0.07}}, expected) < 1e-11);
}

TEST_CASE("lever_arm: the probe sits at r + dr") {
  const auto expected = [](const NamedValues& values) {
    sepcal::FiveHoleProbe moved = five_holes;
    moved.lever_arm += Vector3d(0.5, -0.4, 0.3);
    return predict(*sepcal::block_model(moved), record, values);
  };
  CHECK(difference(LeverArm{}, {{"lever_arm.x", 0.5}, {"lever_arm.y", -0.4}, {"lever_arm.z", 0.3}},
                   expected) < 1e-12);
}

TEST_CASE("mounting_error: probe axes turned by small angles about body y and z") {
  const sepcal::FiveHoleProbe at_reference{4.5, 4.0};
  const auto model = sepcal::block_model(at_reference + MountingError{});
  const NamedValues values =
      values_for(*model, {{"mounting_error.pitch", 0.06}, {"mounting_error.yaw", -0.09}});
  check_tangent(*model, record, values);
  const VectorXd predicted = predict(*model, record, values);

  const VectorXd straight = predict(*sepcal::block_model(at_reference), record, values);
  const Vector3d wind(values.at("w_n"), values.at("w_e"), values.at("w_d"));
  const Matrix3d turn = (AngleAxisd(-0.09, Vector3d::UnitZ()) * AngleAxisd(0.06, Vector3d::UnitY()))
                            .toRotationMatrix();
  for (Index k = 0; k < rows; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const Matrix3d attitude = (AngleAxisd(record.column("yaw")[row], Vector3d::UnitZ()) *
                               AngleAxisd(record.column("pitch")[row], Vector3d::UnitY()) *
                               AngleAxisd(record.column("roll")[row], Vector3d::UnitX()))
                                  .toRotationMatrix();
    const Vector3d ned(straight[k], straight[rows + k], straight[2 * rows + k]);
    const Vector3d expected = attitude * (turn * (attitude.transpose() * (ned - wind))) + wind;
    const Vector3d got(predicted[k], predicted[rows + k], predicted[2 * rows + k]);
    CHECK((got - expected).norm() < 1e-11);
  }
}

TEST_CASE("all of them at zero leave the model as it is") {
  const auto model =
      sepcal::block_model(five_holes + Wind<"altitude_m">{300} + PressureOffset<"throttle">{} +
                          AlphaOffset<"q">{} + HeadingBias{} + LeverArm{} + MountingError{});
  Draws draws(402);
  NamedValues values = draw_values(sepcal::tables_of<sepcal::FiveHoleProbe>(), draws);
  for (const auto& parameter : model->tables().parameters())
    values.try_emplace(parameter.name, 0.0);
  CHECK((predict(*model, record, values) - predict_host(values)).cwiseAbs().maxCoeff() < 1e-12);
}

}  // namespace air_data_test
