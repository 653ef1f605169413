// SPDX-License-Identifier: BSD-3-Clause
// Cross-validation against refits of dense least squares, fold by fold; how rows are dealt to
// blocks, and which blocks are judged.
#include "diagnosis/held_out.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/candidate.hpp"
#include "diagnosis/projection.hpp"
#include "diagnosis/refits.hpp"
#include "linearisations.hpp"
#include "noises.hpp"
#include "small_models.hpp"

namespace diagnosis_held_out_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;

namespace {

/// Rows of every output that some block of `folds` has and `wanted` says.
template <class Wanted>
std::vector<Index> rows_of(const diagnosis::RowLayout& layout, const diagnosis::Folds& folds,
                           const Wanted& wanted) {
  std::vector<Index> rows;
  for (const diagnosis::HeldOutBlock& block : folds.blocks) {
    if (!wanted(block)) continue;
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      for (Index i = block.first; i < block.last; ++i) rows.push_back(layout.first(j) + i);
    }
  }
  return rows;
}

VectorXd scales_of(const diagnosis::RowLayout& layout) {
  VectorXd scales(layout.count());
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    scales.segment(layout.first(j), layout.rows).setConstant(layout.outputs[j].scale);
  }
  return scales;
}

/// The squared error of each judged block, predicted by what all other folds determine.
std::vector<double> refit_every_fold(const diagnosis::RowLayout& layout, const MatrixXd& columns,
                                     const VectorXd& z, const diagnosis::Folds& folds) {
  std::vector<double> squares;
  const VectorXd scales = scales_of(layout);
  for (const diagnosis::HeldOutBlock& block : folds.blocks) {
    if (!block.judged) continue;
    const auto others = rows_of(layout, folds, [&](const diagnosis::HeldOutBlock& other) {
      return other.fold != block.fold;
    });
    const auto own = rows_of(layout, folds, [&](const diagnosis::HeldOutBlock& other) {
      return other.first == block.first;
    });
    const VectorXd x = least_squares(columns(others, Eigen::all), z(others));
    squares.push_back(
        scales(own).cwiseProduct(z(own) - columns(own, Eigen::all) * x).squaredNorm());
  }
  return squares;
}

/// A model of two outputs on five segments, with a candidate of two columns that is at work.
struct Flight {
  Draws draws{21};
  diagnosis::RowLayout layout =
      make_layout({{"a", 60}, {"b", 45}, {"c", 70}, {"c", 25}, {"d", 100}}, {0.2, 3.0});
  MatrixXd tangent = draws.normal_matrix(600, 4);
  MatrixXd G = draws.normal_matrix(600, 2);
  diagnosis::LinearisedFit fit = fit_to(
      layout, tangent, G* Eigen::Vector2d(0.5, -0.3) + VectorXd(draws.normal_matrix(600, 1)));

  MatrixXd both() const {
    MatrixXd columns(600, 6);
    columns << tangent, G;
    return columns;
  }
};

void check_is_refit(const Flight& flight, const diagnosis::Folds& folds) {
  const auto before = refit_every_fold(flight.layout, flight.tangent, flight.fit.residual, folds);
  const auto after = refit_every_fold(flight.layout, flight.both(), flight.fit.residual, folds);
  const auto judged = rows_of(flight.layout, folds, [](const auto& block) { return block.judged; });
  const diagnosis::HeldOut expected =
      diagnosis::summarise(before, after, static_cast<double>(judged.size()));
  const diagnosis::HeldOut found = diagnosis::hold_out(flight.fit, flight.G, folds);
  REQUIRE(found.judged);
  CHECK(found.before == Approx(expected.before).epsilon(1e-10));
  CHECK(found.after == Approx(expected.after).epsilon(1e-10));
  CHECK(found.gain == Approx(1.0 - expected.after / expected.before).epsilon(1e-9));
  CHECK(found.passed == expected.passed);
  diagnosis::LinearisedFit in_basis = flight.fit;
  diagnosis::orthonormalise(in_basis);
  const diagnosis::HeldOut again = diagnosis::hold_out(in_basis, flight.G, folds);
  CHECK(again.before == Approx(found.before).epsilon(1e-10));
  CHECK(again.after == Approx(found.after).epsilon(1e-10));
}

