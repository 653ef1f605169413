// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/comparison.hpp"

#include "calibrated_flight.hpp"
#include "misfits.hpp"
#include "parts_of_record.hpp"
#include "residual_channels.hpp"
#include "sepcal/measurements.hpp"
#include "sweep.hpp"
#include "thread_pool.hpp"
#include "worst_windows.hpp"

namespace sepcal {
Comparison compare(const Calibration& calibration, const Flight& flight) {
  const Probe& probe = *calibration.probe;
  const EffectiveFlight effective = prepare_calibrated(calibration, flight);
  const Record& record = effective.prepared.record;
  const Measurements measurements(*effective.model, record);
  ThreadPool pool(calibration.options.fit.threads);
  const Sweep sweep(*effective.model, measurements, pool);

  Comparison result;
  result.model = probe.name();
  result.flight = {flight.name(), flight.sha256(), flight.rows(), measurements.rows()};
  result.status = calibration.fit.status;
  result.message = calibration.fit.message;
  result.notes = effective.prepared.notes;
  note_other_flight(calibration, flight, result.notes);
  result.residuals = sweep.residuals(calibration.fit.xi1(), calibration.fit.xi2());
  result.time = gather_time(record);
  const auto& outputs = probe.model().tables().outputs;
  result.overall = measure_whole(record, outputs, result.residuals);
  result.where = measure_parts(record, outputs, result.residuals);
  result.channels = compare_channels(record, probe.model().tables(), result.residuals, pool);
  result.windows =
      find_worst_windows(result.time, result.residuals, result.overall, calibration.fit.noise);
  return result;
}

}  // namespace sepcal
