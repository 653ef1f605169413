// SPDX-License-Identifier: BSD-3-Clause
// The order in which stage two tries, and which end it keeps.
#include "estimation/stage_two.hpp"

#include <doctest/doctest.h>

namespace stage_two_test {

using sepcal::FitOptions;
using sepcal::SecondStage;
using sepcal::StageOne;
using sepcal::estimation::agree;
using sepcal::estimation::Attempt;
using sepcal::estimation::Ending;
using sepcal::estimation::is_better;
using sepcal::estimation::is_enough;
using sepcal::estimation::list_attempts;

namespace {

StageOne ended(bool unique, int n_1 = 2) {
  StageOne start;
  start.unique_minimum = unique;
  start.xi1 = Eigen::VectorXd::Zero(n_1);
  return start;
}

std::vector<SecondStage> methods(const std::vector<Attempt>& attempts) {
  std::vector<SecondStage> result;
  for (const Attempt& attempt : attempts) result.push_back(attempt.method);
  return result;
}

constexpr auto joint = SecondStage::joint;
constexpr auto projected = SecondStage::projected;

}  // namespace

TEST_CASE("behind samples Step 5 chooses, and joint follows projected of its own choice alone") {
  FitOptions options;
  CHECK(methods(list_attempts(options, ended(true))) == std::vector{projected, joint});
  CHECK(methods(list_attempts(options, ended(false))) == std::vector{joint});
  for (const SecondStage asked : {joint, projected}) {
    options.second_stage = asked;
    CHECK(methods(list_attempts(options, ended(true))) == std::vector{asked});
    CHECK(list_attempts(options, ended(true)).front().hold);
  }
}

TEST_CASE("from a given start auto begins projected without a prior, and joint follows with one") {
  FitOptions options;
  options.start = {{"b", 1.0}};
  const auto attempts = list_attempts(options, ended(false));
  REQUIRE(attempts.size() == 4);
  CHECK(methods(attempts) == std::vector{projected, joint, projected, projected});
  CHECK_FALSE(attempts[0].hold);
  CHECK(attempts[1].hold);
  CHECK(attempts[0].first_radius > attempts[2].first_radius);
  CHECK(attempts[2].first_radius > attempts[3].first_radius);
}

TEST_CASE("a method that was asked for is kept, and a model without a linear part is joint") {
  FitOptions options;
  options.start = {{"b", 1.0}};
  CHECK(list_attempts(options, ended(false, 0)).front().method == joint);
  options.second_stage = projected;
  for (const Attempt& attempt : list_attempts(options, ended(false))) {
    CHECK(attempt.method == projected);
  }
}

TEST_CASE("an end is enough where it converged, from a given start to what the record determines") {
  const Ending determined{.converged = true};
  const Ending open{.converged = true, .open = true};
  CHECK(is_enough(determined, true));
  CHECK(is_enough(open, false));
  CHECK_FALSE(is_enough(open, true));
  CHECK_FALSE(is_enough({.converged = false}, false));
}

TEST_CASE("converged goes before determined, determined before held, held before the lower cost") {
  const std::vector<Ending> ranked{
      {.converged = true, .open = false, .held = false, .cost = 1.0},
      {.converged = true, .open = false, .held = false, .cost = 2.0},
      {.converged = true, .open = true, .held = true, .cost = 9.0},
      {.converged = true, .open = true, .held = false, .cost = 0.0},
      {.converged = false, .open = false, .held = false, .cost = -1.0},
      {.converged = false, .open = true, .held = true, .cost = -1.0},
      {.converged = false, .open = true, .held = false, .cost = -9.0},
  };
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    for (std::size_t k = 0; k < ranked.size(); ++k) {
      CAPTURE(i);
      CAPTURE(k);
      CHECK(is_better(ranked[i], ranked[k]) == (i < k));
    }
  }
}

TEST_CASE("two ends agree where both converged to within one standard error of cost") {
  const Ending one{.converged = true, .cost = 10.0};
  CHECK(agree(one, {.converged = true, .cost = 10.4}));
  CHECK_FALSE(agree(one, {.converged = true, .cost = 10.6}));
  CHECK_FALSE(agree(one, {.converged = false, .cost = 10.0}));
}

}  // namespace stage_two_test
