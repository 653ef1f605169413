// SPDX-License-Identifier: BSD-3-Clause
// The kits of the four probes: every effect of the catalogue is made on a simulated flight, its
// derivatives are those of its values, and what it needs is asked for.
#include "sepcal/detail/flight/probe_effects.hpp"

#include <algorithm>
#include <cmath>

#include "block_inputs.hpp"
#include "dense_reference.hpp"
#include "flights_with_effects.hpp"
#include "sepcal/check_model.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/detail/run_time_effect.hpp"

namespace probe_effects_test {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

struct OwnUpwash {
  static constexpr std::array inputs{Quantity{"throttle", ""}};
  static constexpr std::array linear{Quantity{"upwash.mine", "m/s"}};
  static constexpr std::array<Quantity, 0> nonlinear{};

  template <class U, class X>
  Eigen::Matrix<U, 3, 1> columns(const Vec<U, 1>& u, const Vec<X, 0>& /*xi2*/) const {
    return {U(0.0), U(0.0), u[0]};
  }
};

/// The catalogue's name with a logged column for DRIVER.
std::string with_driver(std::string_view probe, std::string_view catalogued) {
  std::string name(catalogued);
  const std::size_t at = name.find("DRIVER");
  if (at == std::string::npos) return name;
  const bool of_air = probe == "five-hole" || probe == "pitot-static";
  return name.replace(at, 6, of_air ? "throttle" : "current_a");
}

EffectiveFlight prepare(const Probe& probe, const Flight& flight, const std::string& effect) {
  std::vector<EffectSetting> settings{{.name = effect}};
  return with_effects(probe, flight, probe.prepare(flight, {}), settings, {});
}

/// The middle of the bounds and a little more; one where there are none.
VectorXd away_from_zero(const std::vector<Variable>& parameters) {
  VectorXd values(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < values.size(); ++k) {
    const Variable& at = parameters[static_cast<std::size_t>(k)];
    const double width = at.upper - at.lower;
    values[k] = std::isfinite(width) ? at.lower + 0.52 * width : 1.0;
  }
  return values;
}

/// D of [A | D | r] against differences, a column at a time; a step's time has no derivative.
void check_derivatives(const BlockModel& model, const Record& record) {
  const Tables& tables = model.tables();
  const VectorXd xi1 = away_from_zero(tables.linear);
  const VectorXd xi2 = away_from_zero(tables.nonlinear);
  const Eigen::MatrixXd expected = dense_rows(model, record, xi1, xi2);
  Index offset = 0;
  const auto total = static_cast<Index>(record.rows());
  for (const Segment& segment : record.segments()) {
    const BlockInputs inputs = block_inputs(model, record, segment.first);
    const auto rows = static_cast<Index>(segment.rows());
    Eigen::MatrixXd part(tables.n_z() * rows, xi1.size() + xi2.size() + 1);
    model.evaluate({inputs.pointers, segment.rows(), segment.first, true}, values_of(xi2),
                   values_of(xi1), nullptr, part);
    for (Index k = 0; k < xi2.size(); ++k) {
      CAPTURE(tables.nonlinear[static_cast<std::size_t>(k)].name);
      const auto numeric = expected.col(xi1.size() + k);
      const double scale = numeric.cwiseAbs().maxCoeff();
      for (Index j = 0; j < tables.n_z(); ++j) {
        const VectorXd difference = part.col(xi1.size() + k).segment(j * rows, rows) -
                                    numeric.segment(j * total + offset, rows);
        REQUIRE(difference.cwiseAbs().maxCoeff() <= 1e-7 * scale);
      }
    }
    offset += rows;
  }
}

}  // namespace

TEST_CASE("every effect of the catalogue is made, has its derivatives and passes check_model()") {
  for (const char* name : all_probes) {
    CAPTURE(name);
    const auto probe = make_probe_called(name);
    const Flight flight = make_flight(fly(name, {}, {.noise = 0.1, .seed = 5}));
    REQUIRE(!effect_catalogue(name).empty());
    for (const CataloguedEffect& catalogued : effect_catalogue(name)) {
      const std::string effect = with_driver(name, catalogued.name);
      CAPTURE(effect);
      const EffectiveFlight made = prepare(*probe, flight, effect);
      REQUIRE(made.effects.size() == 1);
      const auto parameters = made.model->tables().parameters();
      CHECK(parameters.size() > probe->model().tables().parameters().size());
      CHECK_NOTHROW(check_model(*made.model, made.prepared.record));
      check_derivatives(*made.model, made.prepared.record);
    }
  }
}

