// SPDX-License-Identifier: BSD-3-Clause
// The models that sepcal brings, compiled once: who fits them doesn't differentiate them again.
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/triad.hpp"
#include "sepcal/models/vane_boom.hpp"

namespace sepcal {

template class StaticModel<Accelerometer>;
template class StaticModel<AttitudeIndependentMagnetometer>;
template class StaticModel<FiveHoleProbe>;
template class StaticModel<Magnetometer>;
template class StaticModel<PitotStatic>;
template class StaticModel<ScalarExample1>;
template class StaticModel<ScalarExample2>;
template class StaticModel<VaneBoom>;

}  // namespace sepcal
