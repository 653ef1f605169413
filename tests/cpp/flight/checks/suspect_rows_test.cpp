// SPDX-License-Identifier: BSD-3-Clause
// Which rows of one column are no readings, to the row, and which only look so.
#include "flight/checks/suspect_rows.hpp"

#include "checked_logs.hpp"

namespace suspect_rows_test {

using namespace sepcal;
using namespace sepcal::checks;
using sepcal::test::blur;
using sepcal::test::pi;

namespace {

constexpr std::size_t rows = 1000;
const std::vector<Segment> whole{{"", 0, rows}};

/// Three swings of 10 about 100, with noise of 0.1.
std::vector<double> swing(double noise = 0.1) {
  std::vector<double> values(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    values[i] = 100 + 10 * std::sin(2 * pi * 3 * static_cast<double>(i) / rows);
  }
  blur(values, noise, 1);
  return values;
}

SuspectRows look(const std::vector<double>& values, const std::string& header) {
  return find_suspect_rows(values, whole, manner_of_channel(header));
}

}  // namespace

TEST_CASE("nothing is suspect of a clean column, with noise or without") {
  for (const char* header : {"altitude_m", "airspeed_mps", "throttle", "yaw_deg"}) {
    CHECK(look(swing(), header).empty());
    CHECK(look(swing(0.0), header).empty());
  }
}

TEST_CASE("codes are found to the row, in any column") {
  for (const double code : {-9999.0, 9999.0, 999.9, -32768.0, 65535.0, 4294967295.0}) {
    for (const char* header : {"altitude_m", "throttle", "yaw_deg"}) {
      std::vector<double> values = swing();
      for (const std::size_t row : {3U, 500U, 501U, 999U}) values[row] = code;
      const SuspectRows found = look(values, header);
      CHECK(found.sentinels == RowList{3, 500, 501, 999});
      CHECK(found.codes == std::vector<double>{code});
      CHECK(found.all() == found.sentinels);
    }
  }
}

TEST_CASE("nines on the wrong side of all others are a reading") {
  std::vector<double> pulses = swing();
  for (double& value : pulses) value = 1400 + 2 * value;
  pulses[102] = 999;
  CHECK(look(pulses, "motor3_us").sentinels.empty());
}

TEST_CASE("another value is a code where it comes again and again and never stays") {
  std::vector<double> values = swing();
  for (const std::size_t row : {100U, 300U, 700U}) values[row] = 0;
  CHECK(look(values, "voltage_v").sentinels == RowList{100, 300, 700});
  values = swing();
  std::fill_n(values.begin() + 400, 60, 0.0);
  CHECK(look(values, "throttle").empty());      // shut for a while
  CHECK(look(values, "airspeed_mps").empty());  // landed
}

TEST_CASE("a reading among others is no code, whatever its digits") {
  std::vector<double> values(rows);
  for (std::size_t row = 0; row < rows; ++row) {  // at rest but for a sweep to 120
    const double phase = 0.05 * (static_cast<double>(row) - 500.0);
    values[row] = 3.0 * std::sin(0.1 * static_cast<double>(row)) + 120.0 * std::exp(-phase * phase);
  }
  values[490] = 99.9;
  CHECK(look(values, "dpb_pa").sentinels.empty());
  values[100] = 99999.0;
  CHECK(look(values, "dpb_pa").sentinels == RowList{100});
}

TEST_CASE("a code of a column with few levels lies beyond all of them") {
  std::vector<double> flaps(rows, 0.0);
  std::fill_n(flaps.begin() + 800, 60, 40.0);
  CHECK(look(flaps, "flap_deg").empty());
  flaps[10] = -9999;
  CHECK(look(flaps, "flap_deg").sentinels == RowList{10});
}

TEST_CASE("readings that jump away and come back, one or some, in a column with inertia") {
  std::vector<double> values = swing();
  values[200] += 3;
  for (std::size_t row = 600; row < 610; ++row) values[row] += 15;
  const SuspectRows found = look(values, "altitude_m");
  CHECK(found.spikes == RowList{200});
  CHECK(find_runs_of(found.bursts).size() == 1);
  CHECK(found.bursts.front() == 600);
  CHECK(found.bursts.back() == 609);
  CHECK(look(values, "throttle").empty());
}

TEST_CASE("of two spikes with a good reading between, both are found") {
  for (const double second : {7.0, -7.0, 2.5}) {
    std::vector<double> values = swing();
    values[200] += 3;
    values[202] += second;
    CHECK(look(values, "altitude_m").spikes == RowList{200, 202});
  }
}

TEST_CASE("a step stays, and so do steps that come in pairs") {
  std::vector<double> values = swing();
  for (std::size_t row = 500; row < rows; ++row) values[row] += 15;
  CHECK(look(values, "altitude_m").empty());
}

TEST_CASE("a value that stands still by force is frozen, at rest or at a limit it is not") {
  std::vector<double> values = swing();
  std::fill_n(values.begin() + 300, 200, values[300]);
  const SuspectRows found = look(values, "altitude_m");
  CHECK(found.frozen.size() == 200);
  CHECK(found.frozen.front() == 300);

  std::vector<double> limited = swing();
  for (double& value : limited) value = std::min(value, 104.0);
  CHECK(look(limited, "altitude_m").empty());
  std::vector<double> steps = swing(0.0);
  for (double& value : steps) value = std::round(value);
  CHECK(look(steps, "altitude_m").empty());
}

TEST_CASE("an angle that passes the end of its turn does not jump") {
  std::vector<double> heading = swing();
  for (double& value : heading) value = std::fmod(value + 260, 360);
  CHECK(look(heading, "heading_deg").empty());
}

TEST_CASE("a control may be set for some rows, and holds no code all the same") {
  std::vector<double> angle = swing();
  for (std::size_t row = 500; row < 510; ++row) angle[row] += 50;
  angle[700] = -9999;
  const files::Unit& radians = *files::find_unit(files::UnitKind::angle, "rad");
  const auto look_at = [&](const char* quantity) {
    return find_suspect_rows(angle, whole, manner_of(quantity, radians));
  };
  CHECK(look_at("elevator").bursts.empty());
  CHECK(look_at("elevator").sentinels == RowList{700});
}

TEST_CASE("what is one value throughout") {
  CHECK(is_constant(std::vector<double>(20, 12.0)));
  CHECK_FALSE(is_constant(std::vector<double>(19, 12.0)));
  CHECK_FALSE(is_constant(swing()));
}

}  // namespace suspect_rows_test