TEST_CASE("the catalogue's unit is that of the coefficients") {
  for (const char* name : all_probes) {
    const auto probe = make_probe_called(name);
    const Flight flight = make_flight(fly(name, {}));
    for (const CataloguedEffect& catalogued : effect_catalogue(name)) {
      if (catalogued.name.find("DRIVER") != std::string_view::npos) continue;
      CAPTURE(catalogued.name);
      const EffectiveFlight made = prepare(*probe, flight, std::string(catalogued.name));
      const Effect& effect = made.effects.front();
      std::vector<std::string> units;
      for (const Variable& parameter : made.model->tables().parameters()) {
        const bool own = parameter.name.starts_with(effect.name + ".");
        const bool shape = effect.driver && effect.driver->shape() &&
                           parameter.name == effect.name + "." + effect.driver->shape()->name;
        if (!own || shape || std::ranges::find(units, parameter.unit) != units.end()) continue;
        units.push_back(parameter.unit);
      }
      std::string text;
      for (const std::string& unit : units) text += (text.empty() ? "" : ", ") + unit;
      CHECK(text == catalogued.unit);
    }
  }
}

TEST_CASE(
    "physics bounds every coefficient of the catalogue, from either side of zero or from it") {
  for (const char* name : all_probes) {
    const auto probe = make_probe_called(name);
    const Flight flight = make_flight(fly(name, {}));
    for (const CataloguedEffect& catalogued : effect_catalogue(name)) {
      const std::string effect = with_driver(name, catalogued.name);
      const EffectiveFlight made = prepare(*probe, flight, effect);
      const Effect& own = made.effects.front();
      for (const Variable& parameter : made.model->tables().parameters()) {
        if (!parameter.name.starts_with(own.name + ".")) continue;
        CAPTURE(parameter.name);
        const Interval range = plausible_range(own, parameter, made.prepared.record);
        CHECK(std::isfinite(range.upper - range.lower));
        CHECK(range.lower < range.upper);
        const bool is_shape = own.driver && own.driver->shape() &&
                              parameter.name == own.name + "." + own.driver->shape()->name;
        if (!is_shape) CHECK((range.lower <= 0.0 && range.upper > 0.0));
      }
    }
  }
}

TEST_CASE("air is compressed once, and a wind blows at 200 m/s at most") {
  const auto probe = make_probe_called("five-hole");
  const Flight flight = make_flight(fly("five-hole", {}));
  const auto range_of = [&](const std::string& effect, const std::string& parameter) {
    const EffectiveFlight made = prepare(*probe, flight, effect);
    return plausible_range(made.effects.front(), {parameter, ""}, made.prepared.record);
  };
  const Interval compressed = range_of("compressibility", "compressibility.s");
  CHECK(compressed.lower == 0.0);
  CHECK(compressed.upper == 3.0);
  const Interval labelled = range_of("wind[maneuver]", "wind[maneuver].n");
  CHECK(labelled.upper == 200.0);
  const auto& throttle = flight.find("throttle")->values;
  const Interval driven = range_of("wind[throttle]", "wind[throttle].e");
  CHECK(driven.upper == doctest::Approx(200.0 / *std::ranges::max_element(throttle)));
  CHECK(driven.lower == -driven.upper);
}

TEST_CASE("aliases become the effect that they stand for") {
  const Flight flight = make_flight(fly("five-hole", {}));
  std::vector<EffectSetting> settings{
      {.name = " wind_shear "}, {.name = "wind_drift"}, {.name = "propwash"}};
  const auto probe = make_probe_called("five-hole");
  with_effects(*probe, flight, probe->prepare(flight, {}), settings, {});
  CHECK(settings[0].name == "wind[altitude_m]");
  CHECK(settings[1].name == "wind[time]");
  CHECK(settings[2].name == "pressure_offset[throttle]");
}

