// SPDX-License-Identifier: BSD-3-Clause
// Points of xi2 side by side in lanes: each instruction set's kernels and factors against the
// scalar ones, and what lanes leave to them.
#include "model/point_lanes.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/aligned_doubles.hpp"
#include "base/thread_pool.hpp"
#include "flights_with_effects.hpp"
#include "model/fixed_model.hpp"
#include "model/lane_kit.hpp"
#include "model/sweep.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/lanes.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/static_composition.hpp"
#include "simulated_records.hpp"

namespace point_lanes_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Block;
using sepcal::BlockModel;
using sepcal::LaneBlock;
using sepcal::Record;
using sepcal::TriangularFactor;
using sepcal::base::ThreadPool;
using sepcal::lanes::LaneKit;
using sepcal::lanes::Panel;
using sepcal::lanes::ShippedModel;
using sepcal::model::Measurements;
using sepcal::model::PointFactors;
using sepcal::model::PointLanes;
using sepcal::model::Sweep;
using sepcal::test::Draws;
using sepcal::test::Simulated;

namespace {

using sepcal::base::AlignedDoubles;

std::vector<const LaneKit*> all_kits() {
  std::vector<const LaneKit*> kits;
  for (const std::size_t width : {2U, 4U, 8U}) {
    if (const LaneKit* kit = sepcal::lanes::lane_kit_of(width)) kits.push_back(kit);
  }
  return kits;
}

/// A kernel's rows of every point against evaluate()'s, relative to the largest of a column.
double largest_difference(const sepcal::LaneKernel& kernel, const void* of_model,
                          const BlockModel& model, const MatrixXd& points, Draws& draws) {
  constexpr std::size_t rows = 29;
  const int n_1 = model.tables().n_1();
  const int n_z = model.tables().n_z();
  const MatrixXd u = 20.0 * MatrixXd::Ones(rows, model.tables().n_u()) +
                     draws.normal_matrix(rows, model.tables().n_u());
  const MatrixXd z = draws.normal_matrix(rows, n_z);
  std::vector<const double*> inputs;
  std::vector<const double*> outputs;
  for (const auto column : u.colwise()) inputs.push_back(column.data());
  for (const auto column : z.colwise()) outputs.push_back(column.data());
  const std::size_t tiles = static_cast<std::size_t>(points.cols()) / kernel.width;
  AlignedDoubles packed;
  for (std::size_t t = 0; t < tiles; ++t) {
    for (Index k = 0; k < points.rows(); ++k) {
      for (std::size_t lane = 0; lane < kernel.width; ++lane) {
        packed.push_back(points(k, static_cast<Index>(t * kernel.width + lane)));
      }
    }
  }
  struct Seen {
    const BlockModel& model;
    const MatrixXd& points;
    const MatrixXd& z;
    const std::vector<const double*>& inputs;
    std::size_t width;
    double largest = 0.0;
  } seen{model, points, z, inputs, kernel.width};
  AlignedDoubles scratch(static_cast<std::size_t>(n_z * (n_1 + 1)) * rows * kernel.width);
  const auto visit = [](void* visitor, std::size_t tile, double* values) {
    Seen& all = *static_cast<Seen*>(visitor);
    const int columns = all.model.tables().n_1() + 1;
    const int n_outputs = all.model.tables().n_z();
    MatrixXd expected(n_outputs * static_cast<Index>(rows), columns);
    for (std::size_t lane = 0; lane < all.width; ++lane) {
      const VectorXd xi2 = all.points.col(static_cast<Index>(tile * all.width + lane));
      all.model.evaluate({all.inputs, rows, 0, true}, xi2.data(), nullptr, nullptr, expected);
      expected.col(columns - 1) = all.z.reshaped() - expected.col(columns - 1);
      for (int j = 0; j < n_outputs; ++j) {
        for (int c = 0; c < columns; ++c) {
          const auto own = expected.col(c).segment(j * static_cast<Index>(rows), rows);
          const double scale = std::max(1.0, own.cwiseAbs().maxCoeff());
          for (std::size_t i = 0; i < rows; ++i) {
            const double value =
                values[((static_cast<std::size_t>(j * columns + c)) * rows + i) * all.width + lane];
            const double off = std::abs(value - own[static_cast<Index>(i)]) / scale;
            all.largest = std::isnan(value) ? sepcal::infinity : std::max(all.largest, off);
          }
        }
      }
    }
  };
  const LaneBlock block{inputs.data(), outputs.data(), rows, 0, nullptr};
  CHECK(kernel.evaluate(of_model, block, {packed.data(), tiles}, scratch.data(), visit, &seen));
  return seen.largest;
}

/// The same model, evaluated number by number.
template <class M>
struct WithoutLanes : M {};

/// What of the rows the kernel keeps; empty where it keeps nothing.
AlignedDoubles kept_rows(const sepcal::LaneKernel& kernel, const void* of_model,
                         const std::vector<const double*>& inputs, std::size_t rows) {
  const std::size_t groups = (rows + kernel.width - 1) / kernel.width;
  AlignedDoubles kept(groups * kernel.kept_bytes / sizeof(double));
  if (!kept.empty()) kernel.keep(of_model, inputs.data(), rows, kept.data());
  return kept;
}

/// A kernel's [A | D | b] and [A | b] against evaluate()'s, relative to the largest of a column;
/// from rows that are kept they are the same to the last bit.
double largest_row_difference(const sepcal::LaneKernel& kernel, const void* of_model,
                              const BlockModel& model, const VectorXd& xi2, Draws& draws) {
  const Index n_1 = model.tables().n_1();
  const Index n_2 = model.tables().n_2();
  const Index n_z = model.tables().n_z();
  const VectorXd xi1 = draws.normal_matrix(n_1, 1);
  double largest = 0.0;
  for (const Index rows : {1, 8, 29}) {
    const MatrixXd u = 20.0 * MatrixXd::Ones(rows, model.tables().n_u()) +
                       draws.normal_matrix(rows, model.tables().n_u());
    std::vector<const double*> inputs;
    for (const auto column : u.colwise()) inputs.push_back(column.data());
    const auto count = static_cast<std::size_t>(rows);
    const Block block{inputs, count, 0, true};
    const auto stride = static_cast<std::size_t>(n_z * rows) + 3;
    const AlignedDoubles kept = kept_rows(kernel, of_model, inputs, count);
    for (const bool tangent : {false, true}) {
      const Index columns = n_1 + 1 + (tangent ? n_2 : 0);
      MatrixXd expected(n_z * rows, columns);
      model.evaluate(block, xi2.data(), tangent ? sepcal::values_of(xi1) : nullptr, nullptr,
                     expected);
      const auto fill = [&](const sepcal::LaneRows& lanes) {
        MatrixXd filled = MatrixXd::Constant(static_cast<Index>(stride), columns, 7.0);
        if (tangent) {
          kernel.fill_tangent(of_model, lanes, xi2.data(), xi1.data(), filled.data(), stride);
        } else {
          kernel.fill_values(of_model, lanes, xi2.data(), filled.data(), stride);
        }
        return filled;
      };
      const MatrixXd got = fill({inputs.data(), count});
      if (!kept.empty()) CHECK(fill({nullptr, count, kept.data()}) == got);
      CHECK((got.bottomRows(3).array() == 7.0).all());  // nothing beyond the rows
      for (Index c = 0; c < columns; ++c) {
        const double scale = std::max(1.0, expected.col(c).cwiseAbs().maxCoeff());
        const double off =
            (got.col(c).head(n_z * rows) - expected.col(c)).cwiseAbs().maxCoeff() / scale;
        largest = std::isnan(off) ? sepcal::infinity : std::max(largest, off);
      }
    }
  }
  return largest;
}

/// A kernel's derivatives by the inputs against input_tangent()'s, relative to the largest of a
/// column.
double largest_slope_difference(const sepcal::LaneKernel& kernel, const void* of_model,
                                const BlockModel& model, const VectorXd& xi2, Draws& draws) {
  constexpr Index rows = 29;
  const Index n_z = model.tables().n_z();
  const VectorXd xi1 = draws.normal_matrix(model.tables().n_1(), 1);
  const MatrixXd u = 20.0 * MatrixXd::Ones(rows, model.tables().n_u()) +
                     draws.normal_matrix(rows, model.tables().n_u());
  std::vector<const double*> inputs;
  for (const auto column : u.colwise()) inputs.push_back(column.data());
  double largest = 0.0;
  for (int i = 0; i < model.tables().n_u(); ++i) {
    const std::vector<int> which{i, 0};
    MatrixXd expected(n_z * rows, 2);
    MatrixXd got(n_z * rows, 2);
    model.input_tangent({inputs, rows, 0, true}, xi2.data(), sepcal::values_of(xi1), which,
                        expected);
    kernel.fill_input_tangent(of_model, {inputs.data(), rows}, xi2.data(), sepcal::values_of(xi1),
                              which.data(), 2, got.data(), static_cast<std::size_t>(n_z * rows));
    for (const Index c : {0, 1}) {
      const double scale = std::max(1.0, expected.col(c).cwiseAbs().maxCoeff());
      const double off = (got.col(c) - expected.col(c)).cwiseAbs().maxCoeff() / scale;
      largest = std::isnan(off) ? sepcal::infinity : std::max(largest, off);
    }
  }
  return largest;
}

template <class M>
void check_kernel(const LaneKit& kit, ShippedModel which, const M& model,
                  double tolerance = 1e-13) {
  CAPTURE(kit.name);
  CAPTURE(static_cast<int>(which));
  Draws draws(71);
  const auto scalar = sepcal::block_model(WithoutLanes<M>{model});
  const MatrixXd points = 0.1 * draws.normal_matrix(scalar->tables().n_2(), 32);
  const auto& kernel = kit.models[static_cast<std::size_t>(which)];
  CHECK(largest_difference(kernel, &model, *scalar, points, draws) < tolerance);
  CHECK(largest_row_difference(kernel, &model, *scalar, points.col(0), draws) < tolerance);
  CHECK(largest_slope_difference(kernel, &model, *scalar, points.col(0), draws) < 1e-12);
}

/// A user's own: lanes for the instruction set that this file is compiled for.
struct Wave {
  static constexpr std::array inputs{sepcal::Quantity{"t", "s"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}, sepcal::Quantity{"b", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"w", "rad/s", 0.5, 1.5}};
  using LanesOf = Wave;

  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    const auto [cosine, sine] = sepcal::cos_sin(X(xi2[0] * u[0]));
    sepcal::Affine<X, 1, 2> z;
    z.A << cosine, sine;
    z.b << X(0.0);
    return z;
  }
};

