// SPDX-License-Identifier: BSD-3-Clause
// Fits of a model with a candidate to some of the rows, against the fit to all of them.
#include "diagnosis/refits.hpp"

#include <Eigen/QR>
#include <cmath>

#include "flights_with_effects.hpp"

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
  const Fit all = diagnosis::refit_with(room, candidate, not_a_number);
  const Fit some = diagnosis::refit_nearly(room, candidate, not_a_number, 600);
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

}  // namespace diagnosis_refits_test
