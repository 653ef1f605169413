// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/short_number.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

void check_positive(std::string_view what, double value, std::string_view unit) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw Error("the aircraft's " + std::string(what) + " is " + base::short_number(value) + " " +
              std::string(unit) + "; it must be above zero");
}

void check_inertia(const Inertia& inertia) {
  check_positive("Ix", inertia.Ix, "kg m^2");
  check_positive("Iy", inertia.Iy, "kg m^2");
  check_positive("Iz", inertia.Iz, "kg m^2");
  if (!(inertia.Ixz * inertia.Ixz < inertia.Ix * inertia.Iz)) {
    throw Error("the aircraft's Ixz is " + base::short_number(inertia.Ixz) +
                " kg m^2; of a body its square is below Ix Iz: check the units");
  }
  const double sum = inertia.Ix + inertia.Iy + inertia.Iz;
  const double largest = std::max({inertia.Ix, inertia.Iy, inertia.Iz});
  if (largest <= sum - largest) return;
  throw Error(
      "of the aircraft's Ix, Iy and Iz one is larger than the sum of the others, as of no body; "
      "they are given in the order Ix, Iy, Iz, Ixz");
}

void check_position(std::string_view what, const Eigen::Vector3d& position) {
  if (position.allFinite()) return;
  throw Error("the aircraft's " + std::string(what) + " position is not three numbers, m");
}

}  // namespace

std::string_view to_string(RateReference reference) {
  return reference == RateReference::chord_per_speed ? "c/V" : "c/2V";
}

RateReference find_rate_reference(std::string_view name) {
  for (const RateReference reference :
       {RateReference::chord_per_speed, RateReference::chord_per_twice_speed}) {
    if (name == to_string(reference)) return reference;
  }
  throw Error("there is no rate reference '" + std::string(name) +
              "'; q_hat is q times c/V or c/2V: name one of these two");
}

bool AircraftGeometry::has_inertia() const {
  return !std::isnan(inertia.Ix) && !std::isnan(inertia.Iy) && !std::isnan(inertia.Iz);
}

void check_geometry(const AircraftGeometry& geometry) {
  check_positive("area", geometry.area, "m^2");
  check_positive("chord", geometry.chord, "m");
  check_positive("span", geometry.span, "m");
  check_positive("mass", geometry.mass, "kg");
  if (geometry.chord > geometry.span) {
    throw Error("the aircraft's chord, " + base::short_number(geometry.chord) +
                " m, is longer than its span, " + base::short_number(geometry.span) +
                " m; they are probably exchanged");
  }
  if (geometry.has_inertia()) check_inertia(geometry.inertia);
  check_position("cg", geometry.cg);
  check_position("imu", geometry.imu);
  check_position("vane", geometry.vane);
}

}  // namespace sepcal
