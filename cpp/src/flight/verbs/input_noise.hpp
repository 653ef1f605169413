// SPDX-License-Identifier: BSD-3-Clause
// Errors in variables: white noise of what a model reads bends a fit, and no standard error shows
// it. It is taken out where asked; where not, a refit without it tells what it does.
#pragma once

#include <string>
#include <vector>

#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::verbs {

/// Takes the white noise out of a flight's inputs of a model with these tables. A note says how
/// much of each. Throws Error for a record that may be longer than memory.
void take_out_input_noise(const Tables& tables, const std::string& flight, Record& record,
                          std::vector<std::string>& notes);

/// The same of what a probe reads. Throws Error also for a probe whose inputs are the readings that
/// it calibrates: such a model allows for their noise.
void take_out_input_noise(const Probe& probe, const std::string& flight, ProbeRecord& readings);

/// Adds a line to the calibration's notes where an estimate lies more than three standard errors
/// from that of inputs without their white noise, and the latter fit better: which inputs do it.
/// Says nothing of a model of the caller's own or one that allows for that noise, and of more than
/// 20,000 rows.
void note_input_noise(Calibration& calibration, const PreparedFlight& prepared);

}  // namespace sepcal::verbs
