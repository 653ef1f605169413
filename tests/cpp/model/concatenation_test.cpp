// SPDX-License-Identifier: BSD-3-Clause
// Sensors put together at run time, against the same put together while compiling.
#include "sepcal/concatenation.hpp"

#include <doctest/doctest.h>

#include <array>

#include "noises.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/detail/static_concatenation.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/short_period.hpp"

namespace concatenation_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Accelerometer;
using sepcal::block_model;
using sepcal::BlockModel;
using sepcal::Labelled;
using sepcal::Magnetometer;
using sepcal::Variable;
using sepcal::test::Draws;

namespace {

constexpr std::size_t rows = 9;

std::shared_ptr<const BlockModel> at_run_time() {
  return sepcal::concatenate(
      {{"mag", block_model(Magnetometer{})}, {"acc", block_model(Accelerometer{})}});
}

const BlockModel& while_compiling() {
  static const auto model = block_model(
      sepcal::concatenate(Labelled<"mag", Magnetometer>{}, Labelled<"acc", Accelerometer>{}));
  return *model;
}

/// u, xi2 and xi1 at random, and what a model makes of them.
struct At {
  MatrixXd u;
  VectorXd xi2;
  VectorXd xi1;
  std::array<const double*, 6> inputs{};

  explicit At(std::uint64_t seed) {
    Draws draws(seed);
    u = draws.normal_matrix(rows, 6);
    xi2 = 0.2 * draws.normal_matrix(9, 1);
    xi1 = 0.2 * draws.normal_matrix(12, 1);
    for (std::size_t i = 0; i < 6; ++i) inputs[i] = u.col(static_cast<Index>(i)).data();
  }

  sepcal::Block block() const { return {.inputs = inputs, .rows = rows}; }

  MatrixXd rows_of(const BlockModel& model, bool tangent) const {
    MatrixXd found(6 * static_cast<Index>(rows), 12 + (tangent ? 9 : 0) + 1);
    found.setConstant(7.0);
    model.evaluate(block(), xi2.data(), tangent ? xi1.data() : nullptr, nullptr, found);
    return found;
  }
};

}  // namespace

TEST_CASE("tables are those of sensors that were put together while compiling") {
  const auto model = at_run_time();
  const sepcal::Tables& one = model->tables();
  const sepcal::Tables& other = while_compiling().tables();
  const auto same = [](const std::vector<Variable>& a, const std::vector<Variable>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      CHECK(a[i].name == b[i].name);
      CHECK(a[i].unit == b[i].unit);
      CHECK(a[i].lower == b[i].lower);
      CHECK(a[i].upper == b[i].upper);
    }
  };
  same(one.inputs, other.inputs);
  same(one.outputs, other.outputs);
  same(one.linear, other.linear);
  same(one.nonlinear, other.nonlinear);
}

TEST_CASE("rows, derivatives by inputs and second derivatives are the same") {
  const auto model = at_run_time();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const At at(seed);
    for (const bool tangent : {false, true}) {
      CHECK((at.rows_of(*model, tangent) - at.rows_of(while_compiling(), tangent)).norm() < 1e-13);
    }
    const std::array<int, 3> chosen{4, 0, 5};
    MatrixXd one(6 * static_cast<Index>(rows), 3);
    MatrixXd other = one;
    model->input_tangent(at.block(), at.xi2.data(), at.xi1.data(), chosen, one);
    while_compiling().input_tangent(at.block(), at.xi2.data(), at.xi1.data(), chosen, other);
    CHECK((one - other).norm() < 1e-12);
    MatrixXd bend = MatrixXd::Zero(9, 9);
    MatrixXd expected = bend;
    CHECK(model->add_second_derivatives(at.block(), at.xi2.data(), at.xi1.data(), bend));
    CHECK(while_compiling().add_second_derivatives(at.block(), at.xi2.data(), at.xi1.data(),
                                                   expected));
    CHECK((bend - expected).norm() < 1e-12 * (1.0 + expected.norm()));
  }
}

TEST_CASE("guesses stand side by side, and none where a sensor has none") {
  struct Guessing final : BlockModel {
    explicit Guessing(const std::string& name, int points)
        : BlockModel({.inputs = {{"u", "1"}},
                      .outputs = {{"z_" + name, "1"}},
                      .linear = {},
                      .nonlinear = {{name, "1", -1.0, 1.0}}}),
          points_(points) {}
    void evaluate(const sepcal::Block& /*block*/, const double* /*xi2*/, const double* /*xi1*/,
                  sepcal::Carry* /*carry*/, Eigen::Ref<MatrixXd> /*rows*/) const override {}
    MatrixXd guess(const MatrixXd& u, const MatrixXd& z) const override {
      return MatrixXd::Constant(1, points_, u(0, 0) + z(0, 0));
    }
    int points_;
  };
  const auto both = [](int one, int other) {
    return sepcal::concatenate({{"", std::make_shared<const Guessing>("a", one)},
                                {"", std::make_shared<const Guessing>("b", other)}});
  };
  const MatrixXd u = MatrixXd::Constant(1, 1, 0.25);
  const MatrixXd z = Eigen::RowVector2d(0.5, -0.5);
  const MatrixXd guessed = both(3, 2)->guess(u, z);
  REQUIRE(guessed.cols() == 2);
  CHECK(guessed(0, 1) == 0.75);
  CHECK(guessed(1, 0) == -0.25);
  CHECK(both(3, 0)->guess(u, z).cols() == 0);
}

TEST_CASE("what can't be one model is refused by name") {
  using doctest::Contains;
  const auto mag = block_model(Magnetometer{});
  CHECK_THROWS_WITH_AS(sepcal::concatenate(std::vector<sepcal::Sensor>{}), Contains("none"),
                       sepcal::Error);
  CHECK_THROWS_WITH_AS(sepcal::concatenate({{"", mag}, {"", mag}}),
                       Contains("two outputs named 'mx'"), sepcal::Error);
  const auto path = std::make_shared<const sepcal::TrajectoryModel<sepcal::ShortPeriod>>(
      sepcal::ShortPeriod{}, sepcal::TrajectoryOptions{.shoot = sepcal::infinity});
  CHECK_THROWS_WITH_AS(sepcal::concatenate({{"path", path}, {"", mag}}),
                       Contains("'path' has a state"), sepcal::Error);
}

}  // namespace concatenation_test