/// Largest relative difference of the factors by lanes to those point by point.
double largest_difference(const BlockModel& model, const Record& record, const MatrixXd& points) {
  const Measurements measurements(model, record);
  const PointLanes lanes(model, measurements, points);
  REQUIRE(lanes.width() > 1);
  const auto factors = lanes.factor(points, [] {});
  ThreadPool pool(1);
  const Sweep sweep(model, measurements, pool);
  double largest = 0.0;
  for (Index s = 0; s < points.cols(); ++s) {
    const auto factor = factors.factor(static_cast<std::size_t>(s));
    REQUIRE(factor);
    const MatrixXd expected =
        combine(sweep.linear_factors(points.col(s)), VectorXd::Ones(model.tables().n_z())).matrix();
    largest = std::max(largest, (factor->matrix() - expected).norm() / expected.norm());
  }
  return largest;
}

/// Factors of [A | z - b] at the points, by lanes where there are some.
PointFactors factors_in_lanes(const Simulated& flight, const MatrixXd& points) {
  const Measurements measurements(*flight.model, flight.record);
  const PointLanes lanes(*flight.model, measurements, points);
  REQUIRE(lanes.width() > 1);
  return lanes.factor(points, [] {});
}

TriangularFactor scalar_factor(const Simulated& flight, const VectorXd& xi2) {
  const Measurements measurements(*flight.model, flight.record);
  ThreadPool pool(1);
  const Sweep sweep(*flight.model, measurements, pool);
  return combine(sweep.linear_factors(xi2), VectorXd::Ones(flight.model->tables().n_z()));
}

