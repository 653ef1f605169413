// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/certified.hpp"

#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

Certificate certify(const Calibration& given, const Flight& flight,
                    const CertificateOptions& options) {
  check_fitted(given, flight);
  if (!given.options.effects.empty()) {
    throw Error("a model with effects can't be enclosed: certify the fit without them");
  }
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  return certify(*effective.model, record, calibration.fit,
                 calibration.probe->complete(calibration.options.fit, record), options);
}

}  // namespace sepcal
