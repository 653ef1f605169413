// SPDX-License-Identifier: BSD-3-Clause
// Many trials of one design against as many calls of fit(), with the kernels of each instruction
// set, and what lanes leave to fit().
#include "sepcal/fit_trials.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "block_inputs.hpp"
#include "model/lane_kit.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "simulated_records.hpp"

namespace fit_trials_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Block;
using sepcal::BlockModel;
using sepcal::Fit;
using sepcal::fit_trials;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::Record;
using sepcal::TrialFits;
using sepcal::TrialOutput;
using sepcal::TrialRows;
using sepcal::lanes::LaneKit;
using sepcal::lanes::ShippedModel;
using sepcal::test::Draws;
using sepcal::test::Simulated;

namespace {

/// A model that sepcal brings, its trials by the kernel of another instruction set.
class WithKit final : public BlockModel {
 public:
  WithKit(const BlockModel& model, const void* bare, const LaneKit& kit, ShippedModel which)
      : BlockModel(model.tables()),
        model_(model),
        bare_(bare),
        kernel_(kit.models[static_cast<std::size_t>(which)]) {}

  void evaluate(const Block& block, const double* xi2, const double* xi1, sepcal::Carry* carry,
                Eigen::Ref<MatrixXd> rows) const override {
    model_.evaluate(block, xi2, xi1, carry, rows);
  }
  std::size_t lane_width() const override { return kernel_.width; }
  bool evaluate_lanes(const sepcal::LaneBlock& block, const sepcal::PointTiles& points,
                      double* scratch, const VisitTile& visit) const override {
    const auto call = [](void* visitor, std::size_t tile, double* rows) {
      (*static_cast<const VisitTile*>(visitor))(tile, rows);
    };
    VisitTile visitor = visit;
    return kernel_.evaluate(bare_, block, points, scratch, call, &visitor);
  }
  std::size_t prepared_bytes() const override { return kernel_.prepared_bytes; }
  void prepare_rows(const Block& block, void* to) const override {
    kernel_.prepare(bare_, block.inputs.data(), block.rows, to);
  }
  void fill_trials(const TrialRows& trials, double* to) const override {
    kernel_.fill_trials(bare_, trials, to);
  }

 private:
  const BlockModel& model_;
  const void* bare_;
  const sepcal::LaneKernel& kernel_;
};

/// The same without lanes.
class Plain final : public BlockModel {
 public:
  explicit Plain(const BlockModel& model) : BlockModel(model.tables()), model_(model) {}
  void evaluate(const Block& block, const double* xi2, const double* xi1, sepcal::Carry* carry,
                Eigen::Ref<MatrixXd> rows) const override {
    model_.evaluate(block, xi2, xi1, carry, rows);
  }

 private:
  const BlockModel& model_;
};

struct Study {
  Record design;
  std::vector<std::string> names;
  std::vector<MatrixXd> z;  // N x K an output

