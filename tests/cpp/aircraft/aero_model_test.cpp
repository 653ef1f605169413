// SPDX-License-Identifier: BSD-3-Clause
// Equation error: coefficients made of regressors by hand are found again; names, units, refusals.
#include "sepcal/aircraft/aero_model.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "draws.hpp"
#include "sepcal/error.hpp"

namespace aero_model_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::AeroCoefficients;
using sepcal::AeroEquation;
using sepcal::AeroFit;
using sepcal::Error;
using sepcal::Record;
using sepcal::Regressor;

namespace {

/// Cm = -0.02 - 0.9 alpha - 12 q_hat - 1.3 elevator + 2 alpha^2 - 0.5 alpha |beta| + noise.
AeroCoefficients make(double noise) {
  sepcal::test::Draws draws(3);
  std::map<std::string, std::vector<double>> columns;
  for (const char* name : {"alpha", "beta", "q_hat", "elevator"}) {
    columns[name] = draws.uniform_column(2000, -0.1, 0.2);
  }
  for (std::size_t k = 0; k < 2000; ++k) {
    const double a = columns["alpha"][k];
    columns["time"].push_back(0.02 * static_cast<double>(k));
    columns["Cm"].push_back(-0.02 - 0.9 * a - 12 * columns["q_hat"][k] -
                            1.3 * columns["elevator"][k] + 2 * a * a -
                            0.5 * a * std::abs(columns["beta"][k]) + noise * draws.normal());
  }
  AeroCoefficients made;
  for (const auto& [name, values] : columns) made.record.add(name, values);
  made.names = {"Cm"};
  made.notes = {"q_hat is q c/2V"};
  return made;
}

const std::map<std::string, double> truth{{"Cm_0", -0.02},     {"Cm_alpha", -0.9},
                                          {"Cm_q", -12},       {"Cm_elevator", -1.3},
                                          {"Cm_alpha^2", 2.0}, {"Cm_alpha*abs(beta)", -0.5}};

const std::vector<AeroEquation> equations{
    {"Cm", {"1", "alpha", "q_hat", "elevator", "alpha^2", "alpha*abs(beta)"}}};

void refuse(std::vector<AeroEquation> wrong, const char* message) {
  CHECK_THROWS_WITH_AS(sepcal::fit_equation_error(make(0.0), wrong), Contains(message), Error);
}

}  // namespace

TEST_CASE("without noise the parameters come back to rounding") {
  const AeroFit found = sepcal::fit_equation_error(make(0.0), equations);
  for (const auto& [name, value] : truth) {
    CHECK(found.fit[name].value == Approx(value).epsilon(1e-9));
  }
}

TEST_CASE("with noise, within four standard errors, of which fit() makes all that it makes") {
  const AeroFit found = sepcal::fit_equation_error(make(0.01), equations);
  CHECK(found.fit.status == sepcal::FitStatus::converged);
  for (const auto& [name, value] : truth) {
    const sepcal::Parameter& p = found.fit[name];
    INFO(name << " " << p.value << " +- " << p.standard_error);
    CHECK(std::abs(p.value - value) < 4 * p.standard_error);
  }
  CHECK(found.fit.noise.front().value == Approx(0.01).epsilon(0.1));
  CHECK(found.notes.front() == "q_hat is q c/2V");
  CHECK(found.warning.find("are not in these intervals") != std::string::npos);
  CHECK(found.fit["Cm_alpha^2"].unit == "1/rad^2");
  CHECK(found.fit["Cm_q"].unit == "1");
}

TEST_CASE("the standard equations are S 6.8 to 6.13 without what was misprinted") {
  const auto all = sepcal::standard_equations();
  CHECK(all.size() == 6);
  CHECK(all[1].regressors ==  // 6.9 prints CX_da, CX_dr
        std::vector<std::string>{"1", "beta", "p_hat", "r_hat", "aileron", "rudder"});
  CHECK(all[3].regressors == all[1].regressors);  // 6.11 prints Cl_alpha
  CHECK(sepcal::standard_equations({"Cm"}).front().regressors ==
        std::vector<std::string>{"1", "alpha", "q_hat", "elevator"});
  CHECK(sepcal::parameter_name("Cl", "p_hat") == "Cl_p");
  CHECK(sepcal::parameter_name("CZ", "1") == "CZ_0");
  CHECK(sepcal::parameter_unit(Regressor("throttle*alpha")) == "1/rad/throttle");
}

TEST_CASE("what is no equation is refused") {
  for (const char* text : {"alpha^0", "alpha+beta", "2*alpha", "", "alpha*", "sin(alpha)", "a^b"}) {
    CHECK_THROWS_WITH_AS(Regressor(std::string(text)), Contains("can't be read; write 1, x, x^2"),
                         Error);
  }
  refuse(
      {{"Cm", {"1", "mach"}}},
      "Cm has the regressor 'mach', which is no column with a number in every row; add or mend it");
  refuse({{"CZ", {"1"}}}, "CZ wasn't computed; the coefficients are Cm");
  refuse({{"Cm", {}}}, "Cm has no regressors");
  refuse({{"Cm", {"1", "alpha", "1"}}}, "the regressor '1' of Cm stands twice");
  refuse({{"Cm", {"1"}}, {"Cm", {"alpha"}}}, "Cm has two equations");
}

}  // namespace aero_model_test
