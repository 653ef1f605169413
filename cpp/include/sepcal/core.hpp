// SPDX-License-Identifier: BSD-3-Clause
// All that runs on a vehicle, in reading order: fixed sizes, no heap, no exceptions, no iostream,
// bounded loops, statuses. Needs Eigen alone; in double and in float.
#pragma once

// clang-format off: reading order
#include "sepcal/detail/quantity.hpp"              // a name, a unit
#include "sepcal/detail/model.hpp"                 // four tables and one function
#include "sepcal/detail/dual.hpp"                  // its derivatives
#include "sepcal/detail/static_effect.hpp"         // an effect written as a struct
#include "sepcal/static_composition.hpp"    // model + effects
#include "sepcal/detail/static_concatenation.hpp"  // several sensors side by side
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/triad.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/correction.hpp"            // a calibration at work
#include "sepcal/detail/states/information_root.hpp"         // least squares, row by row
#include "sepcal/states/recursive_least_squares.hpp"
#include "sepcal/states/least_squares.hpp"            // iterated
#include "sepcal/detail/states/model_rows.hpp"               // of a separable model
#include "sepcal/detail/states/levenberg_marquardt.hpp"      // a small refinement, row by row
#include "sepcal/detail/states/two_stage_start.hpp"          // a start from nothing, a piece a call
#include "sepcal/states/filter.hpp"                   // Kalman's, in three forms of covariance
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/extended_filter.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "sepcal/states/smoother.hpp"
#include "sepcal/states/state_model.hpp"              // a model with a state
#include "sepcal/states/change_test.hpp"              // when parameters jump, and which
#include "sepcal/frequency/recursive_band.hpp"         // equation error over a band, row by row
#include "sepcal/states/joint_filter.hpp"             // states and parameters together
#include "sepcal/states/recursive_likelihood.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
