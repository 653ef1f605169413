// SPDX-License-Identifier: BSD-3-Clause
// The two-stage start on board against the host's of the same rows, and on rows that are no start.
#include "sepcal/detail/states/two_stage_start.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "draws.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/states/stream_start.hpp"

namespace two_stage_start_test {

using doctest::Approx;
using sepcal::FiveHoleProbe;
using sepcal::not_a_number;
using sepcal::StartStatus;
using sepcal::TwoStageStart;
using sepcal::Vec;
using sepcal::test::Draws;
using Inputs = Vec<double, 14>;
using Outputs = Vec<double, 3>;
using Parameters = Vec<double, 10>;

namespace {

constexpr double noise = 0.1;  // m/s
const FiveHoleProbe probe{4.5, 4.6, {0.4, 0.0, -0.1}};
const Parameters truth{{0.05, -0.3, 4, -2, 0.1, 0.1, 0.02, -0.1, 0.03, 0.1}};

struct Sample {
  Inputs u;
  Outputs z;
};

/// A sample of a lively flight; `turn` 0 keeps one heading, one speed, and the wings level.
Sample draw(Draws& draws, double turn) {
  const double pressure = 300.0 + turn * 60.0 * draws.normal();
  Sample sample;
  sample.u << turn * 0.5 * draws.normal(), turn * 0.2 * draws.normal(),
      0.7 + turn * draws.uniform(-3.1, 3.1), turn * 0.1 * draws.normal(),
      turn * 0.1 * draws.normal(), turn * 0.1 * draws.normal(), 101325.0 + pressure, 101325.0,
      pressure * (0.2 + turn * 0.3 * draws.normal()), pressure * turn * 0.3 * draws.normal(), 1.2,
      0, 0, 0;
  const auto z = probe.at(sample.u, Vec<double, 5>(truth.tail<5>()));
  sample.z = z.A * truth.head<5>() + z.b;
  for (double& value : sample.z) value += noise * draws.normal();
  return sample;
}

template <class Start>
int run(Start& start) {
  int calls = 1;
  while (start.work() == StartStatus::working) ++calls;
  return calls;
}

}  // namespace

TEST_CASE("its start is the host's of the same rows, within 1e-7 standard errors") {
  constexpr int rows = 80;
  int rank = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Draws draws(seed);
    TwoStageStart<FiveHoleProbe, rows> start(probe, Outputs::Constant(noise));
    std::map<std::string, std::vector<double>> columns;
    sepcal::Record record;
    for (int k = 0; k < rows; ++k) {
      const Sample sample = draw(draws, 1.0);
      CHECK(start.add(sample.u, sample.z));
      for (int i = 0; i < 14; ++i)
        columns[std::string(FiveHoleProbe::inputs[static_cast<std::size_t>(i)].name)].push_back(
            sample.u[i]);
      for (int j = 0; j < 3; ++j)
        columns[std::string(FiveHoleProbe::outputs[static_cast<std::size_t>(j)].name)].push_back(
            sample.z[j]);
    }
    for (const auto& [name, values] : columns) record.add(name, values);
    CHECK_FALSE(start.add(Inputs::Zero(), Outputs::Zero()));  // no room
    const int calls = run(start);
    REQUIRE(start.status() == StartStatus::done);
    CHECK(calls <= start.most_calls());

    sepcal::FitOptions options;
    options.noise = {{"vn", noise}, {"ve", noise}, {"vd", noise}};
    options.coloured_errors = false;
    options.threads = 1;
    const sepcal::Fit fit = sepcal::fit(probe, record, options);
    for (int k = 0; k < 10; ++k) {
      const auto& parameter = fit.parameters[static_cast<std::size_t>(k)];
      CAPTURE(parameter.name);
      CHECK(std::abs(start.parameters()[k] - parameter.value) <
            1e-7 * parameter.standard_error_white);
    }
    rank += start.noise_ratio() > 1.0 ? 1 : 0;
  }
  CHECK(rank > 2);  // s scatters about one
  CHECK(rank < 18);
}

TEST_CASE("a start in float is the start in double, to float's digits") {
  constexpr int rows = 80;
  Draws draws(3);
  TwoStageStart<FiveHoleProbe, rows> start(probe, Outputs::Constant(noise));
  TwoStageStart<FiveHoleProbe, rows, 3, float> in_float(probe, Vec<float, 3>::Constant(0.1F));
  for (int k = 0; k < rows; ++k) {
    const Sample sample = draw(draws, 1.0);
    start.add(sample.u, sample.z);
    in_float.add(sample.u.cast<float>(), sample.z.cast<float>());
  }
  run(start);
  run(in_float);
  REQUIRE(in_float.status() == StartStatus::done);
  const Eigen::Matrix<double, 10, 10> R = start.information_root();
  const Parameters apart = in_float.parameters().cast<double>() - start.parameters();
  CHECK((R * apart).norm() < 0.05);  // standard errors; the pressures' own digits are 2e-5 of them
  CHECK((R - in_float.information_root().cast<double>()).norm() < 1e-3 * R.norm());
}

