// SPDX-License-Identifier: BSD-3-Clause
// The whole engine, in reading order. Files and flights are in sepcal/flight/*.hpp.
#pragma once

// clang-format off: reading order
#include "sepcal/quantity.hpp"           // a name, a unit
#include "sepcal/tables.hpp"             // a model's, at run time
#include "sepcal/model.hpp"              // four tables and one function
#include "sepcal/record.hpp"             // measured samples
#include "sepcal/fit.hpp"                // the two-stage estimator
#include "sepcal/choices.hpp"            // what options choose among, by name
#include "sepcal/options.hpp"            // every choice of a fit
#include "sepcal/fit_many.hpp"           // many flights, jointly
#include "sepcal/fit_trials.hpp"         // many trials of one design
#include "sepcal/stage_one.hpp"          // sampling xi2
#include "sepcal/identifiability.hpp"    // what a record does not determine
#include "sepcal/profile.hpp"            // intervals where standard errors mislead
#include "sepcal/prediction.hpp"         // what a fit says of other samples
#include "sepcal/certificate.hpp"        // what is proven of a cost
#include "sepcal/rivals/single_stage.hpp"       // what the estimator is measured against
#include "sepcal/rivals/haupt_kasdin.hpp"
#include "sepcal/rivals/two_step_problems.hpp"
#include "sepcal/rivals/alonso_shuster.hpp"
#include "sepcal/check_model.hpp"        // what a concept can't check
#include "sepcal/block_model.hpp"        // the narrow waist
#include "sepcal/static_model.hpp"       // from a struct to the waist
#include "sepcal/static_concatenation.hpp" // several sensors side by side
#include "sepcal/concatenation.hpp"      // the same at run time
#include "sepcal/detail/joined_tables.hpp"
#include "sepcal/dual.hpp"               // derivatives in flight
#include "sepcal/detail/nested_dual.hpp" // second derivatives
#include "sepcal/natural_spline.hpp"     // smooth functions
#include "sepcal/driver.hpp"             // what drives an effect
#include "sepcal/effect.hpp"             // a physical term that a model lacks
#include "sepcal/static_effect.hpp"      // an effect written as a struct
#include "sepcal/run_time_effect.hpp"    // from it to one chosen by name
#include "sepcal/static_composition.hpp" // model + effects, while compiling
#include "sepcal/composition.hpp"        // the same at run time
#include "sepcal/channel_product.hpp"    // alpha*elevator
#include "sepcal/effect_name.hpp"        // port[driver]
#include "sepcal/named_effects.hpp"      // effects by name
#include "sepcal/fit_with_effects.hpp"   // a fit of any model with them
#include "sepcal/effects/air_data.hpp"
#include "sepcal/effects/magnetic.hpp"
#include "sepcal/triangular_factor.hpp"  // everything quadratic about a record
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/vane_boom.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/triad.hpp"       // the canonical form of a sensor of three axes
#include "sepcal/models/scalar_examples.hpp"
#include "sepcal/models/damped_sinusoids.hpp" // Prony's problem
#include "sepcal/detail/compiled_models.hpp" // those that the library has compiled
#include "sepcal/states/state_model.hpp"       // a model with a state
#include "sepcal/states/trajectory_options.hpp"
#include "sepcal/states/trajectory_model.hpp"  // from it to the waist, along a record
#include "sepcal/states/smooth_record.hpp"  // states and process noise along a record
#include "sepcal/states/integration.hpp"
#include "sepcal/detail/states/trajectory_plan.hpp"
#include "sepcal/states/track.hpp"             // estimates against time
#include "sepcal/states/stream_start.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/states/reconstruct.hpp"  // what was flown
#include "sepcal/aircraft/geometry.hpp"        // an aircraft as its equations of motion know it
#include "sepcal/aircraft/equations.hpp"       // coefficients as sums of regressors
#include "sepcal/aircraft/coefficients.hpp"    // those that a flight had
#include "sepcal/aircraft/aero_model.hpp"      // equation error
#include "sepcal/aircraft/two_step.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/aircraft/rigid_aircraft.hpp"  // six degrees of freedom
#include "sepcal/noise_model.hpp"        // the noise of residuals
#include "sepcal/rotation.hpp"
#include "sepcal/solver_log.hpp"         // Ceres and glog silenced
#include "sepcal/eigen.hpp"              // aligned alike on both sides
#include "sepcal/stop.hpp"               // long work that ends early
#include "sepcal/option_error.hpp"       // misuse that an option avoids
#include "sepcal/error.hpp"
