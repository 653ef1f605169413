// SPDX-License-Identifier: BSD-3-Clause
// The concept of a separable model, as the compiler sees it; tests/reject shows its messages.
#include "sepcal/detail/model.hpp"

#include <ceres/jet.h>
#include <doctest/doctest.h>

#include <array>
#include <cmath>

namespace model_test {

using sepcal::Affine;
using sepcal::Quantity;
using sepcal::SeparableModel;
using sepcal::Sizes;
using sepcal::Vec;

namespace {

struct Good {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}, Quantity{"y", "1"}};
  static constexpr std::array linear{Quantity{"a", "1"}};
  static constexpr std::array nonlinear{Quantity{"b", "1"}, Quantity{"c", "1"}, Quantity{"d", "1"}};
  template <class U, class X>
  Affine<X, 2, 1> at(const Vec<U, 1>&, const Vec<X, 3>&) const {
    return {};
  }
};

struct OnlyLinear : Good {
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Affine<X, 2, 1> at(const Vec<U, 1>&, const Vec<X, 0>&) const {
    return {};
  }
};

struct OnlyNonlinear : Good {
  static constexpr std::array<Quantity, 0> linear{};
  template <class U, class X>
  Affine<X, 2, 0> at(const Vec<U, 1>&, const Vec<X, 3>&) const {
    return {};
  }
};

struct ColumnTooMany : Good {
  template <class U, class X>
  Affine<X, 2, 2> at(const Vec<U, 1>&, const Vec<X, 3>&) const {
    return {};
  }
};

struct WithState : Good {
  template <class U, class X>
  Affine<X, 2, 1> at(const Vec<U, 1>&, const Vec<X, 3>&) {
    return {};
  }
};

struct NothingMeasured : Good {
  static constexpr std::array<Quantity, 0> outputs{};
};

static_assert(SeparableModel<Good>);
static_assert(SeparableModel<OnlyLinear>);
static_assert(SeparableModel<OnlyNonlinear>);
static_assert(!SeparableModel<ColumnTooMany>);
static_assert(!SeparableModel<WithState>);
static_assert(!SeparableModel<NothingMeasured>);
static_assert(!SeparableModel<int>);

static_assert(Sizes<Good>::n_u == 1 && Sizes<Good>::n_z == 2);
static_assert(Sizes<Good>::n_1 == 1 && Sizes<Good>::n_2 == 3);

}  // namespace

TEST_CASE("every entry of A and b starts as NaN, so that a forgotten one is seen") {
  const Affine<double, 3, 2> plain;
  CHECK(plain.A.array().isNaN().all());
  CHECK(plain.b.array().isNaN().all());

  const Affine<ceres::Jet<double, 2>, 2, 1> dual;
  for (int j = 0; j < 2; ++j) {
    CHECK(std::isnan(dual.A(j, 0).a));
    CHECK(std::isnan(dual.b[j].a));
  }
}

}  // namespace model_test
