// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/calibrated_flight.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/parameter_values.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

Eigen::VectorXd own_values(const Calibration& calibration) {
  return base::in_order(calibration.probe->model().tables().parameters(),
                        calibration.fit.by_name());
}

EffectiveFlight verbs::prepare_calibrated(const Calibration& calibration, const Flight& flight) {
  const CalibrationOptions& options = calibration.options;
  std::vector<EffectSetting> settings = options.effects;
  EffectiveFlight prepared =
      prepare_with_effects(*calibration.probe, flight, settings, options.own_effects,
                           options.drop_invalid, options.fit.bounds);
  if (!std::ranges::equal(calibration.fit.parameters, prepared.model->tables().parameters(), {},
                          &Parameter::name, &Variable::name)) {
    throw Error(
        "the calibration's parameters are not those of its model with its effects; fit the "
        "flight again");
  }
  return prepared;
}

void verbs::note_other_flight(const Calibration& calibration, const Flight& flight,
                              std::vector<std::string>& notes) {
  const FittedFlight& fitted = calibration.flight;
  if (fitted.sha256.empty() || flight.sha256().empty() || fitted.sha256 == flight.sha256()) return;
  notes.push_back(fmt::format(
      "{}: not the flight that the calibration was fitted to, {}; the errors here are those of a "
      "prediction",
      flight.name(), fitted.file));
}

}  // namespace sepcal
