// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, with SEPCAL_KIT the name of what it gives. Nothing but
// that name may be seen outside: inline functions that others have too are of another instruction
// set here.
#include "model/lane_factor.hpp"
#include "model/lane_kit.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/lanes.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/vane_boom.hpp"

#define SEPCAL_TEXT_OF(name) #name
#define SEPCAL_TEXT(name) SEPCAL_TEXT_OF(name)

namespace sepcal::lanes {
namespace {

using Arch = xsimd::default_arch;

template <std::size_t... n>
constexpr auto absorbers(std::index_sequence<n...> /*columns*/) {
  return std::array<AbsorbPanels, sizeof...(n) + 1>{nullptr, &LaneFactor<Arch, n + 1>::absorb...};
}

}  // namespace

extern const LaneKit SEPCAL_KIT;
constinit const LaneKit SEPCAL_KIT{SEPCAL_TEXT(SEPCAL_KIT),
                                   Batch<Arch>::size,
                                   {kernel_for<Arch, AttitudeIndependentMagnetometer>,
                                    kernel_for<Arch, FiveHoleProbe>, kernel_for<Arch, Magnetometer>,
                                    kernel_for<Arch, PitotStatic>, kernel_for<Arch, ScalarExample1>,
                                    kernel_for<Arch, ScalarExample2>, kernel_for<Arch, VaneBoom>},
                                   absorbers(std::make_index_sequence<most_columns>())};

}  // namespace sepcal::lanes
