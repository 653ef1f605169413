// SPDX-License-Identifier: BSD-3-Clause
// Flights of every probe with one effect hidden by the simulator, which shares no code with the
// candidates: the effect is found, an invisible one is called so, and nothing where nothing is.
#include "sepcal/flight/flight_diagnosis.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "diagnosed_flights.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"

namespace flight_diagnosis_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;
using Texts = std::vector<std::string>;

namespace {

/// Where it stands behind the first of what was found.
int place_of(Beside beside) {
  switch (beside) {
    case Beside::equivalent:
      return 1;
    case Beside::counts:
      return 2;
    case Beside::untried:
      return 3;
    default:
      return 4;
  }
}

/// What must hold of every diagnosis, whatever its verdict.
void check_order(const FlightDiagnosis& result) {
  const std::vector<EffectFinding>& effects = result.diagnosis.effects;
  REQUIRE(result.sentences.size() == effects.size());
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectFinding& effect = effects[i];
    CAPTURE(effect.name);
    CHECK(!result.sentences[i].empty());
    const bool may_stand = i > 0 && result.diagnosis.verdict != Verdict::adequate;
    CHECK((effect.beside == Beside::untried || may_stand));
    CHECK(effect.p_value == Approx(std::pow(10.0, effect.log10_p)));
    CHECK(effect.visibility >= 0.0);
    CHECK(effect.visibility <= 1.0);
    if (effect.status == FindingStatus::cannot_be_seen) {
      CHECK(std::isnan(effect.predicted_drop));
      continue;
    }
    CHECK(effect.p_adjusted >= effect.p_value * (1.0 - 1e-12));
    CHECK(effect.p_adjusted >= effect.p_listed);
    CHECK(effect.predicted_drop > -0.01);  // the fit weighs the outputs, this RMSE does not
    CHECK(effect.predicted_drop <= 1.0);
    const bool is_small = effect.held_out_gain < 0.01;
    const bool is_found = effect.p_adjusted < 0.05 && effect.held_out_passed && !is_small;
    const bool is_withheld = std::ranges::any_of(  // no fit may have taken it
        result.diagnosis.advice.withheld,
        [&](const std::string& why) { return why.starts_with(effect.name + ": "); });
    const bool stands_found = effect.status == FindingStatus::found;
    CHECK((stands_found == is_found || (is_withheld && !stands_found)));
    if (i > 0 && effects[i - 1].status == effect.status) {
      const bool stands_alike = effects[i - 1].beside == effect.beside;
      const bool by_fits = i == 1 || effects[i - 1].beside == Beside::equivalent || !stands_alike;
      const bool is_among_found = i > 1 && effect.status == FindingStatus::found;
      if (is_among_found) CHECK(place_of(effects[i - 1].beside) <= place_of(effect.beside));
      CHECK((by_fits || effects[i - 1].log10_p <= effect.log10_p));
    }
    if (i > 0) CHECK(effects[i - 1].status <= effect.status);
  }
}

/// The effect comes first, or would do as well as what does.
bool stands_first(const FlightDiagnosis& result, const std::string& name) {
  const EffectFinding& first = result.diagnosis.effects.front();
  return first.name == name || find(result, name).beside == Beside::equivalent;
}

}  // namespace

TEST_CASE("an effect of ten standard errors is found first, or the first can't be told from it") {
  for (const auto& [probe, hidden, noise] : strong_effects) {
    CAPTURE(probe);
    CAPTURE(hidden.name);
    const DiagnosedFlight flight = diagnose_flight(probe, {hidden}, {.noise = noise, .seed = 11});
    const FlightDiagnosis& result = flight.result;
    CHECK(result.diagnosis.verdict == Verdict::effect_missing);
    const EffectFinding& first = result.diagnosis.effects.front();
    CHECK(first.status == FindingStatus::found);
    CHECK(stands_first(result, hidden.name));
    check_order(result);

    const EffectFinding& own = find(result, hidden.name);
    REQUIRE(own.coefficients.size() >= hidden.sizes.size());
    double sigmas = 0.0;
    for (std::size_t k = 0; k < hidden.sizes.size(); ++k) {
      const Coefficient& coefficient = own.coefficients[k];
      CHECK(std::abs(coefficient.estimate - hidden.sizes[k]) < 4.5 * coefficient.standard_error);
      sigmas = std::max(sigmas, std::abs(coefficient.estimate) / coefficient.standard_error);
    }
    CHECK(sigmas > 6.0);
    CHECK(result.diagnosis.rmse > noise * 0.95);
    CHECK(verdict_sentence(result).starts_with(first.name + " ("));
  }
}

