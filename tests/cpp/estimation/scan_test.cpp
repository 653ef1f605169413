// SPDX-License-Identifier: BSD-3-Clause
// The time of a step: between the two rows where it is, whether its coefficient is linear or not,
// and what the first order does for the parameters that follow.
#include "estimation/scan.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "calibrated_flights.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace scan_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

/// `rows` of z = 2 u + 1 + 0.5 (t >= t0), u = sin(t), every 0.1 s, with noise of that standard
/// deviation.
Record make_record(std::size_t rows, double t0, double noise, std::uint64_t seed = 7) {
  Draws draws(seed);
  std::vector<double> time;
  std::vector<double> u;
  std::vector<double> z;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = 0.1 * static_cast<double>(k);
    time.push_back(t);
    u.push_back(std::sin(t));
    z.push_back(2.0 * std::sin(t) + 1.0 + (t >= t0 ? 0.5 : 0.0) + noise * draws.normal());
  }
  Record record;
  return record.add("time", time).add("u", u).add("z", z);
}

/// The line with a step on its constant (linear) or, as half as much of it, on u (nonlinear).
std::shared_ptr<const BlockModel> with_step(const char* name, Record record) {
  const auto line = block_model(Line{});
  std::vector<EffectSetting> settings{{.name = name}};
  return compose(line, make_effects(plain_kit(line->tables()), *line, settings, record), record);
}

const estimation::ScanPoint without_step{{{"s", 2.0}, {"c", 1.25}}, {}, 1};

}  // namespace

TEST_CASE("the best of the candidates is found, whether the coefficient is linear or not") {
  const Record record = make_record(100, 6.0, 0.01);
  const std::vector<double> candidates{2.05, 4.05, 5.95, 8.05};
  const auto linear = with_step("c[step(time)]", record);
  CHECK(estimation::scan(*linear, record, without_step, "c[step(time)].t0", candidates) == 5.95);
  // s u: an offset of u by 0.25 is one of z by 0.5. At zero the effect is seen by its slope alone.
  const auto nonlinear = with_step("u[step(time)]", record);
  CHECK(estimation::scan(*nonlinear, record, without_step, "u[step(time)].t0", candidates) == 5.95);
}

TEST_CASE("what is held does not follow: then a step held at zero explains nothing") {
  const Record record = make_record(100, 6.0, 0.01);
  const auto model = with_step("c[step(time)]", record);
  estimation::ScanPoint held = without_step;
  held.held["c[step(time)].s"] = 0.0;
  // All are as good: the first one stays.
  CHECK(estimation::scan(*model, record, held, "c[step(time)].t0", {2.05, 5.95}) == 2.05);
}

TEST_CASE("the time lies between the two rows where the step is, in short records and long ones") {
  for (const std::size_t rows : {60U, 399U, 400U, 1'000U, 5'000U}) {
    CAPTURE(rows);
    const double t0 = 0.1 * std::floor(0.37 * static_cast<double>(rows)) - 0.05;
    const Record record = make_record(rows, t0, 0.01);
    for (const char* name : {"c[step(time)]", "u[step(time)]"}) {
      CAPTURE(name);
      const auto model = with_step(name, record);
      const double found =
          estimation::scan_step(*model, record, without_step, std::string(name) + ".t0");
      CHECK(std::abs(found - t0) < 1e-9);  // the middle between two rows
    }
  }
}

TEST_CASE("bounds are kept, and no time lies across a segment's edge") {
  Record record = make_record(100, 6.05, 0.01);
  const auto model = with_step("c[step(time)]", record);
  const double found =
      estimation::scan_step(*model, record, without_step, "c[step(time)].t0", {2.0, 5.0});
  CHECK(found >= 2.0);
  CHECK(found <= 5.0);
  record.cut({{"a", 0, 61}, {"b", 61, 100}});  // the step's two rows are 60 and 61
  const double beside = estimation::scan_step(*model, record, without_step, "c[step(time)].t0");
  CHECK(std::abs(beside - 6.05) == doctest::Approx(0.1));
}

TEST_CASE("a parameter that isn't there and bounds without a row are refused") {
  const Record record = make_record(30, 1.0, 0.01);
  const auto model = with_step("c[step(time)]", record);
  check_refused([&] { estimation::scan(*model, record, without_step, "t1", {1.0}); },
                {"there is no parameter 't1'"});
  check_refused(
      [&] {
        estimation::scan_step(*model, record, without_step, "c[step(time)].t0", {50.0, 60.0});
      },
      {"no two rows of the record", "'c[step(time)].t0'", "widen its bounds"});
}

}  // namespace scan_test
