// SPDX-License-Identifier: BSD-3-Clause
// Errors that name options: as code does, and as the user of a front types them.
#include "sepcal/error.hpp"

#include <nlohmann/json.hpp>

#include <string>

#include "base/thread_pool.hpp"
#include "calibrated_flights.hpp"

namespace option_error_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

CalibrationOptions quick_options() {
  CalibrationOptions options;
  options.fit.samples = 10;
  options.fit.threads = 1;
  return options;
}

std::string as_typed(const std::string& name) { return "--" + name; }

/// What the act throws, spelled in code and for a command line.
struct Spellings {
  std::string in_code;
  std::string as_typed;
};

template <class Act>
Spellings refuse(const Act& act) {
  try {
    act();
  } catch (const OptionError& error) {
    return {error.what(), error.spelled(as_typed)};
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace

TEST_CASE("one error is spelled for any front") {
  const OptionError error({"flight row 4: rho is not positive; ", Option{"drop_invalid"},
                           " drops such rows, ", Option{"fix"}, " drops none"});
  const std::string in_code =
      "flight row 4: rho is not positive; drop_invalid drops such rows, fix drops none";
  CHECK(std::string(error.what()) == in_code);
  CHECK(error.spelled(as_typed) ==
        "flight row 4: rho is not positive; --drop_invalid drops such rows, --fix drops none");
  CHECK(std::string(error.what()) == in_code);
}

TEST_CASE("a text that reads like an option is none") {
  const OptionError error({"fix.csv: column 'fix'; ", Option{"fix"}, " it"});
  CHECK(error.spelled(as_typed) == "fix.csv: column 'fix'; --fix it");
}

TEST_CASE("in any spelling a message is one printable line") {
  const OptionError error({"a\nb ", Option{"fix"}});
  CHECK(std::string(error.what()) == "a\\nb fix");
  CHECK(error.spelled(as_typed) == "a\\nb --fix");
}

TEST_CASE("words about an error leave its options options") {
  const auto [in_code, typed] = refuse([] {
    try {
      throw OptionError({Option{"k_alpha"}, " is -1"});
    } catch (const Error& error) {
      throw_within("b.json: ", error, "; fit again");
    }
  });
  CHECK(in_code == "b.json: k_alpha is -1; fit again");
  CHECK(typed == "b.json: --k_alpha is -1; fit again");

  try {
    throw_within("b.json: ", Error("it is empty"));
  } catch (const Error& error) {
    CHECK(dynamic_cast<const OptionError*>(&error) == nullptr);
    CHECK(std::string(error.what()) == "b.json: it is empty");
  }
}

TEST_CASE("an error keeps its options on its way out of a thread") {
  base::ThreadPool pool(2);
  const auto work = [](std::size_t) { throw OptionError({Option{"fix"}, " one"}); };
  CHECK(refuse([&] { pool.for_each(2, work); }).as_typed == "--fix one");
}

TEST_CASE("what a damaged calibration is refused for") {
  const Flight flight = make_flight(simulate_five_hole({}, condensed(50)));
  nlohmann::json root =
      nlohmann::json::parse(to_json(calibrate(make_five_hole(), flight, quick_options())));
  root["options"]["k_alpha"] = -1.0;
  const auto [in_code, typed] = refuse([&] { parse_calibration(root.dump(), "base.json"); });
  CHECK(in_code ==
        "base.json is damaged: k_alpha is -1; give the ports' sensitivity in 1/rad, above zero; "
        "fit the flight again");
  CHECK(typed ==
        "base.json is damaged: --k_alpha is -1; give the ports' sensitivity in 1/rad, above zero; "
        "fit the flight again");
}

TEST_CASE("a fit names the option that would have helped") {
  const auto calibrate_tube = [](std::size_t rows, const CalibrationOptions& options) {
    calibrate(pitot_static_probe(), make_flight(simulate_pitot_static({}, condensed(rows))),
              options);
  };
  CalibrationOptions options = quick_options();
  CHECK(refuse([&] { calibrate_tube(3, options); }).as_typed ==
        "flight: 3 usable rows are fewer than the 4 parameters; log more, or --fix some");
  options.fit.bounds = {{"w_d", {-1.0, 1.0}}};
  CHECK(refuse([&] { calibrate_tube(50, options); }).as_typed ==
        "--bounds w_d: it is held at 0 unless --free w_d frees it; add that");
  options.fit.fix = {{"w_d", 0.3}};
  options.free = {"w_d"};
  CHECK(refuse([&] { calibrate_tube(50, options); }).as_typed ==
        "--free w_d and --fix w_d contradict each other; keep one");
}

}  // namespace option_error_test
