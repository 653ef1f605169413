// SPDX-License-Identifier: BSD-3-Clause
// Costs that are no parabola within three standard errors, in closed form.
#include "estimation/curvature.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "sepcal/fit.hpp"
#include "sepcal/static_model.hpp"

namespace curvature_test {

namespace {

/// z = u (x + k x^2). With z = 0, noise 1 and u of unit length the cost is (x + k x^2)^2: at -3 and
/// 3, three standard errors from the minimum, (1 - 3 k)^2 and (1 + 3 k)^2 of the parabola's.
struct Bent {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> linear{};
  static constexpr std::array nonlinear{sepcal::Quantity{"x", "1", -5.0, 5.0}};

  double k;

  template <class U, class X>
  sepcal::Affine<X, 1, 0> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    sepcal::Affine<X, 1, 0> z;
    z.b[0] = u[0] * (xi2[0] + k * xi2[0] * xi2[0]);
    return z;
  }
};

std::string message(double k, sepcal::FitOptions options = {}) {
  sepcal::Record record;
  record.add("u", std::vector<double>(100, 0.1));
  std::vector<double> z(100, 1.0);  // its mean is zero: u explains none of it
  for (std::size_t row = 0; row < z.size(); row += 2) z[row] = -1.0;
  record.add("z", std::move(z));
  options.noise = {{"z", 1.0}};
  const sepcal::Fit fit = sepcal::fit(Bent{k}, record, options);
  CHECK(std::abs(fit["x"].value) < 1e-6);
  CHECK(fit["x"].standard_error_white == doctest::Approx(1.0).epsilon(1e-6));
  return fit.message;
}

}  // namespace

/// Whether the message speaks of the bend; of the residual's noise it may.
bool is_said(const std::string& message) { return message.find("don't hold") != message.npos; }

TEST_CASE("a cost within a factor of two of the parabola's is not spoken of") {
  CHECK(!is_said(message(0.0)));
  CHECK(!is_said(message(0.09)));  // 0.53 and 1.61
}

TEST_CASE("one that rises by less than half of it on one side is") {
  CHECK(message(0.1).starts_with("the standard errors of x don't hold: "));  // 0.49 and 1.69
}

TEST_CASE("nothing is said across a bound, and where nobody asks for standard errors") {
  sepcal::FitOptions options;
  options.bounds["x"] = {-2.0, 2.0};
  CHECK(!is_said(message(0.1, options)));
  options = {};
  options.coloured_errors = false;
  CHECK(!is_said(message(0.1, options)));
}

}  // namespace curvature_test
