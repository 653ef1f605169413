// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/comparison.hpp"

#include "base/thread_pool.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "flight/verbs/reference_comparison.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

Comparison compare(const Calibration& given, const Flight& flight,
                   const std::vector<std::string>& references) {
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const Probe& probe = *calibration.probe;
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  base::ThreadPool pool(calibration.options.fit.threads);

  Comparison result =
      compare_residuals(residuals_of(calibration, effective, pool), probe.model().tables(), record,
                        record, flight, calibration.fit, pool);
  result.model = probe.name();
  result.notes = effective.prepared.notes;
  note_other_flight(given, flight, result.notes);
  if (!references.empty()) {
    result.references =
        compare_references(references, apply(given, flight), {prepared.logged, flight},
                           {.record = record, .flight_rows = prepared.readings.flight_rows});
  }
  return result;
}

}  // namespace sepcal