double off(const TriangularFactor& factor, const TriangularFactor& expected) {
  return (factor.matrix() - expected.matrix()).norm() / expected.matrix().norm();
}

/// A tube whose record is the flight's, with one column changed.
Simulated with_column(const Simulated& flight, const std::string& name,
                      const std::function<double(double, std::size_t)>& change) {
  Simulated changed = flight;
  changed.record = Record();
  for (const std::string& column : flight.record.names()) {
    std::vector<double> values(flight.record.column(column).begin(),
                               flight.record.column(column).end());
    for (std::size_t i = 0; i < values.size() && column == name; ++i) {
      values[i] = change(values[i], i);
    }
    changed.record.add(column, std::move(values));
  }
  changed.record.cut(flight.record.segments());
  return changed;
}

}  // namespace

TEST_CASE("a kernel of any width gives what the model gives") {
  CHECK(!all_kits().empty());
  for (const LaneKit* kit : all_kits()) {
    check_kernel(*kit, ShippedModel::five_hole,
                 sepcal::FiveHoleProbe{4.5, 4.2, Eigen::Vector3d(0.35, 0.1, -0.02)});
    check_kernel(*kit, ShippedModel::magnetometer, sepcal::Magnetometer{});
    check_kernel(*kit, ShippedModel::attitude_independent,
                 sepcal::AttitudeIndependentMagnetometer{50.0, 0.3});
    check_kernel(*kit, ShippedModel::pitot_static, sepcal::PitotStatic{});
    check_kernel(*kit, ShippedModel::scalar_1, sepcal::ScalarExample1{});
    check_kernel(*kit, ShippedModel::scalar_2, sepcal::ScalarExample2{});
    // Angles of 20 rad are vanes across the air, too, where the direction loses a digit.
    check_kernel(*kit, ShippedModel::vane_boom, sepcal::VaneBoom{Eigen::Vector3d(0.35, 0.1, -0.02)},
                 1e-12);
  }
}

