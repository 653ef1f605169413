// SPDX-License-Identifier: BSD-3-Clause
// Logs that may be longer than memory: their columns lie in mapped files, and a fit is the same.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "base/excerpt.hpp"
#include "base/gaps.hpp"
#include "base/spool.hpp"
#include "noises.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/simulation/simulate.hpp"
#include "simulated_flights.hpp"
#include "small_models.hpp"
#include "temporary_folder.hpp"

namespace streaming_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Calibration;
using sepcal::CalibrationOptions;
using sepcal::Error;
using sepcal::Flight;
using sepcal::Record;
using sepcal::Segment;
using sepcal::test::TemporaryFolder;

namespace {

std::string magnetometer_log(const TemporaryFolder& folder, std::size_t rows) {
  std::ofstream stream(folder.path() / "flight.csv");
  write_csv(sepcal::simulate_magnetometer({}, sepcal::test::condensed(rows)), stream);
  return (folder.path() / "flight.csv").string();
}

Calibration calibrate(const Flight& flight, CalibrationOptions options = {}) {
  return sepcal::calibrate(sepcal::magnetometer_probe(std::nullopt), flight, options);
}

bool same_estimates(const sepcal::Fit& one, const sepcal::Fit& other) {
  return one.values() == other.values() && one.cost == other.cost;
}

}  // namespace

