// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/aircraft_file.hpp"

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "flight/files/json_values.hpp"
#include "flight/files/text_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace files;  // this room's own

namespace {

template <std::size_t N>
std::array<double, N> read_numbers(const std::string& name, const Json& list) {
  const auto numbers = list.get<std::vector<double>>();
  if (numbers.size() != N) throw Error(name + " needs " + std::to_string(N) + " numbers");
  std::array<double, N> result;
  std::ranges::copy(numbers, result.begin());
  return result;
}

Eigen::Vector3d read_position(const std::string& name, const Json& list) {
  return Eigen::Vector3d(read_numbers<3>(name, list).data());
}

using Reader = std::function<void(AircraftGeometry&, const Json&)>;

Reader length_into(double AircraftGeometry::* member) {
  return [member](AircraftGeometry& to, const Json& value) { to.*member = value.get<double>(); };
}

Reader position_into(const std::string& name, Eigen::Vector3d AircraftGeometry::* member) {
  return [name, member](AircraftGeometry& to, const Json& value) {
    to.*member = read_position(name, value);
  };
}

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{
      {"area_m2", length_into(&AircraftGeometry::area)},
      {"chord_m", length_into(&AircraftGeometry::chord)},
      {"span_m", length_into(&AircraftGeometry::span)},
      {"mass_kg", length_into(&AircraftGeometry::mass)},
      {"inertia_kgm2",
       [](AircraftGeometry& to, const Json& value) {
         const auto I = read_numbers<4>("inertia_kgm2", value);
         to.inertia = {I[0], I[1], I[2], I[3]};
       }},
      {"cg_m", position_into("cg_m", &AircraftGeometry::cg)},
      {"imu_m", position_into("imu_m", &AircraftGeometry::imu)},
      {"vane_m", position_into("vane_m", &AircraftGeometry::vane)},
      {"rate_reference", [](AircraftGeometry& to, const Json& value) {
         to.rate_reference = find_rate_reference(value.get<std::string>());
       }}};
  return all;
}

AircraftGeometry geometry_of(const Json& root) {
  AircraftGeometry geometry;
  for (const auto& [name, value] : entries_of(root)) {
    const auto reader = readers().find(name);
    if (reader == readers().end()) {
      std::string known;
      for (const auto& [key, read] : readers()) known += (known.empty() ? "" : ", ") + key;
      throw Error("'" + name + "' is unknown; known: " + known);
    }
    try {
      reader->second(geometry, value);
    } catch (const Json::exception&) {
      throw Error(name + " is " + describe(value) + ", which is not what it should be");
    }
  }
  for (const char* needed : {"area_m2", "chord_m", "span_m", "mass_kg"}) {
    if (!root.contains(needed)) throw Error(std::string(needed) + " is missing; add it");
  }
  if (!root.contains("rate_reference")) {
    throw Error(R"(rate_reference is missing; say "c/V" or "c/2V": Cm_q differs by 2)");
  }
  check_geometry(geometry);
  return geometry;
}

Json list_of(const Eigen::Vector3d& position) {
  return Json::array({position.x(), position.y(), position.z()});
}

}  // namespace

AircraftGeometry parse_aircraft(std::string_view json, const std::string& source) {
  const Json root = parse_json(json, source);
  if (root.is_discarded() || !root.is_object()) {
    throw Error(source + " is not an aircraft file; give a JSON object {\"area_m2\": ...}");
  }
  try {
    return geometry_of(root);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
}

AircraftGeometry read_aircraft(const std::string& file) {
  return parse_aircraft(read_text_file(file, "as an aircraft file"), file);
}

std::string to_json(const AircraftGeometry& geometry) {
  Json root{{"area_m2", geometry.area},
            {"chord_m", geometry.chord},
            {"span_m", geometry.span},
            {"mass_kg", geometry.mass}};
  const Inertia& inertia = geometry.inertia;
  if (geometry.has_inertia()) {
    root["inertia_kgm2"] = {inertia.Ix, inertia.Iy, inertia.Iz, inertia.Ixz};
  }
  root["cg_m"] = list_of(geometry.cg);
  root["imu_m"] = list_of(geometry.imu);
  root["vane_m"] = list_of(geometry.vane);
  root["rate_reference"] = to_string(geometry.rate_reference);
  return text_of(root);
}

}  // namespace sepcal
