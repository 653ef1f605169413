// SPDX-License-Identifier: BSD-3-Clause
// The models that the library has compiled: who fits one of them and includes this need not compile
// it once more.
#pragma once

#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/triad.hpp"
#include "sepcal/models/vane_boom.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

template <>
const LaneKernel& lane_kernel<VaneBoom>();

extern template class StaticModel<Accelerometer>;
extern template class StaticModel<AttitudeIndependentMagnetometer>;
extern template class StaticModel<FiveHoleProbe>;
extern template class StaticModel<Magnetometer>;
extern template class StaticModel<PitotStatic>;
extern template class StaticModel<ScalarExample1>;
extern template class StaticModel<ScalarExample2>;
extern template class StaticModel<VaneBoom>;

}  // namespace sepcal
