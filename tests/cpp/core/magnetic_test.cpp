// SPDX-License-Identifier: BSD-3-Clause
// Effects on a magnetometer: what each adds to C h + n, written out, and its derivatives.
#include "sepcal/detail/effects/magnetic.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "composed_checks.hpp"

namespace magnetic_test {

using Eigen::AngleAxisd;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sepcal::Magnetometer;
using sepcal::Record;
using namespace sepcal::effects;
using namespace sepcal::test;

namespace {

const Record record = magnetometer_record();
constexpr Index rows = 60;

double at(const char* name, Index row) {
  return record.column(name)[static_cast<std::size_t>(row)];
}

Vector3d field(Index row) { return {at("hx", row), at("hy", row), at("hz", row)}; }

/// The largest difference between the prediction with the effect and `expected(C, n, row)`, C and n
/// of the model alone. The effect's derivatives are checked by the way.
template <class Made, class Expected>
double difference(const Made& effect, const NamedValues& given, const Expected& expected) {
  const auto model = sepcal::block_model(Magnetometer{} + effect);
  Draws draws(411);
  NamedValues values = draw_values(model->tables(), draws);
  for (const auto& [name, value] : given) values.at(name) = value;
  check_tangent(*model, record, values);
  check_input_tangent(*model, record, values);

  const VectorXd xi2 = in_order(sepcal::tables_of<Magnetometer>().nonlinear, values);
  Matrix3d C = Magnetometer::soft_iron_and_misalignment<double>(xi2);
  const char* const scales[] = {"lambda_x", "lambda_y", "lambda_z"};
  for (Index i = 0; i < 3; ++i) C.col(i) *= 1.0 + values.at(scales[i]);
  const Vector3d n(values.at("n_x"), values.at("n_y"), values.at("n_z"));
  const VectorXd predicted = predict(*model, record, values);
  double largest = 0.0;
  double without = 0.0;
  for (Index k = 0; k < rows; ++k) {
    const Vector3d got(predicted[k], predicted[rows + k], predicted[2 * rows + k]);
    largest = std::max(largest, (got - expected(C, n, k)).norm());
    without = std::max(without, (got - C * field(k) - n).norm());
  }
  CHECK(without > 0.1);  // it does something
  return largest;
}

}  // namespace

TEST_CASE("bias[d]: + s phi on every axis") {
  const NamedValues given{
      {"bias[current_a].x", 0.3}, {"bias[current_a].y", -0.2}, {"bias[current_a].z", 0.5}};
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    return Vector3d(C * field(k) + n + (at("current_a", k) - 2.0) * Vector3d(0.3, -0.2, 0.5));
  };
  CHECK(difference(Bias<"current_a">{2.0}, given, expected) < 1e-12);
}

TEST_CASE("scale[d]: + s phi h, h the true field and not the sensor's") {
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    const double phi = at("temp_degc", k) - 25.0;
    return Vector3d(C * field(k) + n + 0.002 * phi * phi * field(k));
  };
  CHECK(difference(Scale<"temp_degc", 2>{25.0}, {{"scale[temp_degc^2].s", 0.002}}, expected) <
        1e-12);
}

TEST_CASE("axis_scale[d]: + s_i phi h_i on axis i") {
  const NamedValues given{{"axis_scale[temp_degc].x", 0.002},
                          {"axis_scale[temp_degc].y", -0.003},
                          {"axis_scale[temp_degc].z", 0.004}};
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    const Vector3d s(0.002, -0.003, 0.004);
    return Vector3d(C * field(k) + n + (at("temp_degc", k) - 25.0) * s.cwiseProduct(field(k)));
  };
  CHECK(difference(AxisScale<"temp_degc">{25.0}, given, expected) < 1e-12);
}

TEST_CASE("cubic_nonlinearity: + d_i h_i^3 + c_i h_i^2") {
  const NamedValues given{{"cubic_nonlinearity.d_x", 1e-5},  {"cubic_nonlinearity.d_y", -2e-5},
                          {"cubic_nonlinearity.d_z", 3e-5},  {"cubic_nonlinearity.c_x", 1e-3},
                          {"cubic_nonlinearity.c_y", -2e-3}, {"cubic_nonlinearity.c_z", 4e-3}};
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    const Eigen::Array3d h = field(k).array();
    const Eigen::Array3d d(1e-5, -2e-5, 3e-5);
    const Eigen::Array3d c(1e-3, -2e-3, 4e-3);
    return Vector3d(C * field(k) + n + (d * h.cube() + c * h.square()).matrix());
  };
  CHECK(difference(CubicNonlinearity{}, given, expected) < 1e-11);
}

TEST_CASE("eddy_currents: + E dh/dt, E by rows") {
  Matrix3d E;
  E << 0.01, 0.02, -0.03, 0.04, -0.05, 0.06, 0.07, -0.08, 0.09;
  NamedValues given;
  const std::string axes = "xyz";
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) {
      given["eddy_currents." + axes.substr(static_cast<std::size_t>(i), 1) +
            axes.substr(static_cast<std::size_t>(j), 1)] = E(i, j);
    }
  }
  const auto expected = [&](const Matrix3d& C, const Vector3d& n, Index k) {
    const Vector3d h_dot(at("hx_dot", k), at("hy_dot", k), at("hz_dot", k));
    return Vector3d(C * field(k) + n + E * h_dot);
  };
  CHECK(difference(EddyCurrents{}, given, expected) < 1e-12);
}

TEST_CASE("field_declination: the true field is the assumed one turned about down, to the east") {
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    // The yaw is of no consequence: a turn about down commutes with it.
    const Matrix3d attitude =
        (AngleAxisd(1.234, Vector3d::UnitZ()) * AngleAxisd(at("pitch", k), Vector3d::UnitY()) *
         AngleAxisd(at("roll", k), Vector3d::UnitX()))
            .toRotationMatrix();
    const Matrix3d turn = AngleAxisd(0.1, Vector3d::UnitZ()).toRotationMatrix();
    return Vector3d(C * (attitude.transpose() * (turn * (attitude * field(k)))) + n);
  };
  CHECK(difference(FieldDeclination{}, {{"field_declination.delta", 0.1}}, expected) < 1e-11);
}

TEST_CASE("attitude_bias: h + h x (x, y, 0)") {
  const NamedValues given{{"attitude_bias.x", 0.05}, {"attitude_bias.y", -0.03}};
  const auto expected = [](const Matrix3d& C, const Vector3d& n, Index k) {
    const Vector3d h = field(k);
    return Vector3d(C * (h + Vector3d(0.03 * h[2], 0.05 * h[2], -0.03 * h[0] - 0.05 * h[1])) + n);
  };
  CHECK(difference(AttitudeBias{}, given, expected) < 1e-12);
}

}  // namespace magnetic_test
