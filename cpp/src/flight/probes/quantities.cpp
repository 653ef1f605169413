// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/quantities.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "sepcal/error.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::probes {
namespace {

using files::UnitKind;

constexpr std::array probe_quantities{
    ProbeQuantity{"time", UnitKind::time},    ProbeQuantity{"roll", UnitKind::angle},
    ProbeQuantity{"pitch", UnitKind::angle},  ProbeQuantity{"yaw", UnitKind::angle},
    ProbeQuantity{"p", UnitKind::rate},       ProbeQuantity{"q", UnitKind::rate},
    ProbeQuantity{"r", UnitKind::rate},       ProbeQuantity{"vn", UnitKind::speed},
    ProbeQuantity{"ve", UnitKind::speed},     ProbeQuantity{"vd", UnitKind::speed},
    ProbeQuantity{"pt", UnitKind::pressure},  ProbeQuantity{"ps", UnitKind::pressure},
    ProbeQuantity{"dpa", UnitKind::pressure}, ProbeQuantity{"dpb", UnitKind::pressure},
    ProbeQuantity{"rho", UnitKind::density},  ProbeQuantity{"temp", UnitKind::temperature, true},
};

constexpr std::array tube_quantities{
    ProbeQuantity{"time", UnitKind::time},
    ProbeQuantity{"roll", UnitKind::angle, false, true},
    ProbeQuantity{"pitch", UnitKind::angle, false, true},
    ProbeQuantity{"yaw", UnitKind::angle, false, true},
    ProbeQuantity{"p", UnitKind::rate, false, true},
    ProbeQuantity{"q", UnitKind::rate, false, true},
    ProbeQuantity{"r", UnitKind::rate, false, true},
    ProbeQuantity{"vn", UnitKind::speed},
    ProbeQuantity{"ve", UnitKind::speed},
    ProbeQuantity{"vd", UnitKind::speed},
    ProbeQuantity{"airspeed", UnitKind::speed},
    ProbeQuantity{"dp", UnitKind::pressure},
    ProbeQuantity{"ps", UnitKind::pressure},
    ProbeQuantity{"rho", UnitKind::density},
    ProbeQuantity{"temp", UnitKind::temperature, true},
};

constexpr std::array field_quantities{
    ProbeQuantity{"time", UnitKind::time},
    ProbeQuantity{"mx", UnitKind::field},
    ProbeQuantity{"my", UnitKind::field},
    ProbeQuantity{"mz", UnitKind::field},
    ProbeQuantity{"hx", UnitKind::field},
    ProbeQuantity{"hy", UnitKind::field},
    ProbeQuantity{"hz", UnitKind::field},
    ProbeQuantity{"roll", UnitKind::angle},
    ProbeQuantity{"pitch", UnitKind::angle},
    ProbeQuantity{"yaw", UnitKind::angle},
    ProbeQuantity{"p", UnitKind::rate, false, true},
    ProbeQuantity{"q", UnitKind::rate, false, true},
    ProbeQuantity{"r", UnitKind::rate, false, true},
    ProbeQuantity{"bn", UnitKind::field},
    ProbeQuantity{"be", UnitKind::field},
    ProbeQuantity{"bd", UnitKind::field},
    ProbeQuantity{"field_strength", UnitKind::field},
};

constexpr std::array aircraft_quantities{
    ProbeQuantity{"time", UnitKind::time},
    ProbeQuantity{"ax", UnitKind::acceleration},
    ProbeQuantity{"ay", UnitKind::acceleration},
    ProbeQuantity{"az", UnitKind::acceleration},
    ProbeQuantity{"p", UnitKind::rate},
    ProbeQuantity{"q", UnitKind::rate},
    ProbeQuantity{"r", UnitKind::rate},
    ProbeQuantity{"airspeed", UnitKind::speed},
    ProbeQuantity{"alpha", UnitKind::angle},
    ProbeQuantity{"beta", UnitKind::angle},
    ProbeQuantity{"roll", UnitKind::angle},
    ProbeQuantity{"pitch", UnitKind::angle},
    ProbeQuantity{"yaw", UnitKind::angle},
    ProbeQuantity{"vn", UnitKind::speed},
    ProbeQuantity{"ve", UnitKind::speed},
    ProbeQuantity{"vd", UnitKind::speed},
    ProbeQuantity{"elevator", UnitKind::angle},
    ProbeQuantity{"aileron", UnitKind::angle},
    ProbeQuantity{"rudder", UnitKind::angle},
    ProbeQuantity{"throttle", UnitKind::share},
    ProbeQuantity{"thrust", UnitKind::force},
    ProbeQuantity{"mass", UnitKind::mass},
    ProbeQuantity{"rho", UnitKind::density},
    ProbeQuantity{"qbar", UnitKind::pressure},
    ProbeQuantity{"ps", UnitKind::pressure},
    ProbeQuantity{"temp", UnitKind::temperature, true},
    ProbeQuantity{"pdot", UnitKind::angular_acceleration},
    ProbeQuantity{"qdot", UnitKind::angular_acceleration},
    ProbeQuantity{"rdot", UnitKind::angular_acceleration},
};

}  // namespace

bool has_state(std::string_view model) {
  return model == "path" || model == "longitudinal" || model == "lateral" || model == "six-dof";
}

std::span<const ProbeQuantity> quantities_of(std::string_view model) {
  if (model == "five-hole") return probe_quantities;
  if (model == "pitot-static") return tube_quantities;
  if (model == "magnetometer" || model == "magnetometer-norm") return field_quantities;
  if (model == "aero" || has_state(model)) return aircraft_quantities;
  throw Error("there is no model '" + std::string(model) + "'");
}

ModelQuantities::ModelQuantities(std::string_view name) : model(name), list(quantities_of(name)) {}

ModelQuantities::ModelQuantities(const Probe& probe)
    : model(probe.name()), list(probe.quantities()) {}

logs::RowTruth rows_taken(const ModelQuantities& model, const Flight& flight,
                          const LogChoice& choice) {
  const std::span<const ProbeQuantity> quantities = model.list;
  const auto find = [&](const std::string& name) -> std::optional<files::LoggedQuantity> {
    const auto quantity = std::ranges::find(quantities, name, &ProbeQuantity::name);
    if (quantity == quantities.end()) return std::nullopt;
    return files::find_quantity(flight, quantity->name, quantity->kind, quantity->bare);
  };
  const logs::RowTruth within = logs::rows_within_times(flight, choice);
  const logs::RowTruth holds = logs::rows_where(flight, choice, find);
  if (!within || !holds) return within ? within : holds;
  return [within, holds](std::size_t row) { return within(row) && holds(row); };
}

}  // namespace sepcal::probes

namespace sepcal {

std::span<const probes::ProbeQuantity> Probe::quantities() const {
  return probes::quantities_of(name());
}

}  // namespace sepcal
