// SPDX-License-Identifier: BSD-3-Clause
// Effects written as structs, made into run-time effects.
#include "sepcal/detail/run_time_effect.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "composed_checks.hpp"

namespace static_effect_test {

using Eigen::Index;
using Eigen::MatrixXd;
using sepcal::Quantity;
using sepcal::Vec;
using namespace sepcal::test;

namespace {

/// z = [u a^k, b]: a term with a nonlinear parameter.
struct Growing {
  static constexpr std::array inputs{Quantity{"u", "1"}, Quantity{"a", "1"}};
  static constexpr std::array linear{Quantity{"growing.s", "1"}, Quantity{"growing.c", "1"}};
  static constexpr std::array nonlinear{Quantity{"growing.k", "1", 0.5, 2.0}};

  template <class U, class X>
  Eigen::Matrix<X, 2, 2> columns(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    using std::exp;
    using std::log;
    Eigen::Matrix<X, 2, 2> G;
    G << u[0] * exp(xi2[0] * log(u[1])), X(0.0), X(0.0), X(1.0);
    return G;
  }
};

/// Swaps and scales: u' = k v^2, v' = u + k.
struct Crossed {
  static constexpr int corrected = 2;
  static constexpr std::array inputs{Quantity{"u", "1"}, Quantity{"v", "1"}, Quantity{"w", "1"}};
  static constexpr std::array nonlinear{Quantity{"crossed.k", "1", -1, 1}};

  template <class T>
  Vec<T, 2> correct(const Vec<T, 3>& u, const Vec<T, 1>& xi2) const {
    return {xi2[0] * u[1] * u[1], u[0] + xi2[0] + u[2]};
  }
};

static_assert(sepcal::Term<Growing> && !sepcal::InputCorrection<Growing>);
static_assert(sepcal::InputCorrection<Crossed> && !sepcal::Term<Crossed>);
static_assert(sepcal::outputs_of_term<Growing> == 2);

}  // namespace

TEST_CASE("a term becomes a model of its own, z = columns xi1, bounds and all") {
  const sepcal::Effect effect = sepcal::effect("growing", Growing{});
  CHECK(effect.name == "growing");
  CHECK(effect.corrections.empty());
  REQUIRE(effect.terms.size() == 1);
  const sepcal::BlockModel& term = *effect.terms.front();
  CHECK(names_of(term.tables().linear) == std::vector<std::string>{"growing.s", "growing.c"});
  CHECK(term.tables().nonlinear[0].lower == 0.5);
  CHECK(term.tables().n_z() == 2);
  sepcal::Record record;
  record.add("u", {2, -3}).add("a", {4, 9});
  const NamedValues values{{"growing.s", 5}, {"growing.c", 7}, {"growing.k", 0.5}};
  const MatrixXd rows = tangent_rows(term, record, values);
  MatrixXd expected(4, 4);                                                   // s, c, k, b
  expected << 4, 0, 5 * 4 * std::log(4), 0, -9, 0, -5 * 9 * std::log(9), 0,  //
      0, 1, 0, 0, 0, 1, 0, 0;
  CHECK((rows - expected).norm() < 1e-12);
  check_input_tangent(term, record, values);
}

TEST_CASE("a correction keeps its tables and gives values and derivatives") {
  const sepcal::Effect effect = sepcal::effect("crossed", Crossed{});
  CHECK(effect.terms.empty());
  REQUIRE(effect.corrections.size() == 1);
  const sepcal::Correction& correction = *effect.corrections.front();
  CHECK(names_of(correction.inputs()) == std::vector<std::string>{"u", "v", "w"});
  CHECK(names_of(correction.nonlinear()) == std::vector<std::string>{"crossed.k"});
  CHECK(correction.corrected() == 2);
  for (int i = 0; i < 3; ++i) CHECK_FALSE(correction.is_driver(i));

  const double u[] = {1, 2};
  const double v[] = {3, 4};
  const double w[] = {5, 6};
  const double* const inputs[] = {u, v, w};
  const double k = 0.5;
  MatrixXd values(2, 2);
  MatrixXd slopes(2, 8);
  correction.evaluate({inputs, 2, 0, true}, &k, values, &slopes);
  MatrixXd expected(2, 2);
  expected << 4.5, 6.5, 8, 8.5;
  CHECK((values - expected).norm() < 1e-14);
  MatrixXd expected_slopes(2, 8);  // u, v, w, k of u', then of v'
  expected_slopes << 0, 3, 0, 9, 1, 0, 1, 1, 0, 4, 0, 16, 1, 0, 1, 1;
  CHECK((slopes - expected_slopes).norm() < 1e-14);
  MatrixXd alone(2, 2);
  correction.evaluate({inputs, 2, 0, true}, &k, alone, nullptr);
  CHECK((alone - expected).norm() < 1e-14);
}

}  // namespace static_effect_test
