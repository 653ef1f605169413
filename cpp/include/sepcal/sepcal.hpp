// SPDX-License-Identifier: BSD-3-Clause
// The whole engine, in reading order. Files and flights are in sepcal/flight/*.hpp.
#pragma once

// clang-format off: reading order
#include "sepcal/quantity.hpp"           // a name, a unit
#include "sepcal/model.hpp"              // four tables and one function
#include "sepcal/record.hpp"             // measured samples
#include "sepcal/fit.hpp"                // the two-stage estimator
#include "sepcal/choices.hpp"            // what options choose among, by name
#include "sepcal/options.hpp"            // every choice of a fit
#include "sepcal/fit_many.hpp"           // many flights, jointly
#include "sepcal/stage_one.hpp"          // sampling xi2
#include "sepcal/identifiability.hpp"    // what a record does not determine
#include "sepcal/profile.hpp"            // intervals where standard errors mislead
#include "sepcal/prediction.hpp"         // what a fit says of other samples
#include "sepcal/check_model.hpp"        // what a concept can't check
#include "sepcal/block_model.hpp"        // the narrow waist
#include "sepcal/static_model.hpp"       // from a struct to the waist
#include "sepcal/nested_dual.hpp"        // second derivatives
#include "sepcal/natural_spline.hpp"     // smooth functions
#include "sepcal/driver.hpp"             // what drives an effect
#include "sepcal/effect.hpp"             // a physical term that a model lacks
#include "sepcal/static_effect.hpp"      // an effect written as a struct
#include "sepcal/static_composition.hpp" // model + effects, while compiling
#include "sepcal/composition.hpp"        // the same at run time
#include "sepcal/effect_name.hpp"        // port[driver]
#include "sepcal/named_effects.hpp"      // effects by name
#include "sepcal/fit_with_effects.hpp"   // a fit of any model with them
#include "sepcal/effects/air_data.hpp"
#include "sepcal/effects/magnetic.hpp"
#include "sepcal/triangular_factor.hpp"  // everything quadratic about a record
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/scalar_examples.hpp"
#include "sepcal/noise_model.hpp"        // the noise of residuals
#include "sepcal/rotation.hpp"
#include "sepcal/solver_log.hpp"         // Ceres and glog silenced
#include "sepcal/eigen.hpp"              // aligned alike on both sides
#include "sepcal/option_error.hpp"       // misuse that an option avoids
#include "sepcal/error.hpp"
