// SPDX-License-Identifier: BSD-3-Clause
// The whole engine, in reading order. Files and flights are in sepcal/flight/*.hpp.
#pragma once

// clang-format off: reading order
#include "sepcal/quantity.hpp"           // a name, a unit
#include "sepcal/model.hpp"              // four tables and one function
#include "sepcal/record.hpp"             // measured samples
#include "sepcal/fit.hpp"                // the two-stage estimator
#include "sepcal/options.hpp"            // every choice of a fit
#include "sepcal/stage_one.hpp"          // sampling xi2
#include "sepcal/identifiability.hpp"    // what a record does not determine
#include "sepcal/check_model.hpp"        // what a concept can't check
#include "sepcal/block_model.hpp"        // the narrow waist
#include "sepcal/static_model.hpp"       // from a struct to the waist
#include "sepcal/measurements.hpp"       // a record as a model sees it
#include "sepcal/triangular_factor.hpp"  // everything quadratic about a record
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/scalar_examples.hpp"
#include "sepcal/rotation.hpp"
#include "sepcal/error.hpp"
