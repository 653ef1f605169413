// SPDX-License-Identifier: BSD-3-Clause
// Scales as fits leave them: sound, far off, and held by nothing but a bound.
#include "flight/probes/plausible_scales.hpp"

#include <doctest/doctest.h>

#include <array>

#include "sepcal/detail/models/scale.hpp"

namespace plausible_scales_test {

using sepcal::Fit;
using sepcal::FitStatus;
using sepcal::probes::judge_scales;
using sepcal::probes::Scale;

namespace {

constexpr std::array magnetometer{Scale{"lambda_x", 0.0}, Scale{"lambda_y", 0.0}};
constexpr std::array tube{Scale{"s_va", 1.0}};

Fit fitted(double lambda_x, double lambda_y) {
  Fit fit;
  fit.status = FitStatus::converged;
  fit.parameters = {{.name = "lambda_x", .unit = "1", .value = lambda_x},
                    {.name = "lambda_y", .unit = "1", .value = lambda_y}};
  return fit;
}

}  // namespace

TEST_CASE("a sound scale is not spoken of") {
  Fit fit = fitted(0.19, -0.19);
  judge_scales(fit, magnetometer);
  CHECK(fit.message.empty());
  CHECK(fit.status == FitStatus::converged);
}

TEST_CASE("one that is far off is named with its value, what it mostly means beside it") {
  Fit fit = fitted(0.0, -0.62);
  fit.message = "something";
  judge_scales(fit, magnetometer);
  CHECK(fit.message.starts_with("something; lambda_y -0.62 looks like"));
  CHECK(fit.message.find("unit or sign") != std::string::npos);
  CHECK(fit.message.find("lambda_x") == std::string::npos);
  CHECK(fit.status == FitStatus::converged);

  Fit knots;  // m/s under a header in knots
  knots.parameters = {{.name = "s_va", .unit = "1", .value = 1852.0 / 3600.0}};
  judge_scales(knots, tube);
  CHECK(knots.message.starts_with("s_va 0.514 looks like"));
}

TEST_CASE("one that only its bound held, or that is turned over, is not identifiable") {
  for (const double lambda : {sepcal::scale_error("lambda_x").lower, -1.97}) {
    Fit fit = fitted(lambda, 0.0);
    judge_scales(fit, magnetometer);
    CHECK(fit.status == FitStatus::not_identifiable);
    CHECK(fit.message.starts_with("lambda_x came out at 0.05 of what a sensor has, or below"));
    REQUIRE(fit.identifiability.unobservable.size() == 1);
    CHECK(fit.identifiability.unobservable[0].text == "lambda_x");
  }
  Fit failed = fitted(-1.97, 0.0);
  failed.status = FitStatus::not_converged;
  judge_scales(failed, magnetometer);
  CHECK(failed.status == FitStatus::not_converged);
}

TEST_CASE("what was fixed is not judged") {
  Fit fit = fitted(-3.0, 0.5);
  fit.parameters[0].fixed = fit.parameters[1].fixed = true;
  judge_scales(fit, magnetometer);
  CHECK(fit.message.empty());
}

}  // namespace plausible_scales_test