  std::vector<TrialOutput> outputs() const {
    std::vector<TrialOutput> all;
    for (std::size_t j = 0; j < z.size(); ++j) {
      all.push_back({names[j], {z[j].data(), static_cast<std::size_t>(z[j].size())}});
    }
    return all;
  }
};

/// The model at its truth, with other noise in each trial.
Study repeat(const Simulated& flight, Index trials, double noise = 1.0) {
  const VectorXd deviations = noise * Eigen::Vector3d(0.1, 0.2, 0.3);
  const auto& model = *flight.model;
  const auto rows = static_cast<Index>(flight.record.length());
  const auto n_z = static_cast<Index>(model.tables().outputs.size());
  const auto inputs = sepcal::test::block_inputs(model, flight.record, 0);
  const Block block{inputs.pointers, flight.record.length(), 0, true};
  MatrixXd values(n_z * rows, flight.xi1.size() + 1);
  model.evaluate(block, flight.xi2.data(), nullptr, nullptr, values);
  const VectorXd truth = values.leftCols(flight.xi1.size()) * flight.xi1 + values.rightCols<1>();
  Draws draws(17);
  Study study{.design = flight.record, .names = {}, .z = {}};
  for (Index j = 0; j < n_z; ++j) {
    study.names.push_back(model.tables().outputs[static_cast<std::size_t>(j)].name);
    study.z.push_back(truth.segment(j * rows, rows).replicate(1, trials) +
                      deviations[j] * draws.normal_matrix(rows, trials));
  }
  return study;
}

Simulated simulate_pitot_static(std::size_t rows) {
  Simulated flight{"pitot-static",
                   sepcal::block_model(sepcal::PitotStatic{}),
                   Eigen::Vector2d(0.95, -0.6),
                   Eigen::Vector3d(-3.8, 2.4, 0.3),
                   {}};
  Draws draws(5);
  std::vector<double> v[3];
  for (std::size_t k = 0; k < rows; ++k) {
    const double speed = draws.uniform(15, 30);
    const double heading = draws.uniform(-3.1, 3.1);
    v[0].push_back(speed * std::cos(heading));
    v[1].push_back(speed * std::sin(heading));
    v[2].push_back(draws.uniform(-8, 8));
  }
  const std::vector<double> none(rows, 0.0);
  flight.record.add("vn", v[0]).add("ve", v[1]).add("vd", v[2]);
  for (const char* port : {"airspeed_scale", "airspeed_bias", "pressure_offset"}) {
    if (flight.model->tables().inputs.size() > 0) flight.record.add(port, none);
  }
  flight.record.add("rho", std::vector<double>(rows, 1.2));
  return flight;
}

FitOptions plainly() {
  FitOptions options;
  options.coloured_errors = false;
  options.samples = 0;
  return options;
}

Fit fit_one(const BlockModel& model, const Study& study, Index trial, const FitOptions& options) {
  Record record;
  for (const std::string& name : study.design.names()) {
    if (std::ranges::find(study.names, name) == study.names.end()) {
      record.view(name, study.design.column(name));
    }
  }
  for (std::size_t j = 0; j < study.z.size(); ++j) {
    const auto column = study.z[j].col(trial);
    record.view(study.names[j], {column.data(), static_cast<std::size_t>(column.size())});
  }
  record.cut(study.design.segments());
  return sepcal::fit(model, record, options);
}

/// Each trial against fit(); returns how many went in lanes.
int check_against_fit(const BlockModel& model, const Study& study, const TrialFits& fits,
                      const FitOptions& options) {
  int in_lanes = 0;
  for (Index trial = 0; trial < fits.estimates.rows(); ++trial) {
    CAPTURE(trial);
    const Fit one = fit_one(model, study, trial, options);
    const auto t = static_cast<std::size_t>(trial);
    CHECK(fits.status[t] == one.status);
    const auto message = fits.messages.find(t);
    CHECK((message == fits.messages.end() ? "" : message->second) == one.message);
    for (std::size_t k = 0; k < one.parameters.size(); ++k) {
      const auto column = static_cast<Index>(k);
      CAPTURE(fits.names[k]);
      CHECK(fits.names[k] == one.parameters[k].name);
      const double error = one.parameters[k].standard_error;
      const double off = std::abs(fits.estimates(trial, column) - one.parameters[k].value);
      if (std::isnan(error)) {
        CHECK(off <= 1e-9);
        CHECK(std::isnan(fits.standard_errors(trial, column)));
      } else {
        CHECK(off <= 1e-9 * error);
        CHECK(fits.standard_errors(trial, column) == doctest::Approx(error).epsilon(1e-8));
      }
    }
    for (std::size_t j = 0; j < one.rmse.size(); ++j) {
      CHECK(std::sqrt(fits.squared_residuals(trial, static_cast<Index>(j)) /
                      static_cast<double>(fits.rows)) ==
            doctest::Approx(one.rmse[j].value).epsilon(1e-8));
    }
    if (fits.in_lanes[t]) ++in_lanes;
  }
  return in_lanes;
}

std::vector<const LaneKit*> all_kits() {
  std::vector<const LaneKit*> kits;
  for (const std::size_t width : {2U, 4U, 8U}) {
    if (const LaneKit* kit = sepcal::lanes::lane_kit_of(width)) kits.push_back(kit);
  }
  return kits;
}

template <class M>
void check_kits(const Simulated& flight, const M& bare, ShippedModel which,
                const FitOptions& options) {
  CAPTURE(flight.name);
  constexpr Index trials = 13;  // no multiple of a width
  const Study study = repeat(flight, trials);
  for (const LaneKit* kit : all_kits()) {
    CAPTURE(kit->name);
    const WithKit model(*flight.model, &bare, *kit, which);
    const TrialFits fits = fit_trials(model, study.design, study.outputs(), options);
    CHECK(check_against_fit(*flight.model, study, fits, options) == trials);
  }
}

}  // namespace

