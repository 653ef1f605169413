// SPDX-License-Identifier: BSD-3-Clause
// Fits of a model with a candidate to some of the rows, against the fit to all of them.
#include "diagnosis/refits.hpp"

#include <Eigen/QR>
#include <cmath>

#include "flights_with_effects.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"

namespace diagnosis_refits_test {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::Index;
using Eigen::VectorXd;

TEST_CASE("a fit to blocks of rows is one step from the fit to all") {
  const SimulatedFlight simulated =
      fly("five-hole", {{"wind[altitude_m]", {0.01, -0.02}}}, {.rows = 6000, .noise = 0.2});
  const Calibration calibration = calibrate_with("five-hole", simulated, {});
  DiagnosedFit fitted = diagnosed_fit(calibration, make_flight(simulated));
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  const diagnosis::Candidate candidate = room.make("wind[altitude_m]");
  diagnosis::Refits refits(room);
  const Fit& all = refits.with(candidate, not_a_number);  // 6000 rows are less than enough
  const Fit some = diagnosis::refit_nearly(room, candidate, not_a_number, 900);
  CHECK(diagnosis::refit_nearly(room, candidate, not_a_number, 6000).by_name() == all.by_name());

  fitted.effects.push_back(candidate.settings.front());
  fitted.fit = some;
  const diagnosis::CandidateRoom there(fitted, pool);
  const VectorXd step = there.fit().tangent.colPivHouseholderQr().solve(there.fit().residual);
  double before = 0.0;
  for (Index k = 0; k < step.size(); ++k) {
    const std::string& name = there.fit().parameters[static_cast<std::size_t>(k)];
    CAPTURE(name);
    const double error = all[name].standard_error_white;
    before = std::max(before, std::abs(some[name].value - all[name].value) / error);
    CHECK(std::abs(some[name].value + step[k] - all[name].value) < 0.1 * error);
  }
  CHECK(before > 1.0);
}

/// The RMSE of rows left out, by fits to the other folds that begin anew.
double left_out_by_fits(const Calibration& calibration, const Flight& flight,
                        const diagnosis::Folds& folds) {
  double squares = 0.0;
  double count = 0.0;
  const Record whole = diagnosed_fit(calibration, flight).record;
  const auto model = diagnosed_fit(calibration, flight).model;
  const EffectKit kit = effect_kit(calibration.probe->name());
  for (int fold = 0; fold < folds.count; ++fold) {
    std::vector<Segment> others;
    std::vector<Segment> own;
    for (const diagnosis::HeldOutBlock& block : folds.blocks) {
      const Segment rows{"", static_cast<std::size_t>(block.first),
                         static_cast<std::size_t>(block.last)};
      (block.fold == fold ? own : others).push_back(rows);
    }
    Record record = whole;
    std::vector<EffectSetting> settings = calibration.options.effects;
    const auto with = compose(model, make_effects(kit, *model, settings, record), record);
    record.cut(others);
    FitOptions options;
    for (const auto& [name, value] : calibration.fit.nonlinear_estimates()) {
      options.start[name] = value;
    }
    for (const Parameter& parameter : calibration.fit.parameters) {
      if (parameter.fixed) options.fix[parameter.name] = parameter.value;
    }
    const Fit fitted = fit(*with, record, options);
    record.cut(own);
    base::ThreadPool alone(1);
    const model::Measurements measurements(*with, record);
    squares += model::Sweep(*with, measurements, alone)
                   .squared_residuals(fitted.xi1(), fitted.xi2())
                   .sum();
    count += static_cast<double>(record.rows()) * with->tables().n_z();
  }
  return std::sqrt(squares / count);
}

TEST_CASE("rows held out are predicted as by fits to the other folds, at the price of one fit") {
  const SimulatedFlight simulated =
      fly("five-hole", {{"wind[altitude_m]", {0.01, -0.02}}}, {.rows = 1200, .noise = 0.2});
  const Flight flight = make_flight(simulated);
  const Calibration calibration = calibrate_with("five-hole", simulated, {});
  const DiagnosedFit fitted = diagnosed_fit(calibration, flight);
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  const diagnosis::Candidate candidate = room.make("wind[altitude_m]");
  diagnosis::Folds folds = diagnosis::interleaved_blocks(room.fit().layout, 1.0, 12);
  diagnosis::Refits refits(room);
  const diagnosis::HeldOut held_out = refits.hold_out(candidate, not_a_number, folds);
  REQUIRE(held_out.judged);
  CHECK(refits.count() == 1);
  CHECK(held_out.before ==
        doctest::Approx(left_out_by_fits(calibration, flight, folds)).epsilon(2e-3));
  const Calibration with = calibrate_with("five-hole", simulated, {"wind[altitude_m]"});
  CHECK(held_out.after == doctest::Approx(left_out_by_fits(with, flight, folds)).epsilon(2e-3));
}

}  // namespace diagnosis_refits_test
