// SPDX-License-Identifier: BSD-3-Clause
// Clocks and samples that are not what they seem, each put into a clean log by hand.
#include "checked_logs.hpp"

namespace check_samples_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;

namespace {

using Values = std::vector<double>;

/// Every `rows`-th value, held until the next.
void hold(Values& values, std::size_t rows) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i - i % rows];
}

/// Straight lines between every `rows`-th value, written with four decimals.
void interpolate(Values& values, std::size_t rows) {
  const Values knots = values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i - i % rows;
    const std::size_t to = std::min(from + rows, values.size() - 1);
    const double share =
        to == from ? 0.0 : static_cast<double>(i - from) / static_cast<double>(to - from);
    values[i] = std::round(1e4 * ((1 - share) * knots[from] + share * knots[to])) / 1e4;
  }
}

/// The only note there is.
LogNote only(const FlightCheck& checked, const std::string& kind) {
  CHECK(kinds(checked) == kind);
  REQUIRE(notes_of(checked, kind).size() == 1);
  return notes_of(checked, kind).front();
}

}  // namespace

TEST_CASE("a clean log has no note, of forty none") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CHECK(kinds(check_tube(tube_log(3000, 100 * seed))) == "");
    CHECK(kinds(check_sphere(sphere_log(1500, 100 * seed))) == "");
  }
}

TEST_CASE("values that are held are told with their true rate, alike columns in one note") {
  Log log = tube_log();
  hold(log["airspeed_mps"], 5);
  hold(log["vn_mps"], 2);
  hold(log["ve_mps"], 2);
  const FlightCheck checked = check_tube(log);
  CHECK(kinds(checked) == "held, held");
  CHECK(checked.notes[0].columns == std::vector<std::string>{"vn_mps", "ve_mps"});
  CHECK(contains(checked.notes[0].found, "one row in 2 (25 Hz in a log of 50 Hz) is new"));
  CHECK(contains(checked.notes[1].found, "one row in 5 (10 Hz in a log of 50 Hz) is new"));
  CHECK(contains(checked.notes[1].effect, "0.04 s late"));  // on average (0 + ... + 4) / 5 rows
  CHECK(contains(checked.notes[1].effect, "2.2 times too small"));  // sqrt(5)
  const auto& columns = checked.columns;
  const auto airspeed = std::ranges::find(columns, "airspeed_mps", &ColumnCheck::header);
  REQUIRE(airspeed != columns.end());
  CHECK(airspeed->repeated == Approx(0.8).epsilon(0.01));
  CHECK(airspeed->rate == Approx(10).epsilon(0.01));
}

TEST_CASE("a column at rest for half of the log is not held") {
  Log log = tube_log();
  std::fill_n(log["vd_mps"].begin(), 1500, 0.0);
  CHECK(kinds(check_tube(log)) == "");
}

TEST_CASE("an interpolated column is told with its true rate, whatever its rows' ratio") {
  for (const std::size_t rows : {3U, 10U}) {
    Log log = tube_log();
    interpolate(log["airspeed_mps"], rows);
    const LogNote note = only(check_tube(log), "interpolated");
    CHECK(note.columns == std::vector<std::string>{"airspeed_mps"});
    CHECK(contains(note.found, "one row in " + std::to_string(rows)));
  }
  Log log = tube_log();  // 8 Hz in 50 Hz: knots fall between rows
  Values& values = log["airspeed_mps"];
  const Values measured = values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double at = static_cast<double>(i) / 6.25;
    const auto knot = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(knot);
    values[i] = (1 - share) * measured[knot] + share * measured[knot + 1];
  }
  CHECK(contains(only(check_tube(log), "interpolated").found, "one row in 6"));
}

TEST_CASE("noise below the steps of a column is told, steps below the noise are not") {
  for (const double step : {0.05, 1.0}) {
    Log log = tube_log();
    for (double& value : log["airspeed_mps"]) value = step * std::round(value / step);
    const FlightCheck checked = check_tube(log);
    CHECK(kinds(checked) == (step > 0.1 ? "coarse" : ""));
    const auto column = std::ranges::find(checked.columns, "airspeed_mps", &ColumnCheck::header);
    CHECK(column->step == Approx(step));
  }
}

TEST_CASE("stamps that jitter by a third of their interval are told, by a tenth not") {
  for (const double jitter : {0.1, 0.33}) {
    Log log = tube_log();
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform(-jitter, jitter);
    for (double& time : log["time_s"]) time += 0.02 * uniform(engine);
    CHECK(kinds(check_tube(log)) == (jitter > 0.3 ? "jitter" : ""));
  }
}

TEST_CASE("stamps in bursts are told apart from jitter and from gaps") {
  Log log = tube_log();
  Values& time = log["time_s"];
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] = 0.1 * static_cast<double>(i / 5) + 0.003 * static_cast<double>(i % 5);
  }
  const LogNote note = only(check_tube(log), "bursts");
  CHECK(contains(note.found, "bursts of about 5 rows, 0.088 s apart"));
}