/// Blocks one after another over all rows, none of them empty.
void check_covers(const diagnosis::RowLayout& layout, const diagnosis::Folds& folds) {
  Index row = 0;
  for (const diagnosis::HeldOutBlock& block : folds.blocks) {
    CHECK(block.first == row);
    CHECK(block.last > block.first);
    CHECK(block.fold >= 0);
    CHECK(block.fold < folds.count);
    CHECK(block.judged);
    row = block.last;
  }
  CHECK(row == layout.rows);
}

}  // namespace

TEST_CASE("whole segments held out: what refits to the others predict") {
  const Flight flight;
  check_is_refit(flight, diagnosis::whole_segments(flight.layout));
}

TEST_CASE("interleaved blocks held out: what refits to the other folds predict") {
  const Flight flight;
  diagnosis::Folds folds = diagnosis::interleaved_blocks(flight.layout, 1.5, 0);
  check_is_refit(flight, folds);
  folds.blocks[3].judged = folds.blocks[8].judged = false;
  check_is_refit(flight, folds);
}

TEST_CASE("the errors are in the outputs' unit, over all outputs") {
  const Flight flight;
  const VectorXd scaled = scales_of(flight.layout).cwiseProduct(flight.fit.residual);
  CHECK(diagnosis::total_rmse(flight.layout, flight.fit.residual) ==
        Approx(scaled.norm() / std::sqrt(600.0)).epsilon(1e-12));
  const diagnosis::HeldOut found = diagnosis::hold_out(
      flight.fit, flight.G, diagnosis::interleaved_blocks(flight.layout, 1.0, 0));
  CHECK(found.before ==
        Approx(diagnosis::total_rmse(flight.layout, flight.fit.residual)).epsilon(0.05));
}

TEST_CASE("an effect at work gains and passes; noise that fits by chance does not") {
  Flight flight;
  const diagnosis::Folds folds = diagnosis::interleaved_blocks(flight.layout, 1.0, 0);
  const diagnosis::HeldOut real = diagnosis::hold_out(flight.fit, flight.G, folds);
  CHECK(real.passed);
  CHECK(real.gain > 0.1);
  int passed = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const diagnosis::HeldOut chance =
        diagnosis::hold_out(flight.fit, flight.draws.normal_matrix(600, 1), folds);
    passed += chance.passed ? 1 : 0;
    CHECK(chance.gain < 0.02);
  }
  CHECK(passed < 15);
}

TEST_CASE("whole segments: a run of one label is one fold, and four are needed") {
  const diagnosis::RowLayout four =
      make_layout({{"a", 5}, {"b", 3}, {"b", 4}, {"c", 9}, {"a", 2}}, {1.0});
  const diagnosis::Folds folds = diagnosis::whole_segments(four);
  CHECK(folds.count == 4);
  CHECK_FALSE(folds.interleaved);
  REQUIRE(folds.blocks.size() == 4);
  check_covers(four, folds);
  CHECK(folds.blocks[1].last - folds.blocks[1].first == 7);
  for (std::size_t i = 0; i < 4; ++i) CHECK(folds.blocks[i].fold == static_cast<int>(i));

  const diagnosis::Folds none =
      diagnosis::whole_segments(make_layout({{"a", 5}, {"b", 3}, {"b", 4}, {"c", 9}}, {1.0}));
  CHECK(none.count == 0);
  CHECK(none.blocks.empty());
}

