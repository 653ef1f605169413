// SPDX-License-Identifier: BSD-3-Clause
#include "model/lane_kit.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/vane_boom.hpp"

namespace sepcal {
namespace lanes {

extern const LaneKit baseline;
#ifdef SEPCAL_WIDE_KITS
extern const LaneKit avx2;
extern const LaneKit avx512;
#endif

namespace {

#ifdef SEPCAL_WIDE_KITS
/// What -march=x86-64-v3 and -march=x86-64-v4 take for granted of arithmetic; clang knows no names
/// for the whole.
bool takes_avx2() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
}

bool takes_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
#endif

/// Those that the processor takes, the widest first.
std::vector<const LaneKit*> find_kits() {
  std::vector<const LaneKit*> kits;
#ifdef SEPCAL_WIDE_KITS
  if (takes_avx2() && takes_avx512()) kits.push_back(&avx512);
  if (takes_avx2()) kits.push_back(&avx2);
#endif
  kits.push_back(&baseline);
  return kits;
}

const std::vector<const LaneKit*>& kits() {
  static const std::vector<const LaneKit*> found = find_kits();
  return found;
}

const LaneKit& choose() {
  const char* asked = std::getenv("SEPCAL_ISA");
  if (asked == nullptr || *asked == '\0') return *kits().front();
  std::string known;
  for (const LaneKit* kit : kits()) {
    if (std::string_view(kit->name) == asked) return *kit;
    known += (known.empty() ? "" : ", ") + std::string(kit->name);
  }
  throw Error(std::string("SEPCAL_ISA is ") + asked + "; this processor takes " + known);
}

}  // namespace

Panel stack_panel(const LaneKit& kit, std::size_t columns, double* T, double* rows, std::size_t m) {
  Panel panel{.T = T, .count = columns};
  for (std::size_t c = 0; c < columns; ++c) panel.columns[c] = rows + c * m * kit.width;
  return panel;
}

bool absorb_panels(const LaneKit& kit, std::span<const Panel> panels, std::size_t m) {
  bool safe = true;
  while (!panels.empty()) {
    const std::size_t columns = panels.front().count;
    std::size_t alike = 1;
    while (alike < std::min(most_panels, panels.size()) && panels[alike].count == columns) ++alike;
    safe = kit.absorb[columns](panels.data(), alike, m) && safe;
    panels = panels.subspan(alike);
  }
  return safe;
}

const LaneKit& lane_kit() {
  static const LaneKit& chosen = choose();
  return chosen;
}

const LaneKit* lane_kit_of(std::size_t width) {
  if (lane_kit().width == width) return &lane_kit();
  const auto found = std::ranges::find(kits(), width, &LaneKit::width);
  return found == kits().end() ? nullptr : *found;
}

namespace {

const LaneKernel& kernel_of(ShippedModel model) {
  return lane_kit().models[static_cast<std::size_t>(model)];
}

}  // namespace
}  // namespace lanes

using lanes::ShippedModel;

template <>
const LaneKernel& lane_kernel<AttitudeIndependentMagnetometer>() {
  return lanes::kernel_of(ShippedModel::attitude_independent);
}

template <>
const LaneKernel& lane_kernel<FiveHoleProbe>() {
  return lanes::kernel_of(ShippedModel::five_hole);
}

template <>
const LaneKernel& lane_kernel<Magnetometer>() {
  return lanes::kernel_of(ShippedModel::magnetometer);
}

template <>
const LaneKernel& lane_kernel<PitotStatic>() {
  return lanes::kernel_of(ShippedModel::pitot_static);
}

template <>
const LaneKernel& lane_kernel<ScalarExample1>() {
  return lanes::kernel_of(ShippedModel::scalar_1);
}

template <>
const LaneKernel& lane_kernel<ScalarExample2>() {
  return lanes::kernel_of(ShippedModel::scalar_2);
}

template <>
const LaneKernel& lane_kernel<VaneBoom>() {
  return lanes::kernel_of(ShippedModel::vane_boom);
}

}  // namespace sepcal
