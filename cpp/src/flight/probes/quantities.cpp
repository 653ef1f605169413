// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/quantities.hpp"

#include <array>
#include <string>

#include "sepcal/error.hpp"

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
    ProbeQuantity{"roll", UnitKind::angle},
    ProbeQuantity{"pitch", UnitKind::angle},
    ProbeQuantity{"yaw", UnitKind::angle},
    ProbeQuantity{"p", UnitKind::rate},
    ProbeQuantity{"q", UnitKind::rate},
    ProbeQuantity{"r", UnitKind::rate},
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
    ProbeQuantity{"p", UnitKind::rate},
    ProbeQuantity{"q", UnitKind::rate},
    ProbeQuantity{"r", UnitKind::rate},
    ProbeQuantity{"bn", UnitKind::field},
    ProbeQuantity{"be", UnitKind::field},
    ProbeQuantity{"bd", UnitKind::field},
    ProbeQuantity{"field_strength", UnitKind::field},
};

}  // namespace

std::span<const ProbeQuantity> quantities_of(std::string_view model) {
  if (model == "five-hole") return probe_quantities;
  if (model == "pitot-static") return tube_quantities;
  if (model == "magnetometer" || model == "magnetometer-norm") return field_quantities;
  throw Error("there is no model '" + std::string(model) + "'");
}

}  // namespace sepcal::probes
