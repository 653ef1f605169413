// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/comparison.hpp"

#include "base/parts_of_record.hpp"
#include "base/thread_pool.hpp"
#include "flight/verbs/at_bound.hpp"
#include "flight/verbs/misfits.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "flight/verbs/residual_channels.hpp"
#include "flight/verbs/worst_windows.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

Comparison compare(const Calibration& calibration, const Flight& flight) {
  const Probe& probe = *calibration.probe;
  const EffectiveFlight effective = with_effects_of(calibration, prepare(calibration, flight));
  const Record& record = effective.prepared.record;
  base::ThreadPool pool(calibration.options.fit.threads);

  Comparison result;
  result.model = probe.name();
  result.flight = {flight.name(), flight.sha256(), flight.rows(), record.rows()};
  result.status = calibration.fit.status;
  result.message = calibration.fit.message;
  result.at_bound = names_at_bound(calibration.fit);
  result.notes = effective.prepared.notes;
  note_other_flight(calibration, flight, result.notes);
  result.residuals = residuals_of(calibration, effective, pool);
  result.time = base::gather_time(record);
  const auto& outputs = probe.model().tables().outputs;
  result.overall = measure_whole(record, outputs, result.residuals);
  result.where = measure_parts(record, outputs, result.residuals);
  result.channels = compare_channels(record, probe.model().tables(), result.residuals, pool);
  result.windows =
      find_worst_windows(result.time, result.residuals, result.overall, calibration.fit.noise);
  return result;
}

}  // namespace sepcal