TEST_CASE("trials in the lanes of each instruction set are what fit() makes of them") {
  const FitOptions options = plainly();
  check_kits(sepcal::test::simulate_scalar_1(100), sepcal::ScalarExample1{}, ShippedModel::scalar_1,
             options);
  check_kits(sepcal::test::simulate_scalar_2(61), sepcal::ScalarExample2{}, ShippedModel::scalar_2,
             options);
  check_kits(simulate_pitot_static(150), sepcal::PitotStatic{}, ShippedModel::pitot_static,
             options);
  check_kits(sepcal::test::simulate_five_hole(200),
             sepcal::FiveHoleProbe{4.5, 4.0, {0.35, -0.1, -0.02}}, ShippedModel::five_hole,
             options);
  check_kits(sepcal::test::simulate_magnetometer(120), sepcal::Magnetometer{},
             ShippedModel::magnetometer, options);
}

TEST_CASE("trials with fixed parameters, given noise, a start or two segments go in lanes, too") {
  Simulated flight = sepcal::test::simulate_five_hole(200);
  FitOptions options = plainly();
  options.fix = {{"w_d", 0.4}, {"eps_phi", 0.05}};
  options.noise = {{"vn", 0.1}, {"ve", 0.2}, {"vd", 0.3}};
  options.start = {{"b_beta", -0.01}};
  flight.record.cut({{"first", 10, 90}, {"second", 100, 190}});
  Study study = repeat(flight, 6);
  study.z[1](3, 2) = std::numeric_limits<double>::quiet_NaN();  // in no segment
  const TrialFits fits = fit_trials(*flight.model, study.design, study.outputs(), options);
  CHECK(fits.rows == 170);
  CHECK(check_against_fit(*flight.model, study, fits, options) == 6);
}

TEST_CASE("trials begin at the best of the samples") {
  FitOptions options = plainly();
  options.samples = 64;
  options.descents = 1;
  options.bounds = {{"b", {-3.0, 3.0}}};
  const Simulated wave = sepcal::test::simulate_scalar_1(40);
  const Study study = repeat(wave, 20, 3.0);
  const TrialFits fits = fit_trials(*wave.model, study.design, study.outputs(), options);
  // (1 + a) cos(eta + b) has a second minimum half a turn on.
  CHECK(check_against_fit(*wave.model, study, fits, options) == 20);
  options.descents = 2;
  CHECK_FALSE(fit_trials(*wave.model, study.design, study.outputs(), options).in_lanes[0]);
}

