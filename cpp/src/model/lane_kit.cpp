// SPDX-License-Identifier: BSD-3-Clause
#include "model/lane_kit.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/models/scalar_examples.hpp"

namespace sepcal {
namespace lanes {

extern const LaneKit baseline;
#ifdef SEPCAL_WIDE_KITS
extern const LaneKit avx2;
extern const LaneKit avx512;
#endif

namespace {

/// Those that the processor takes, the widest first.
std::vector<const LaneKit*> find_kits() {
  std::vector<const LaneKit*> kits;
#ifdef SEPCAL_WIDE_KITS
  if (__builtin_cpu_supports("x86-64-v4")) kits.push_back(&avx512);
  if (__builtin_cpu_supports("x86-64-v3")) kits.push_back(&avx2);
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

}  // namespace sepcal