TEST_CASE("stamps of all sizes with many short ones are bursts too, and not torn") {
  Log log = tube_log();
  std::mt19937_64 engine(3);
  std::exponential_distribution<double> waits(1 / 0.017);
  double now = 0.0;
  for (double& time : log["time_s"]) time = now += 0.0005 + waits(engine) * waits(engine) / 0.017;
  const LogNote note = only(check_tube(log), "bursts");
  CHECK(contains(note.found, "half of the rows are within"));
}

TEST_CASE("stamps that repeat and clocks that start again are refused by a fit, and described") {
  Log repeated = tube_log();
  repeated["time_s"][1000] = repeated["time_s"][999];
  FlightCheck checked = check_tube(repeated);
  CHECK(contains(checked.refused, "repeats"));
  CHECK(checked.rows_used == 0);
  LogNote note = only(checked, "repeated_stamps");
  CHECK(note.rows == 1);
  CHECK(contains(note.found, "first at row 1000"));
  CHECK(note.first_s == Approx(19.98));

  Log joined = tube_log();
  for (std::size_t i = 0; i < 3000; ++i) joined["time_s"][i] -= i < 1000 ? 0 : i < 2000 ? 20 : 40;
  checked = check_tube(joined);
  CHECK(checked.refused.empty());
  CHECK(kinds(checked) == "gaps, read");
  note = checked.notes.back();
  CHECK(contains(note.found, "time_s runs back 2 times, first at log row 1000"));
  CHECK(checked.duration == Approx(3 * 19.98 + 2 * 1.0));
  CHECK(note.concern == Concern::slight);

  Log shuffled = tube_log();
  std::swap(shuffled["time_s"][1000], shuffled["time_s"][1004]);
  checked = check_tube(shuffled);
  CHECK(contains(checked.refused, "runs back"));
  note = only(checked, "restarts");
  CHECK(note.rows == 2);
  CHECK(note.concern == Concern::wrong);
}

TEST_CASE("a few gaps are good to know, a log torn to pieces matters") {
  Log log = tube_log();
  for (std::size_t i = 1500; i < 3000; ++i) log["time_s"][i] += 2;
  LogNote note = only(check_tube(log), "gaps");
  CHECK(note.concern == Concern::slight);
  CHECK(contains(note.found, "1 gap in time, the longest 2.02 s, before row 1500"));
  Log torn = tube_log();
  for (std::size_t i = 0; i < 3000; ++i) torn["time_s"][i] += 2 * static_cast<double>(i / 40);
  note = only(check_tube(torn), "gaps");
  CHECK(note.concern == Concern::matters);
  CHECK(note.rows == 74);
}

TEST_CASE("single wild readings are counted to the row, steps and bursts are none") {
  Log log = tube_log();
  for (const std::size_t row : {400U, 1300U, 2222U}) log["airspeed_mps"][row] += 8;
  LogNote note = only(check_tube(log), "outliers");
  CHECK(note.rows == 3);
  CHECK(contains(note.found, "first at row 400"));
  CHECK(note.first_s == Approx(8.0));
  CHECK(note.last_s == Approx(44.44));
  CHECK(note.concern == Concern::matters);

  Log step = tube_log();
  for (std::size_t i = 1500; i < 3000; ++i) step["airspeed_mps"][i] += 3;
  CHECK(kinds(check_tube(step)) == "");

  Log bursty = tube_log();
  Values noise(3000);
  blur(noise, 0.5, 77);
  for (std::size_t i = 0; i < 3000; ++i) {
    if (i / 100 % 3 == 0) bursty["airspeed_mps"][i] += noise[i];
  }
  CHECK(kinds(check_tube(bursty)) == "");
}

TEST_CASE("readings cut off at a limit are told, peaks on steps are not") {
  Log log = tube_log();
  for (double& value : log["airspeed_mps"]) value = std::min(value, 23.0);
  const auto over = std::ranges::count(log["airspeed_mps"], 23.0);
  const LogNote note = only(check_tube(log), "clipped");
  CHECK(contains(note.found, "largest of 23 mps"));
  CHECK(note.rows <= static_cast<std::size_t>(over));
  CHECK(note.rows > static_cast<std::size_t>(over) * 7 / 10);

  Log peaks = tube_log();
  for (std::size_t i = 0; i < 3000; ++i) {
    const double speed = 20 + 6 * std::sin(2 * pi * 5 * static_cast<double>(i) / 3000);
    peaks["airspeed_mps"][i] = 0.02 * std::round(speed / 0.02);
  }
  CHECK(notes_of(check_tube(peaks), "clipped").empty());
}

}  // namespace check_samples_test
