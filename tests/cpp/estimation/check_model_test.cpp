// SPDX-License-Identifier: BSD-3-Clause
// What the concept can't see: entries never set, answers that change, derivatives cast away.
#include "sepcal/check_model.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>

#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace check_model_test {

using doctest::Contains;
using sepcal::check_model;
using sepcal::Error;
using sepcal::Record;

namespace {

/// z = a cos(u + b) + c, y = a u.
struct Sound {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}, sepcal::Quantity{"y", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}, sepcal::Quantity{"c", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"b", "1", -0.5, 0.5}};

  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::cos;
    sepcal::Affine<X, 2, 2> z;
    z.A << cos(u[0] + xi2[0]), X(1.0), X(u[0]), X(0.0);
    z.b << X(0.0), X(0.0);
    return z;
  }
};

struct EntryNeverSet : Sound {
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    const auto sound = Sound::at(u, xi2);
    sepcal::Affine<X, 2, 2> z;
    z.A.row(0) = sound.A.row(0);
    z.A(1, 0) = sound.A(1, 0);
    z.b = sound.b;
    return z;
  }
};

struct OffsetNeverSet : Sound {
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    sepcal::Affine<X, 2, 2> z;
    z.A = Sound::at(u, xi2).A;
    z.b[0] = X(0.0);
    return z;
  }
};

struct Whimsical : Sound {
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    static double calls = 0;
    auto z = Sound::at(u, xi2);
    z.A(0, 1) = X(1.0 + 1e-15 * ++calls);
    return z;
  }
};

struct DerivativeCastAway : Sound {
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    auto z = Sound::at(u, xi2);
    if constexpr (std::is_same_v<X, double>)
      return z;
    else
      z.A(0, 0) = X(z.A(0, 0).a);
    return z;
  }
};

struct NotFiniteBelowZero : Sound {
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::sqrt;
    auto z = Sound::at(u, xi2);
    z.b[0] += sqrt(u[0]);
    return z;
  }
};

/// z = s log(b) u, without bounds: finite for b > 0 alone.
struct Logarithm {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"b", "1"}};
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::log;
    sepcal::Affine<X, 1, 1> z;
    z.A << log(xi2[0]) * u[0];
    z.b << X(0.0);
    return z;
  }
};

Record make_record(double lowest = 0.1) {
  sepcal::test::Draws draws(51);
  Record record;
  record.add("u", draws.uniform_column(20, lowest, 3)).add("z", draws.uniform_column(20, -1, 1));
  record.add("y", draws.uniform_column(20, -1, 1));
  return record;
}

}  // namespace

TEST_CASE("a sound model passes, and so do the four that the library ships") {
  CHECK_NOTHROW(check_model(Sound{}, make_record()));
  for (const auto& simulated : sepcal::test::simulate_all(30)) {
    CAPTURE(simulated.name);
    CHECK_NOTHROW(check_model(*simulated.model, simulated.record));
  }
}

TEST_CASE("an entry that is never set is named by output and parameter") {
  CHECK_THROWS_WITH_AS(check_model(EntryNeverSet{}, make_record()),
                       Contains("A(1, 1) (output 'y', parameter 'c')"), Error);
  CHECK_THROWS_WITH_AS(check_model(OffsetNeverSet{}, make_record()), Contains("b[1] (output 'y')"),
                       Error);
}

TEST_CASE("a model that answers the same question in two ways is named") {
  CHECK_THROWS_WITH_AS(check_model(Whimsical{}, make_record()),
                       Contains("A(0, 1) (output 'z', parameter 'c') differs"), Error);
}

TEST_CASE("a derivative that was cast away is named by output and parameter") {
  CHECK_THROWS_WITH_AS(check_model(DerivativeCastAway{}, make_record()),
                       Contains("derivative of output 'z' with respect to 'b'"), Error);
}

TEST_CASE("a model that is not finite at some samples only passes") {
  CHECK_NOTHROW(check_model(NotFiniteBelowZero{}, make_record(-1.0)));
}

TEST_CASE("a parameter of small natural size is no reason to doubt its derivative") {
  sepcal::test::Draws draws(52);
  Record record;
  record.add("u", draws.uniform_column(20, 5e4, 1e5)).add("z", draws.uniform_column(20, -1, 1));
  CHECK_NOTHROW(check_model(sepcal::test::SmallParameter{}, record));
}

TEST_CASE("an unbounded parameter is tried at its start, however small that is") {
  CHECK_THROWS_WITH_AS(check_model(Logarithm{}, make_record()), Contains("set every entry"), Error);
  for (const double start : {1e-9, 1e-3, 2.0, 1e6}) {
    CAPTURE(start);
    CHECK_NOTHROW(check_model(Logarithm{}, make_record(), {{"b", start}}));
  }
  CHECK_THROWS_WITH_AS(check_model(Logarithm{}, make_record(), {{"b", -1.0}}),
                       Contains("or start elsewhere"), Error);
}

TEST_CASE("a record without rows, or without a column, is an error") {
  Record record;
  record.add("u", {}).add("z", {}).add("y", {});
  CHECK_THROWS_WITH_AS(check_model(Sound{}, record), Contains("no rows"), Error);
  Record narrow;
  narrow.add("u", {1, 2}).add("z", {1, 2});
  CHECK_THROWS_WITH_AS(check_model(Sound{}, narrow), Contains("column 'y' is missing"), Error);
}

}  // namespace check_model_test
