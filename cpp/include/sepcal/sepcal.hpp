// SPDX-License-Identifier: BSD-3-Clause
// The whole engine, in reading order. Files and flights are in sepcal/flight/*.hpp.
#pragma once

// clang-format off: reading order
#include "sepcal/detail/quantity.hpp"           // a name, a unit
#include "sepcal/detail/tables.hpp"             // a model's, at run time
#include "sepcal/detail/model.hpp"              // four tables and one function
#include "sepcal/record.hpp"             // measured samples
#include "sepcal/fit.hpp"                // the two-stage estimator
#include "sepcal/detail/choices.hpp"            // what options choose among, by name
#include "sepcal/options.hpp"            // every choice of a fit
#include "sepcal/fit_many.hpp"           // many flights, jointly
#include "sepcal/fit_trials.hpp"         // many trials of one design
#include "sepcal/detail/stage_one.hpp"          // sampling xi2
#include "sepcal/detail/identifiability.hpp"    // what a record does not determine
#include "sepcal/profile.hpp"            // intervals where standard errors mislead
#include "sepcal/prediction.hpp"         // what a fit says of other samples
#include "sepcal/collinearity.hpp"       // estimates that are hardly told apart
#include "sepcal/certificate.hpp"        // what is proven of a cost
#include "sepcal/detail/rivals/single_stage.hpp"       // what the estimator is measured against
#include "sepcal/detail/rivals/haupt_kasdin.hpp"
#include "sepcal/detail/rivals/two_step_problems.hpp"
#include "sepcal/detail/rivals/alonso_shuster.hpp"
#include "sepcal/check_model.hpp"        // what a concept can't check
#include "sepcal/detail/block_model.hpp"        // the narrow waist
#include "sepcal/static_model.hpp"       // from a struct to the waist
#include "sepcal/detail/static_concatenation.hpp" // several sensors side by side
#include "sepcal/concatenation.hpp"      // the same at run time
#include "sepcal/detail/joined_tables.hpp"
#include "sepcal/detail/dual.hpp"               // derivatives in flight
#include "sepcal/detail/nested_dual.hpp" // second derivatives
#include "sepcal/detail/natural_spline.hpp"     // smooth functions
#include "sepcal/detail/driver.hpp"             // what drives an effect
#include "sepcal/detail/effect.hpp"             // a physical term that a model lacks
#include "sepcal/detail/static_effect.hpp"      // an effect written as a struct
#include "sepcal/detail/run_time_effect.hpp"    // from it to one chosen by name
#include "sepcal/static_composition.hpp" // model + effects, while compiling
#include "sepcal/composition.hpp"        // the same at run time
#include "sepcal/detail/channel_product.hpp"    // alpha*elevator
#include "sepcal/effect_name.hpp"        // port[driver]
#include "sepcal/detail/named_effects.hpp"      // effects by name
#include "sepcal/fit_with_effects.hpp"   // a fit of any model with them
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/triangular_factor.hpp"  // everything quadratic about a record
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/vane_boom.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/triad.hpp"       // the canonical form of a sensor of three axes
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/models/damped_sinusoids.hpp" // Prony's problem
#include "sepcal/detail/compiled_models.hpp" // those that the library has compiled
#include "sepcal/states/state_model.hpp"       // a model with a state
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/states/trajectory_model.hpp"  // from it to the waist, along a record
#include "sepcal/states/smooth_record.hpp"  // states and process noise along a record
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/trajectory_plan.hpp"
#include "sepcal/states/track.hpp"             // estimates against time
#include "sepcal/states/stream_start.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/states/reconstruct.hpp"  // what was flown
#include "sepcal/aircraft/geometry.hpp"        // an aircraft as its equations of motion know it
#include "sepcal/detail/aircraft/equations.hpp"       // coefficients as sums of regressors
#include "sepcal/detail/aircraft/coefficients.hpp"    // those that a flight had
#include "sepcal/aircraft/aero_model.hpp"      // equation error
#include "sepcal/detail/band.hpp"              // of frequencies
#include "sepcal/detail/frequency/transform.hpp"      // a record over a band of frequencies
#include "sepcal/frequency/fit_in_band.hpp"    // equation error there
#include "sepcal/frequency/output_error_in_band.hpp"
#include "sepcal/frequency/response.hpp"       // one column to others, without a model
#include "sepcal/frequency/input_design.hpp"   // what to fly
#include "sepcal/aircraft/two_step.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/aircraft/rigid_aircraft.hpp"  // six degrees of freedom
#include "sepcal/noise_model.hpp"        // the noise of residuals
#include "sepcal/detail/rotation.hpp"
#include "sepcal/detail/solver_log.hpp"         // Ceres and glog silenced
#include "sepcal/detail/eigen.hpp"              // aligned alike on both sides
#include "sepcal/stop.hpp"               // long work that ends early
#include "sepcal/error.hpp"