TEST_CASE("an alias with no column to mean, or two, is refused") {
  SimulatedFlight simulated = fly("five-hole", {});
  const auto probe = make_probe_called("five-hole");
  const auto shear = [&] { prepare(*probe, make_flight(simulated), "wind_shear"); };
  simulated.columns.push_back({"altitude_ft", simulated.column("altitude_m")});
  check_refused(shear, {"effect wind_shear could be driven by altitude_m, altitude_ft",
                        "write wind[COLUMN]"});
  std::erase_if(simulated.columns, [](const auto& at) { return at.name.starts_with("altitude"); });
  check_refused(shear, {"effect wind_shear needs a column altitude*", "doesn't log"});
}

TEST_CASE("what an effect needs and the flight doesn't log is named") {
  SimulatedFlight simulated = fly("five-hole", {});
  std::erase_if(simulated.columns, [](const SimulatedColumn& column) {
    return column.name.ends_with("_radps") || column.name == "temp_k";
  });
  const Flight flight = make_flight(simulated);
  const auto probe = five_hole_probe(4.5, 4.5, {0, 0, 0});
  const auto refused = [&](const char* effect, std::initializer_list<std::string_view> words) {
    CAPTURE(effect);
    check_refused([&] { prepare(*probe, flight, effect); }, words);
  };
  refused("lever_arm", {"flight: effect lever_arm needs p, q, r, which the flight doesn't log"});
  refused("upwash", {"effect upwash needs q, which"});
  refused("sidewash", {"effect sidewash needs p, which"});
  refused("density_error", {"effect density_error needs temperature, which"});
  refused("alpha_offset[q]", {"effect alpha_offset[q]", "'q' is constant"});
  refused("wind[flaps]", {"effect wind[flaps]", "no channel 'flaps'", "he record has: time, "});
  refused("lift", {"there is no effect 'lift'; known: wind[driver], ", "upwash", "wind_shear"});
  refused("wind", {"effect 'wind' needs a driver: write wind[time] or wind[COLUMN]"});
}

TEST_CASE("effects in time leave out the rows that they would have to guess at") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.rows = 2400});
  const Flight flight = make_flight(simulated);
  const auto probe = make_probe_called("five-hole");
  const EffectiveFlight plain = prepare(*probe, flight, "heading_bias");
  const EffectiveFlight late = prepare(*probe, flight, "time_offset");
  CHECK(plain.prepared.record.rows() == 2400);
  const auto time = late.prepared.record.column("time");
  const auto& before = plain.prepared.record.segments();
  const auto& after = late.prepared.record.segments();
  REQUIRE(before.size() == after.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    CHECK(time[after[i].first] >= time[before[i].first] + 0.5);
    CHECK(time[after[i].first - 1] < time[before[i].first] + 0.5);
    CHECK(time[after[i].last - 1] <= time[before[i].last - 1] - 0.5);
    CHECK(time[after[i].last] > time[before[i].last - 1] - 0.5);
  }
  std::vector<EffectSetting> settings{{.name = "time_offset"}};
  const EffectiveFlight narrow = with_effects(*probe, flight, probe->prepare(flight, {}), settings,
                                              {}, {{"time_offset.tau", {-0.1, 0.2}}});
  CHECK(time[narrow.prepared.record.segments()[0].first] < 0.3);
}

TEST_CASE("an effect of the caller's own goes before one of that name") {
  const auto probe = make_probe_called("five-hole");
  std::vector<EffectSetting> settings{{.name = "upwash"}};
  const Flight flight = make_flight(fly("five-hole", {}));
  const EffectiveFlight made = with_effects(*probe, flight, probe->prepare(flight, {}), settings,
                                            {own_effect("upwash", OwnUpwash{})});
  CHECK(made.model->tables().linear.back().name == "upwash.mine");
}

TEST_CASE("there is no kit of another model") {
  check_refused([] { effect_kit("venturi"); }, {"there is no model 'venturi'"});
}

}  // namespace probe_effects_test