TEST_CASE("what lanes don't do, fit() does") {
  const Simulated wave = sepcal::test::simulate_scalar_1(60);
  FitOptions options = plainly();

  SUBCASE("minima on a bound") {
    options.bounds = {{"b", {-0.5, 0.2}}, {"c", {-0.3, 1.0}}};
    const Study study = repeat(wave, 40);
    const TrialFits fits = fit_trials(*wave.model, study.design, study.outputs(), options);
    const int in_lanes = check_against_fit(*wave.model, study, fits, options);
    CHECK(in_lanes > 2);
    CHECK(in_lanes < 25);
  }
  SUBCASE("measurements that are no numbers, and nothing but the model") {
    Study study = repeat(wave, 11);
    study.z[0](7, 3) = std::numeric_limits<double>::quiet_NaN();
    study.z[0].col(9) = repeat(wave, 1, 0.0).z[0];
    const TrialFits fits = fit_trials(*wave.model, study.design, study.outputs(), options);
    REQUIRE(fits.failures.size() == 1);
    CHECK(
        fits.failures.at(3) ==
        "column 'z' is not a finite number in row 7 (counted from 0); remove that row or mend it");
    CHECK(fits.estimates.row(3).array().isNaN().all());
    CHECK(fits.status[3] == FitStatus::not_converged);
    CHECK_FALSE(fits.in_lanes[9]);
    CHECK(fits.estimates(9, 2) == doctest::Approx(0.2).epsilon(1e-12));
    for (const std::size_t trial : {0U, 2U, 4U, 10U}) CHECK(fits.in_lanes[trial]);
  }
  SUBCASE("what the record leaves open") {
    Simulated still = wave;
    Record constant;
    constant.add("eta", std::vector<double>(60, 0.3));
    still.record = constant;
    const Study study = repeat(still, 3);
    const TrialFits fits = fit_trials(*still.model, study.design, study.outputs(), options);
    CHECK(check_against_fit(*still.model, study, fits, options) == 0);
    CHECK(fits.status[0] == FitStatus::not_identifiable);
  }
  SUBCASE("coloured errors, a model without lanes") {
    const Study study = repeat(wave, 3);
    const Plain plain(*wave.model);
    CHECK(check_against_fit(*wave.model, study,
                            fit_trials(plain, study.design, study.outputs(), options),
                            options) == 0);
    options.coloured_errors = true;
    const TrialFits fits = fit_trials(*wave.model, study.design, study.outputs(), options);
    CHECK(check_against_fit(*wave.model, study, fits, options) == 0);
  }
}

TEST_CASE("trials are the same on any number of threads and beside any others") {
  const Simulated wave = sepcal::test::simulate_scalar_1(30);
  const Study study = repeat(wave, 1100, 4.0);
  FitOptions options = plainly();
  options.samples = 20;
  options.descents = 1;
  options.threads = 1;
  const TrialFits one = fit_trials(*wave.model, study.design, study.outputs(), options);
  options.threads = 3;
  const TrialFits three = fit_trials(*wave.model, study.design, study.outputs(), options);
  CHECK(one.estimates == three.estimates);
  CHECK(one.squared_residuals == three.squared_residuals);
  CHECK(one.in_lanes == three.in_lanes);
  const MatrixXd later = study.z[0].rightCols(37);
  const TrialFits some =
      fit_trials(*wave.model, study.design,
                 {{"z", {later.data(), static_cast<std::size_t>(later.size())}}}, options);
  CHECK(some.estimates == one.estimates.bottomRows(37));
}

TEST_CASE("what is wrong with trials is said") {
  const Simulated wave = sepcal::test::simulate_scalar_1(10);
  const auto& model = *wave.model;
  const std::vector<double> z(25);
  CHECK_THROWS_WITH_AS(fit_trials(model, wave.record, {}),
                       "the trials have no output 'z'; give its measurements", sepcal::Error);
  CHECK_THROWS_WITH_AS(fit_trials(model, wave.record, {{"z", z}}),
                       "output 'z' has 25 values; give 10, the design's rows, for each trial",
                       sepcal::Error);
  CHECK_THROWS_WITH_AS(fit_trials(model, wave.record, {{"z", {z.data(), 20}}, {"y", z}}),
                       "the model has no output 'y'; it has z", sepcal::Error);
}

}  // namespace fit_trials_test