TEST_CASE("a factor in a lane is TriangularFactor's, down to a condition of 1e8") {
  for (const LaneKit* kit : all_kits()) {
    CAPTURE(kit->name);
    for (const int n : {1, 4, 7, sepcal::lanes::most_columns}) {
      CAPTURE(n);
      Draws draws(72);
      constexpr std::size_t m = 23;
      AlignedDoubles T(static_cast<std::size_t>(n * n) * kit->width, 0.0);
      std::vector<TriangularFactor> expected(kit->width, TriangularFactor(n));
      for (int block = 0; block < 3; ++block) {
        AlignedDoubles rows(static_cast<std::size_t>(n) * m * kit->width);
        for (std::size_t lane = 0; lane < kit->width; ++lane) {
          MatrixXd own = draws.normal_matrix(m, n);
          if (n > 1) own.col(n - 1) = own.col(0) + 1e-8 * own.col(n - 1);
          for (int c = 0; c < n; ++c) {
            for (std::size_t i = 0; i < m; ++i) {
              rows[(static_cast<std::size_t>(c) * m + i) * kit->width + lane] =
                  own(static_cast<Index>(i), c);
            }
          }
          expected[lane].absorb(own);
        }
        const auto count = static_cast<std::size_t>(n);
        const Panel panel = sepcal::lanes::stack_panel(*kit, count, T.data(), rows.data(), m);
        CHECK(sepcal::lanes::absorb_panels(*kit, {&panel, 1}, m));
      }
      for (std::size_t lane = 0; lane < kit->width; ++lane) {
        MatrixXd own = MatrixXd::Zero(n, n);
        for (int i = 0; i < n; ++i) {
          for (int c = i; c < n; ++c) {
            own(i, c) = T[static_cast<std::size_t>(i * n + c) * kit->width + lane];
          }
          if (own(i, i) < 0) own.row(i) *= -1;
        }
        CHECK((own - expected[lane].matrix()).norm() < 1e-14 * expected[lane].matrix().norm());
      }
    }
  }
}