// A null's noise model swallows a large slow effect: its simulations make a few ratios of any size.
TEST_CASE("the larger an effect, the surer it is found") {
  for (const double size : {0.012, 0.02, 0.04}) {
    for (const std::uint64_t seed : {22U, 23U}) {
      CAPTURE(size);
      CAPTURE(seed);
      const DiagnosedFlight flight = diagnose_flight(
          "five-hole", {{"wind[altitude_m]", {size, -1.5 * size}}}, {.noise = 0.15, .seed = seed});
      CAPTURE(to_json(flight.result).substr(0, 30000));
      CHECK(flight.result.diagnosis.verdict == Verdict::effect_missing);
      CHECK(stands_first(flight.result, "wind[altitude_m]"));
    }
  }
}

TEST_CASE("nothing is hidden: adequate, on every probe") {
  for (const char* probe : all_probes) {
    CAPTURE(probe);
    const DiagnosedFlight flight = diagnose_flight(probe, {}, {.noise = 0.15, .seed = 12});
    const Diagnosis& diagnosis = flight.result.diagnosis;
    CHECK(diagnosis.verdict == Verdict::adequate);
    CHECK(std::ranges::count(diagnosis.effects, FindingStatus::found, &EffectFinding::status) == 0);
    CHECK(diagnosis.floor == Approx(diagnosis.rmse).epsilon(0.05));
    CHECK(diagnosis.rmse == Approx(0.15).epsilon(0.1));
    CHECK(!diagnosis.limits.empty());
    check_order(flight.result);
  }
}

TEST_CASE("what the model's own parameters absorb can't be seen, however large it is") {
  const auto check = [](const char* probe, const SizedEffect& hidden, double noise) {
    CAPTURE(hidden.name);
    const DiagnosedFlight flight = diagnose_flight(probe, {hidden}, {.noise = noise, .seed = 13});
    const EffectFinding& effect = find(flight.result, hidden.name);
    CHECK(effect.status == FindingStatus::cannot_be_seen);
    CHECK(effect.visibility < 0.05);
    CHECK(effect.p_adjusted == 1.0);
    CHECK(flight.result.diagnosis.verdict == Verdict::adequate);
  };
  check("five-hole", {"mounting_error", {0.03, -0.02}}, 0.15);
  check("magnetometer", {"attitude_bias", {0.03, -0.02}}, 0.3);
}

TEST_CASE("a flight without noise: nothing is left, or the effect to the last digit") {
  const DiagnosedFlight clean = diagnose_flight("five-hole", {}, {.seed = 14});
  CHECK(clean.result.diagnosis.verdict == Verdict::adequate);
  CHECK(clean.result.diagnosis.effects.empty());
  CHECK(verdict_sentence(clean.result) == "Nothing is missing: the model leaves no error.");
  CHECK(nlohmann::json::parse(to_json(clean.result)).at("effects").empty());

  const DiagnosedFlight hidden =
      diagnose_flight("magnetometer", {{"bias[current_a]", {0.1, -0.1, 0.2}}}, {.seed = 14});
  CHECK(hidden.result.diagnosis.verdict == Verdict::effect_missing);
  CHECK(stands_first(hidden.result, "bias[current_a]"));
  const EffectFinding& effect = find(hidden.result, "bias[current_a]");
  CHECK(effect.coefficients[2].estimate == Approx(0.2).epsilon(1e-6));
  CHECK(effect.predicted_drop > 0.999);
  CHECK(effect.p_value == 0.0);
  CHECK(effect.log10_p < -300.0);
}

TEST_CASE("a flight of a few rows is diagnosed as well") {
  for (const std::size_t rows : {12U, 16U, 25U}) {
    CAPTURE(rows);
    const DiagnosedFlight clean =
        diagnose_flight("magnetometer", {}, {.rows = rows, .noise = 0.3, .seed = 15});
    if (rows == 25) CHECK(clean.result.diagnosis.verdict == Verdict::adequate);
    check_order(clean.result);
    CHECK(nlohmann::json::accept(to_json(clean.result)));
  }
  const DiagnosedFlight bent =
      diagnose_flight("magnetometer", {{"bias[current_a]", {0.2, -0.2, 0.2}}},
                      {.rows = 25, .noise = 0.3, .seed = 15});
  CHECK(find(bent.result, "bias[current_a]").status == FindingStatus::found);
}

