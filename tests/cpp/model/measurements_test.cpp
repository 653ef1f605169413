// SPDX-License-Identifier: BSD-3-Clause
// A record in a model's order, cut into blocks and chunks.
#include "model/measurements.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "model/fixed_model.hpp"
#include "sepcal/error.hpp"
#include "sepcal/static_model.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace measurements_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::Record;
using sepcal::model::Measurements;

namespace {

const auto line = sepcal::block_model(sepcal::test::Line{});

/// u counts the rows, z is its negative.
Record count_rows(std::size_t rows) {
  std::vector<double> u(rows);
  std::iota(u.begin(), u.end(), 0.0);
  std::vector<double> z = u;
  for (double& value : z) value = -value;
  Record record;
  record.add("z", z).add("u", u);
  return record;
}

/// z = s u (1 + gain) + offset, with two inputs that a record may lack.
struct LineWithPorts {
  static constexpr std::array inputs{
      sepcal::Quantity{"gain", "1", -sepcal::infinity, sepcal::infinity, 0.5},
      sepcal::Quantity{"u", "1"}, sepcal::port("offset", "1")};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> nonlinear{};
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 3>& u, const sepcal::Vec<X, 0>&) const {
    sepcal::Affine<X, 1, 1> z;
    z.A << u[1] * (1.0 + u[0]);
    z.b << u[2];
    return z;
  }
};

}  // namespace

TEST_CASE("an input that the record lacks takes its absent value in every row of every block") {
  const auto model = sepcal::block_model(LineWithPorts{});
  Record record = count_rows(600);
  const Measurements measurements(*model, record);
  std::vector<const double*> pointers;
  for (const auto& range : measurements.chunks().front()) {
    const sepcal::Block block = measurements.block(range, pointers);
    for (std::size_t row = 0; row < block.rows; ++row) {
      CHECK(block.inputs[0][row] == 0.5);
      CHECK(block.inputs[1][row] == static_cast<double>(range.first + row));
      CHECK(block.inputs[2][row] == 0.0);
    }
  }
  record.add("offset", std::vector<double>(600, -3.0));  // now it is there, and is read
  const Measurements logged(*model, record);
  const auto& last = logged.chunks().front().back();
  CHECK(logged.block(last, pointers).inputs[2] == record.column("offset").data() + last.first);
}

TEST_CASE("an absent value mends no column that is there and not finite") {
  Record record;
  record.add("u", {1, 2}).add("z", {1, 2});
  record.add("offset", {0, std::numeric_limits<double>::quiet_NaN()});
  CHECK_THROWS_WITH_AS(Measurements(*sepcal::block_model(LineWithPorts{}), record),
                       Contains("column 'offset' is not a finite number in row 1"), Error);
}

TEST_CASE("blocks cover every selected row once, in order, and never cross a segment's edge") {
  Record record = count_rows(10'000);
  record.cut({{"a", 3, 700}, {"b", 700, 701}, {"c", 1000, 9999}});
  const Measurements measurements(*line, record);
  CHECK(measurements.rows() == 697 + 1 + 8999);

  std::size_t offset = 0;
  std::size_t segment = 0;
  std::size_t next = 3;
  for (const auto& chunk : measurements.chunks()) {
    for (const auto& range : chunk) {
      const auto& segments = record.segments();
      if (next == segments[segment].last) next = segments[++segment].first;
      CHECK(range.first == next);
      CHECK(range.offset == offset);
      CHECK(range.starts_segment == (range.first == segments[segment].first));
      CHECK(range.rows > 0);
      CHECK(range.rows <= Measurements::block_rows);
      next += range.rows;
      offset += range.rows;
      CHECK(next <= segments[segment].last);
    }
  }
  CHECK(offset == measurements.rows());
  CHECK(measurements.chunks().size() == 3);  // 9697 rows, 4096 to a chunk
}

TEST_CASE("a block views the record's memory at its rows") {
  const Record record = count_rows(600);
  const Measurements measurements(*line, record);
  const auto& range = measurements.chunks().front()[1];
  std::vector<const double*> pointers;
  const sepcal::Block block = measurements.block(range, pointers);
  CHECK(block.inputs[0] == record.column("u").data() + Measurements::block_rows);
  CHECK(block.first == Measurements::block_rows);
  CHECK(block.rows == Measurements::block_rows);
  CHECK_FALSE(block.starts_segment);
  CHECK(measurements.output(0, range).data() ==
        record.column("z").data() + Measurements::block_rows);
}

TEST_CASE("what of the rows depends on u alone is kept of a short record, and not of a long one") {
  const sepcal::test::Simulated flight = sepcal::test::simulate_five_hole(1000);
  const sepcal::model::FixedModel fixed(*flight.model, {{"w_d", 0.0}, {"b_beta", 0.01}});
  for (const sepcal::BlockModel* model :
       {flight.model.get(), static_cast<const sepcal::BlockModel*>(&fixed)}) {
    Record record = flight.record;
    record.cut({{"a", 3, 390}, {"b", 400, 401}, {"c", 500, 999}});
    const Measurements measurements(*model, record);
    std::vector<const double*> pointers;
    const Eigen::VectorXd xi = Eigen::VectorXd::Constant(5, 0.02);
    for (const auto& range : measurements.chunks().front()) {
      sepcal::Block block = measurements.block(range, pointers);
      REQUIRE(block.kept != nullptr);
      const auto evaluate = [&] {
        const sepcal::Tables& tables = model->tables();
        Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(range.rows),
                             tables.n_1() + tables.n_2() + 1);
        model->evaluate(block, xi.data(), xi.data(), nullptr, rows);
        return rows;
      };
      CHECK(measurements.block({range.first, 1, range.offset}, pointers).kept == nullptr);
      block = measurements.block(range, pointers);
      const Eigen::MatrixXd from_kept = evaluate();
      block.kept = nullptr;
      CHECK(from_kept == evaluate());
    }
  }
  const std::size_t row = flight.model->kept_bytes(8) / 8;
  REQUIRE(row > 0);
  const Measurements many(
      *flight.model,
      sepcal::test::simulate_five_hole(Measurements::most_kept_bytes / row + 1000).record);
  std::vector<const double*> pointers;
  CHECK(many.block(many.chunks().front().front(), pointers).kept == nullptr);
}

TEST_CASE("the sum of squares is over the selected rows alone") {
  Record record = count_rows(600);
  record.cut({{"", 1, 4}, {"", 10, 11}});
  CHECK(Measurements(*line, record).output_square(0) == 1 + 4 + 9 + 100);
}

TEST_CASE("a column that is missing or not finite in a selected row is an error that names it") {
  Record missing;
  missing.add("u", {1, 2});
  CHECK_THROWS_WITH_AS(Measurements(*line, missing), Contains("column 'z' is missing"), Error);

  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL}) {
    Record record;
    record.add("u", {1, 2, 3, 4}).add("z", {1, 2, bad, 4});
    CHECK_THROWS_WITH_AS(Measurements(*line, record),
                         Contains("column 'z' is not a finite number in row 2"), Error);
    record.cut({{"", 0, 2}, {"", 3, 4}});
    CHECK_NOTHROW(Measurements(*line, record));
  }
}

}  // namespace measurements_test