TEST_CASE("rows that are no start end in a status, in no more calls than promised") {
  Draws draws(11);
  const auto ends = [&](double turn, int rows, bool broken) {
    TwoStageStart<FiveHoleProbe, 40> start(probe, Outputs::Constant(noise));
    for (int k = 0; k < rows; ++k) {
      Sample sample = draw(draws, turn);
      if (broken) sample.z.setConstant(not_a_number);
      start.add(sample.u, sample.z);
    }
    start.seal();
    const int calls = run(start);
    CHECK(calls <= start.most_calls());
    return start.status();
  };
  CHECK(ends(0.0, 40, false) == StartStatus::not_determined);  // one heading, one speed
  CHECK(ends(1.0, 3, false) == StartStatus::refused);          // nine values, ten parameters
  CHECK(ends(1.0, 40, true) == StartStatus::refused);          // nothing was measured
  CHECK(ends(1.0, 40, false) == StartStatus::done);

  TwoStageStart<FiveHoleProbe, 40> start(probe, Outputs::Constant(noise));
  CHECK_FALSE(start.add(Inputs::Constant(not_a_number), Outputs::Zero()));
  CHECK(start.status() == StartStatus::collecting);
  TwoStageStart<FiveHoleProbe, 40> silent(probe, Outputs::Zero());
  CHECK(silent.status() == StartStatus::refused);
}

TEST_CASE("options out of range are brought into it, and its promise of calls holds") {
  Draws draws(13);
  for (const int rows_per_call : {0, -5, 7, 1'000'000'000}) {
    for (const int count : {-30, 0, 1}) {
      sepcal::TwoStageOptions options;
      options.samples = count;
      options.rows_per_call = rows_per_call;
      options.refinement.iterations = count;
      TwoStageStart<FiveHoleProbe, 40> start(probe, Outputs::Constant(noise), options);
      for (int k = 0; k < 40; ++k) {
        const Sample sample = draw(draws, 1.0);
        start.add(sample.u, sample.z);
      }
      CHECK(run(start) <= start.most_calls());
    }
  }
}

TEST_CASE("rows without noise are a start, and a row that is no reading is not kept") {
  Draws draws(17);
  TwoStageStart<FiveHoleProbe, 60> start(probe, Outputs::Constant(noise));
  while (start.status() == StartStatus::collecting) {
    Sample sample = draw(draws, 1.0);
    const auto z = probe.at(sample.u, Vec<double, 5>(truth.tail<5>()));
    sample.z = z.A * truth.head<5>() + z.b;
    start.add(sample.u, sample.z);
    sample.u[6] = sample.u[7] - 1.0;  // total below static pressure
    CHECK_FALSE(start.add(sample.u, sample.z));
  }
  run(start);
  REQUIRE(start.status() == StartStatus::done);
  CHECK((start.parameters() - truth).norm() < 1e-9);
  CHECK(start.noise_ratio() > 0.0);
  CHECK(start.information_root().allFinite());
}

/// z = a + b x: two parameters, of which the second may be all that is nonlinear.
struct Line {
  static constexpr std::array inputs{sepcal::Quantity{"x", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> linear{};
  static constexpr std::array nonlinear{sepcal::Quantity{"a", "1", -9, 9},
                                        sepcal::Quantity{"b", "1", 0, 9}};
  template <class U, class X>
  sepcal::Affine<X, 1, 0> at(const Vec<U, 1>& u, const Vec<X, 2>& xi2) const {
    sepcal::Affine<X, 1, 0> z;
    z.b << xi2[0] + xi2[1] * u[0];
    return z;
  }
};

TEST_CASE("a model without linear parameters starts too, and what no row tells is not determined") {
  using Number = Vec<double, 1>;
  TwoStageStart<Line, 20> start(Line{}, Number(0.1));
  TwoStageStart<Line, 20> blind(Line{}, Number(0.1));
  for (int k = 0; k < 20; ++k) {
    start.add(Number(k), Number(2.0 + 0.5 * k + (k % 2 == 0 ? 0.1 : -0.1)));
    blind.add(Number(0.0), Number(2.0 + (k % 2 == 0 ? 0.1 : -0.1)));
  }
  run(start);
  run(blind);
  REQUIRE(start.status() == StartStatus::done);
  CHECK(start.parameters()[1] == Approx(0.5).epsilon(0.05));
  CHECK(blind.status() == StartStatus::not_determined);
}

TEST_CASE("missing values are left out, and the rows that a call takes don't change the start") {
  constexpr int rows = 60;
  Draws draws(5);
  sepcal::TwoStageOptions all_at_once;
  all_at_once.rows_per_call = rows;
  TwoStageStart<FiveHoleProbe, rows> start(probe, Outputs::Constant(noise));
  TwoStageStart<FiveHoleProbe, rows> whole(probe, Outputs::Constant(noise), all_at_once);
  for (int k = 0; k < rows; ++k) {
    Sample sample = draw(draws, 1.0);
    if (k % 7 == 0) sample.z[k % 3] = not_a_number;
    start.add(sample.u, sample.z);
    whole.add(sample.u, sample.z);
  }
  CHECK(run(start) > run(whole));
  REQUIRE(start.status() == StartStatus::done);
  CHECK(start.parameters() == whole.parameters());
  const Parameters errors = start.information_root().inverse().rowwise().norm();
  CHECK(((start.parameters() - truth).cwiseAbs().array() < 5.0 * errors.array()).all());
}

}  // namespace two_stage_start_test