TEST_CASE("interleaved blocks cover all rows once, ten correlation times long where they can be") {
  struct Case {
    std::size_t rows;
    double correlation;
    int fewest;
    std::size_t blocks;
  };
  for (const auto& [rows, correlation, fewest, blocks] :
       {Case{6000, 1.0, 0, 60}, Case{6000, 20.0, 0, 30}, Case{6000, 19.0, 0, 31},
        Case{6000, 500.0, 0, 12}, Case{6000, 500.0, 35, 35}, Case{6000, 500.0, 200, 200},
        Case{6000, 20.0, 12, 30}, Case{25, 3.0, 0, 12}, Case{7, 1.0, 0, 7}}) {
    CAPTURE(rows);
    CAPTURE(correlation);
    CAPTURE(fewest);
    const diagnosis::RowLayout layout =
        make_layout({{"a", rows / 3}, {"b", rows - rows / 3}}, {1.0, 2.0});
    const diagnosis::Folds folds = diagnosis::interleaved_blocks(layout, correlation, fewest);
    CHECK(folds.blocks.size() == blocks);
    CHECK(folds.interleaved);
    CHECK(folds.count == 6);
    check_covers(layout, folds);
    for (std::size_t i = 0; i + 1 < folds.blocks.size(); ++i) {
      CHECK(folds.blocks[i].fold != folds.blocks[i + 1].fold);
    }
  }
}

TEST_CASE("the end blocks of a ramp would be extrapolated to: they are not judged") {
  const diagnosis::RowLayout layout = make_layout({{"", 1200}}, {1.0});
  diagnosis::Folds folds = diagnosis::interleaved_blocks(layout, 10.0, 0);
  REQUIRE(folds.blocks.size() == 12);
  const VectorXd ramp = VectorXd::LinSpaced(1200, -3.0, 5.0);
  diagnosis::judge_interpolated(layout, ramp, folds);
  for (std::size_t i = 0; i < 12; ++i) {
    CAPTURE(i);
    CHECK(folds.blocks[i].judged == (i != 0 && i != 11));
  }
  diagnosis::judge_interpolated(layout, VectorXd(ramp.array().sin()), folds);
  CHECK(std::ranges::all_of(folds.blocks, &sepcal::diagnosis::HeldOutBlock::judged));

  MatrixXd both(1200, 2);
  both << VectorXd(ramp.array().sin()), ramp;
  diagnosis::judge_interpolated(layout, both, folds);
  CHECK_FALSE(folds.blocks.front().judged);
  CHECK_FALSE(folds.blocks.back().judged);
}

TEST_CASE("so it is where the ramp is in one output of three, and larger in one than in another") {
  const diagnosis::RowLayout layout = make_layout({{"", 1200}}, {1.0, 1.0, 1.0});
  const VectorXd ramp = VectorXd::LinSpaced(1200, -3.0, 5.0);
  for (const double share : {0.0, 0.1, -1.0}) {
    CAPTURE(share);
    VectorXd column = VectorXd::Zero(3600);
    column.head(1200) = ramp;
    column.tail(1200) = share * ramp;
    diagnosis::Folds folds = diagnosis::interleaved_blocks(layout, 10.0, 0);
    diagnosis::judge_interpolated(layout, column, folds);
    for (std::size_t i = 0; i < 12; ++i) CHECK(folds.blocks[i].judged == (i != 0 && i != 11));
  }
}

TEST_CASE("a segment in which alone the driver moved is not judged") {
  const diagnosis::RowLayout layout =
      make_layout({{"a", 50}, {"b", 50}, {"c", 50}, {"d", 50}}, {1.0});
  VectorXd driver = VectorXd::Zero(200);
  driver.segment(100, 50).setOnes();
  diagnosis::Folds folds = diagnosis::whole_segments(layout);
  diagnosis::judge_interpolated(layout, driver, folds);
  for (std::size_t i = 0; i < 4; ++i) CHECK(folds.blocks[i].judged == (i != 2));
  driver[20] = 1.0;
  diagnosis::judge_interpolated(layout, driver, folds);
  CHECK(folds.blocks[2].judged);
}