TEST_CASE("a record's factors by lanes are those of each point") {
  for (const Simulated& flight : sepcal::test::simulate_all(5'000)) {
    CAPTURE(flight.name);
    Draws draws(73);
    const MatrixXd points = 0.1 * draws.normal_matrix(flight.xi2.size(), 21);  // no whole tiles
    const auto factors = factors_in_lanes(flight, points);
    for (Index s = 0; s < points.cols(); ++s) {
      const auto factor = factors.factor(static_cast<std::size_t>(s));
      REQUIRE(factor);
      const TriangularFactor expected = scalar_factor(flight, points.col(s));
      CHECK(off(*factor, expected) < 1e-13);
      CHECK(factors.remaining_square(static_cast<std::size_t>(s)) ==
            doctest::Approx(remaining_square(expected)).epsilon(1e-12));
    }
  }
}

TEST_CASE("what lanes can't tell is left to the scalar way: squares that underflow, NaN") {
  const Simulated flight = sepcal::test::simulate_scalar_1(300);
  const MatrixXd points = MatrixXd::Constant(1, 5, 0.1);
  const auto tiny = with_column(flight, "z", [](double z, std::size_t) { return 1e-120 * z; });
  const auto huge = with_column(flight, "z", [](double z, std::size_t) { return 1e120 * z; });
  CHECK(factors_in_lanes(huge, points).factor(4) == std::nullopt);
  CHECK(factors_in_lanes(flight, points).factor(4) != std::nullopt);
  MatrixXd broken = points;
  broken(0, 2) = sepcal::not_a_number;
  CHECK(factors_in_lanes(flight, broken).factor(2) == std::nullopt);

  const Measurements measurements(*tiny.model, tiny.record);
  ThreadPool pool(1);
  const VectorXd all = Sweep(*tiny.model, measurements, pool).sample_squares(points, {});
  const double expected = remaining_square(scalar_factor(tiny, points.col(3)));
  CHECK(all[3] == doctest::Approx(expected).epsilon(1e-12));
}

TEST_CASE("an entry of A that is zero where it was looked for, and not everywhere") {
  const Simulated flight = sepcal::test::simulate_magnetometer(6'000);
  const Simulated one_row =
      with_column(flight, "hx", [](double hx, std::size_t row) { return row == 300 ? hx : 0.0; });
  Draws draws(74);
  const MatrixXd points = 0.05 * draws.normal_matrix(6, 9);
  CHECK(factors_in_lanes(one_row, points).factor(0) == std::nullopt);
  const Measurements measurements(*one_row.model, one_row.record);
  ThreadPool pool(2);
  const VectorXd all = Sweep(*one_row.model, measurements, pool).sample_squares(points, {});
  for (const Index s : {0, 8}) {
    const double expected = remaining_square(scalar_factor(one_row, points.col(s)));
    CHECK(all[s] == doctest::Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("effects that vary parameters keep the lanes") {
  const auto lanes_with = [](const char* name, const std::vector<std::string>& effects) {
    const auto probe = sepcal::test::make_probe_called(name);
    const auto flight = sepcal::test::make_flight(sepcal::test::fly(name, {}, {.noise = 0.1}));
    std::vector<sepcal::EffectSetting> settings;
    for (const std::string& effect : effects) settings.push_back({.name = effect});
    const auto made =
        sepcal::with_effects(*probe, flight, probe->prepare(flight, {}), settings, {});
    Draws draws(75);
    const MatrixXd points = 0.1 * draws.normal_matrix(made.model->tables().n_2(), 11);
    return largest_difference(*made.model, made.prepared.record, points);
  };
  CHECK(lanes_with("magnetometer", {"bias[temp_degc]", "scale[current_a]"}) < 1e-13);
  CHECK(lanes_with("five-hole", {"wind[spline(time,6)]", "airspeed_bias[throttle]"}) < 1e-13);
}

/// A model with an effect, in lanes and number by number.
template <class M>
void check_in_lanes(const M& model, std::uint64_t seed) {
  Draws draws(seed);
  const auto in_lanes = sepcal::in_lanes(model);
  const auto scalar = sepcal::block_model(model);
  const auto& kernel = sepcal::lane_kernel<sepcal::InLanes<M>>();
  CHECK(scalar->lane_width() == 0);
  CHECK(sepcal::block_model(in_lanes)->lane_width() == kernel.width);
  const MatrixXd points = 0.1 * draws.normal_matrix(scalar->tables().n_2(), 16);
  CHECK(largest_difference(kernel, &in_lanes, *scalar, points, draws) < 1e-13);
  CHECK(largest_row_difference(kernel, &in_lanes, *scalar, points.col(0), draws) < 1e-13);
}

TEST_CASE("a model composed with effects at compile time has lanes where its user asks for them") {
  const sepcal::FiveHoleProbe probe{4.5, 4.2, Eigen::Vector3d(0.35, 0.1, -0.02)};
  check_in_lanes(probe + sepcal::effects::LeverArm{}, 78);     // a term
  check_in_lanes(probe + sepcal::effects::HeadingBias{}, 79);  // a correction
  check_in_lanes(probe + sepcal::effects::LeverArm{} + sepcal::effects::HeadingBias{}, 80);
  check_in_lanes(sepcal::Magnetometer{} + sepcal::effects::CubicNonlinearity{}, 81);
  static_assert(sepcal::HoistedModel<decltype(probe + sepcal::effects::LeverArm{})>);
}

TEST_CASE("held parameters keep the lanes") {
  const Simulated flight = sepcal::test::simulate_five_hole(700);
  const sepcal::model::FixedModel held(
      *flight.model, {{"b_va", 0.7}, {"w_d", 0.0}, {"b_alpha", 0.02}, {"eps_phi", -0.01}});
  Draws draws(76);
  CHECK(largest_difference(held, flight.record, 0.1 * draws.normal_matrix(3, 10)) < 1e-13);
}

TEST_CASE("a user's model with lanes fits as one without") {
  Record record;
  Draws draws(77);
  std::vector<double> time(300);
  std::vector<double> z(300);
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] = 0.05 * static_cast<double>(i);
    z[i] = 2.0 * std::cos(1.1 * time[i]) - std::sin(1.1 * time[i]) + 0.1 * draws.normal();
  }
  record.add("t", time).add("z", z);
  const auto with = sepcal::block_model(Wave{});
  const auto without = sepcal::block_model(WithoutLanes<Wave>{});
  CHECK(with->lane_width() == xsimd::batch<double>::size);
  CHECK(without->lane_width() == 0);
  CHECK(largest_difference(*with, record, MatrixXd::Constant(1, 3, 0.9)) < 1e-13);
  const sepcal::Fit one = sepcal::fit(*with, record);
  const sepcal::Fit other = sepcal::fit(*without, record);
  CHECK(one["w"].value == doctest::Approx(1.1).epsilon(0.01));
  for (const sepcal::Parameter& parameter : one.parameters) {
    const double off = std::abs(parameter.value - other[parameter.name].value);
    CHECK(off < 1e-9 * parameter.standard_error);
  }
}

TEST_CASE("sine and cosine in lanes are right to an ulp, small angles and others side by side") {
  using Wide = sepcal::Batch<xsimd::default_arch>;
  constexpr std::size_t width = Wide::size;
  const double quarter = std::atan(1.0);
  Draws draws(74);
  double largest = 0.0;
  for (int trial = 0; trial < 20'000; ++trial) {
    alignas(64) std::array<double, width> x{};
    alignas(64) std::array<double, width> cosine{};
    alignas(64) std::array<double, width> sine{};
    for (double& angle : x) angle = quarter * std::tanh(0.3 * (trial % 9) * draws.normal());
    if (trial % 3 == 0) x[static_cast<std::size_t>(trial) % width] *= 50.0;
    const auto [c, s] = sepcal::lanes::cos_sin(Wide::load_aligned(x.data()));
    c.store_aligned(cosine.data());
    s.store_aligned(sine.data());
    for (std::size_t lane = 0; lane < width; ++lane) {
      const auto angle = static_cast<long double>(x[lane]);
      const auto off_in_ulps = [](double value, long double truth) {
        const auto rounded = std::abs(static_cast<double>(truth));
        const double ulp = std::nextafter(rounded, 2.0) - rounded;
        return std::abs(static_cast<double>(static_cast<long double>(value) - truth)) / ulp;
      };
      largest = std::max({largest, off_in_ulps(cosine[lane], std::cos(angle)),
                          off_in_ulps(sine[lane], std::sin(angle))});
    }
  }
  CHECK(largest < 1.5);
  const auto [c, s] = sepcal::lanes::cos_sin(Wide(sepcal::not_a_number));
  CHECK(std::isnan(c.get(0)));
  CHECK(std::isnan(s.get(0)));
}

}  // namespace point_lanes_test