TEST_CASE("a flight other than the fitted is diagnosed by what its own residuals show") {
  const auto& [probe, hidden, noise] = strong_effects.front();
  const Conditions conditions{.noise = noise, .seed = 16};
  const Calibration base = calibrate_with(probe, fly(probe, {}, conditions), {});
  const SimulatedFlight other = fly(probe, {hidden}, {.rows = 380, .noise = noise, .seed = 17});
  const FlightDiagnosis result = diagnose(base, make_flight(other), {}, quick_diagnosis(probe));
  CHECK(result.flight.rows == 380);
  CHECK(result.diagnosis.verdict == Verdict::effect_missing);
  CHECK(stands_first(result, hidden.name));
  const SimulatedFlight same = fly(probe, {}, {.rows = 380, .noise = noise, .seed = 18});
  CHECK(diagnose(base, make_flight(same), {}, quick_diagnosis(probe)).diagnosis.verdict ==
        Verdict::adequate);
}

TEST_CASE("what the calibration has is no candidate, and leaves nothing to find") {
  const SizedEffect& hidden = strong_effects.front().effect;
  const SimulatedFlight simulated = fly("five-hole", {hidden}, {.noise = 0.15, .seed = 11});
  const Calibration whole = calibrate_with("five-hole", simulated, {hidden.name});
  const FlightDiagnosis result =
      diagnose(whole, make_flight(simulated), {}, quick_diagnosis("five-hole"));
  CHECK(result.diagnosis.verdict == Verdict::adequate);
  for (const EffectFinding& effect : result.diagnosis.effects) CHECK(effect.name != hidden.name);
}

TEST_CASE("an effect of the caller's own ranks as the built-in one that it repeats") {
  const SimulatedFlight simulated =
      fly("magnetometer", {{"bias[current_a]", {0.04, -0.04, 0.04}}}, {.noise = 0.3, .seed = 11});
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("magnetometer", simulated, {});
  const EffectKit kit = effect_kit("magnetometer");
  const Port& bias = *std::ranges::find(kit.ports, "bias", &Port::name);
  const OwnEffects own{
      {"motor", [&](const BlockModel& model, EffectSetting& setting, Record& record) {
         return make_named("motor", parse_effect_name("bias[current_a]"), bias, model, setting,
                           record);
       }}};
  const FlightDiagnosis result = diagnose(base, flight, own, quick_diagnosis("magnetometer"));
  const EffectFinding& mine = find(result, "motor");
  const EffectFinding& built_in = find(result, "bias[current_a]");
  CHECK(mine.status == FindingStatus::found);
  CHECK(mine.log10_p == Approx(built_in.log10_p).epsilon(1e-6));
  CHECK(mine.predicted_drop == Approx(built_in.predicted_drop).epsilon(1e-9));
  CHECK(mine.held_out_gain == Approx(built_in.held_out_gain).epsilon(1e-6));
  CHECK(stands_first(result, "motor"));
  CHECK(stands_first(result, "bias[current_a]"));
  REQUIRE(mine.coefficients.size() == 3);
  CHECK(mine.coefficients[1].name == "motor.y");
  // One of the two is told as a fit has it, the other as one step has.
  CHECK(mine.coefficients[1].estimate == Approx(built_in.coefficients[1].estimate).epsilon(0.01));
}

TEST_CASE("the same flight and seed give the same JSON on any number of threads") {
  const auto& [probe, hidden, noise] = strong_effects[4];
  const SimulatedFlight simulated = fly(probe, {hidden}, {.rows = 250, .noise = noise, .seed = 11});
  const Calibration base = calibrate_with(probe, simulated, {});
  DiagnosisOptions options = quick_diagnosis(probe);
  const std::string one = to_json(diagnose(base, make_flight(simulated), {}, options));
  options.threads = 3;
  CHECK(to_json(diagnose(base, make_flight(simulated), {}, options)) == one);
}

TEST_CASE("a flight that isn't the probe's is refused by its name") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.1});
  const Calibration base = calibrate_with("five-hole", simulated, {});
  const Flight other = make_flight(fly("magnetometer", {}, {.noise = 0.1}));
  check_refused([&] { diagnose(base, other); }, {"flight: column 'vn_mps' is missing"});
}

TEST_CASE("errors name the flight once, whatever it is called") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.1});
  const Calibration base = calibrate_with("five-hole", simulated, {});
  Flight other("a\tlog");
  other.add("time_s", {0.0, 1.0});
  try {
    diagnose(base, other);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.starts_with("a\\tlog: column '"));
  }
}

}  // namespace flight_diagnosis_test