TEST_CASE("the rule: the mean gain of a block exceeds its standard error") {
  const std::vector<double> before{4.0, 5.0, 6.0, 5.0};
  // Gains of 1, 1, 1, -0.7: mean 0.575, standard error 0.425.
  const diagnosis::HeldOut passed = diagnosis::summarise(before, {3.0, 4.0, 5.0, 5.7}, 80.0);
  CHECK(passed.judged);
  CHECK(passed.passed);
  CHECK(passed.before == Approx(0.5));
  CHECK(passed.after == Approx(std::sqrt(17.7 / 80.0)));
  CHECK(passed.gain == Approx(1.0 - std::sqrt(17.7 / 20.0)));
  // 1, 1, 1, -1.1: mean 0.475, standard error 0.525.
  CHECK_FALSE(sepcal::diagnosis::summarise(before, {3.0, 4.0, 5.0, 6.1}, 80.0).passed);
  CHECK_FALSE(sepcal::diagnosis::summarise(before, before, 80.0).passed);
  CHECK_FALSE(sepcal::diagnosis::summarise({4.0, 5.0, 6.0}, {1.0, 1.0, 1.0}, 60.0).judged);
  CHECK_FALSE(sepcal::diagnosis::summarise({}, {}, 0.0).judged);
}

TEST_CASE("correlation is integrated over its time, within segments, of the slowest output") {
  Draws draws(5);
  const diagnosis::RowLayout layout = make_layout({{"a", 3000}, {"b", 5000}}, {1.0, 1.0});
  VectorXd residual(16'000);
  residual << draw_noise("white", 8000, draws), draw_noise("AR(0.9)", 8000, draws);
  CHECK(diagnosis::correlation_rows(layout, residual) ==
        Approx(1.9 / 0.1).epsilon(0.3));  // (1 + r)/(1 - r)
  residual.tail(8000) = draw_noise("white", 8000, draws);
  CHECK(diagnosis::correlation_rows(layout, residual) == Approx(1.0).epsilon(0.1));
}

TEST_CASE("real fits and one step agree for a linear model on any selection of rows") {
  Draws draws(9);
  Record record;
  record.add("u", draws.uniform_column(700, -2.0, 2.0));
  record.add("heat", draws.uniform_column(700, 0.0, 5.0));
  std::vector<double> z(700);
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] =
        1.5 * record.column("u")[i] - 0.7 + 0.05 * record.column("heat")[i] + 0.3 * draws.normal();
  }
  record.add("z", std::move(z));
  const auto model = block_model(Line{});
  const std::vector<Segment> rows{{"a", 10, 130}, {"b", 150, 320}, {"c", 330, 690}};
  Record used = record;
  used.cut(rows);
  const DiagnosedFit fitted{.model = model,
                            .kit = plain_kit(model->tables()),
                            .effects = {},
                            .record = record,
                            .rows = rows,
                            .fit = fit(*model, used)};
  base::ThreadPool pool(2);
  diagnosis::CandidateRoom room(fitted, pool);
  const diagnosis::Candidate candidate = room.make("c[heat]");
  diagnosis::Folds folds = diagnosis::interleaved_blocks(room.fit().layout, 1.0, 0);
  folds.blocks[2].judged = false;
  const double shape = candidate.shape.values.front();
  const diagnosis::HeldOut by_steps =
      diagnosis::hold_out(room.fit(), room.columns(candidate, shape).whole, folds);
  const diagnosis::HeldOut by_fits = diagnosis::Refits(room).hold_out(candidate, shape, folds);
  REQUIRE(by_fits.judged);
  CHECK(by_fits.before == Approx(by_steps.before).epsilon(1e-7));
  CHECK(by_fits.after == Approx(by_steps.after).epsilon(1e-7));
  CHECK(by_fits.passed == by_steps.passed);
  CHECK(by_steps.after < 0.999 * by_steps.before);
}

}  // namespace diagnosis_held_out_test