TEST_CASE("a spool gives back what was written, also after its pages went") {
  sepcal::base::Spool spool("");
  constexpr std::size_t rows = 100'000;
  std::vector<double> values(rows);
  for (std::size_t i = 0; i < rows; ++i) values[i] = std::sin(static_cast<double>(i));
  sepcal::base::Spool::Column column(spool);
  column.append(std::span(values).first(70'000));
  for (std::size_t i = 70'000; i < rows; ++i) column.append(values[i]);
  const auto mapped = column.finish();
  CHECK(std::ranges::equal(mapped, values));
  spool.release(0, rows);
  spool.release(50'000, 2 * rows);
  CHECK(std::ranges::equal(mapped, values));
  CHECK(sepcal::base::Spool::Column(spool).finish().empty());
  sepcal::base::Spool nowhere("/nowhere at all");
  CHECK_THROWS_WITH_AS(sepcal::base::Spool::Column{nowhere}, Contains("TMPDIR"), Error);
}

TEST_CASE("the gap is the same from intervals that are sorted and from passes over them") {
  std::mt19937_64 random(5);
  for (const int kind : {0, 1, 2, 3}) {
    std::vector<double> intervals;
    for (int i = 0; i < 1'000; ++i) {
      const double jitter = std::uniform_real_distribution(0.0, 1.0)(random);
      const bool long_one = i % 40 == 0;
      intervals.push_back(kind == 0   ? 0.02
                          : kind == 1 ? 0.02 + 0.001 * jitter + (long_one ? 3.0 : 0.0)
                          : kind == 2 ? (i % 10 == 0 ? 0.2 : 0.001 * jitter)
                                      : jitter - 0.5);
    }
    const auto pass = [&](const std::function<void(double)>& visit) {
      for (const double interval : intervals) visit(interval);
    };
    CHECK(sepcal::base::find_gap(intervals) == sepcal::base::find_gap(intervals.size(), pass));
  }
}

TEST_CASE("an excerpt lies evenly over the rows of the segments") {
  constexpr std::size_t rows = 400'000;
  const std::vector<double> x(rows);
  Record record;
  record.view("x", x).cut({{"a", 10, 150'000}, {"b", 200'000, rows}});
  CHECK(sepcal::base::excerpt(record).rows() == record.rows());
  record.map([](std::size_t, std::size_t) {});
  const Record part = sepcal::base::excerpt(record);
  CHECK(part.rows() == sepcal::base::excerpt_rows);
  CHECK(part.segments().front().first == 10);
  CHECK(part.segments().front().label == "a");
  CHECK(part.segments().back().last == rows);
  CHECK(part.segments().back().label == "b");
  for (const Segment& segment : part.segments()) CHECK(segment.rows() <= 10'000);
}

TEST_CASE("a streamed flight has the columns and labels of one that was read") {
  const TemporaryFolder folder;
  const std::string file =
      folder.write("time_s,maneuver,a\n0,one,1\n1,one,n/a\n2,two,3\n3,one,4\n", "flight.csv");
  const Flight read = sepcal::read_csv(file);
  const Flight streamed = sepcal::stream_csv(file);
  CHECK(streamed.is_mapped());
  CHECK(streamed.sha256() == read.sha256());
  REQUIRE(streamed.rows() == 4);
  CHECK(std::ranges::equal(streamed.columns()[0].values, read.columns()[0].values));
  CHECK(streamed.columns()[1].values[2] == 3.0);
  CHECK(streamed.columns()[1].first_text->row == 1);
  const auto labels = streamed.label_stretches();
  REQUIRE(labels.size() == 3);
  CHECK(labels[1].label == "two");
  CHECK(labels[1].first == 2);
  CHECK(labels[2].last == 4);
  CHECK(read.label_stretches().size() == 3);
}

TEST_CASE("a streamed fit is that of the whole flight; of few rows all of it is") {
  const TemporaryFolder folder;
  const std::string file = magnetometer_log(folder, 4'000);
  const Calibration whole = calibrate(sepcal::read_csv(file));
  const Calibration streamed = calibrate(sepcal::stream_csv(file));
  CHECK(to_json(streamed) == to_json(whole));
  CHECK(streamed.notes == whole.notes);
}

TEST_CASE("standard errors of a long streamed flight are from part of its rows") {
  const TemporaryFolder folder;
  const std::string file = magnetometer_log(folder, 120'000);
  CalibrationOptions options;
  options.fit.samples = 20;
  const Calibration whole = calibrate(sepcal::read_csv(file), options);
  const Calibration streamed = calibrate(sepcal::stream_csv(file), options);
  CHECK(same_estimates(streamed.fit, whole.fit));
  CHECK(streamed.fit.status == whole.fit.status);
  CHECK(streamed.fit.message.find("noise model is from 100000 of 120000 rows") !=
        std::string::npos);
  for (std::size_t k = 0; k < whole.fit.parameters.size(); ++k) {
    const sepcal::Parameter& one = streamed.fit.parameters[k];
    const sepcal::Parameter& other = whole.fit.parameters[k];
    CHECK(one.standard_error == Approx(other.standard_error).epsilon(0.1));
    CHECK(one.standard_error_blocks == Approx(other.standard_error_blocks).epsilon(1e-9));
  }
}

TEST_CASE("noise slower than a stretch of the excerpt is in the errors of a mapped record") {
  // Correlation time 40,000 rows, four stretches: the record spans 25 of them.
  constexpr Eigen::Index rows = 1'000'000;
  sepcal::test::Draws draws(16);
  const Eigen::VectorXd z = sepcal::test::draw_autoregression(1.0 - 1.0 / 40'000, rows, draws) +
                            0.1 * sepcal::test::draw_noise("white", rows, draws);
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(rows, -1.0, 1.0);
  Record record;
  record.view("u", std::span(u.data(), static_cast<std::size_t>(rows)))
      .view("z", std::span(z.data(), static_cast<std::size_t>(rows)))
      .map([](std::size_t, std::size_t) {});
  const sepcal::Fit fit = sepcal::fit(sepcal::test::Line{}, record);
  // The closed form of a mean's variance: var (1 + phi) / (1 - phi) / N.
  const double level_error = std::sqrt(2.0 * 40'000 / static_cast<double>(rows));
  CHECK(fit["c"].standard_error > 0.5 * level_error);
  CHECK(fit["c"].standard_error < 1.5 * level_error);
  CHECK(fit["c"].standard_error_blocks < fit["c"].standard_error * 1.01);
}

TEST_CASE("what looks at whole columns is refused of a streamed flight") {
  const TemporaryFolder folder;
  const Flight flight = sepcal::stream_csv(magnetometer_log(folder, 600));
  CalibrationOptions options;
  options.fit.loss = sepcal::Loss::huber;
  CHECK_THROWS_WITH_AS(calibrate(flight, options), Contains("loss looks at whole columns"), Error);
  options = {};
  options.effects = {{.name = "current[current_a]"}};
  CHECK_THROWS_WITH_AS(calibrate(flight, options), Contains("looks at whole columns"), Error);
  options = {};
  options.log.drop_repeats = {"mx"};
  CHECK_THROWS_WITH_AS(calibrate(flight, options), Contains("drop_repeats"), Error);
}

}  // namespace streaming_test
