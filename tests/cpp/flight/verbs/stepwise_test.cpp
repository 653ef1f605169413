// SPDX-License-Identifier: BSD-3-Clause
// Why a stepwise diagnosis goes on or ends: its loop with verbs that say what they are told to.
#include "sepcal/flight/stepwise.hpp"

#include <doctest/doctest.h>

#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/error.hpp"

namespace stepwise_test {

using namespace sepcal;
using namespace sepcal::verbs;
using doctest::Contains;

namespace {

/// A fit whose error is all there is to it.
struct Fitted {
  Fit fit = {};
};

Fitted with_error(double vn, FitStatus status = FitStatus::converged) {
  Fitted fitted;
  fitted.fit.status = status;
  fitted.fit.message = "why";
  fitted.fit.rmse = {{"vn", vn}, {"ve", 3.0}};
  return fitted;
}

FlightDiagnosis told(Verdict verdict, const std::string& advised = "",
                     const std::string& withheld = "") {
  FlightDiagnosis result;
  result.diagnosis.verdict = verdict;
  result.diagnosis.unit = "m/s";
  result.diagnosis.advice.effect = advised;
  if (!withheld.empty()) result.diagnosis.advice.withheld = {withheld};
  if (!advised.empty()) {
    EffectFinding finding;
    finding.name = advised;
    finding.outputs = {"vn"};
    finding.predicted_drop = 0.4;
    result.diagnosis.effects.push_back(finding);
  }
  return result;
}

/// Each diagnosis of everything says what is next in the list, each of one effect whether that is
/// still found.
struct Verbs {
  std::vector<FlightDiagnosis> diagnoses;
  std::vector<Fitted> fits;
  std::vector<std::string> fading = {};
  std::vector<std::string> added = {};
  std::size_t asked = 0;

  Stepwise run(Fitted& from, std::size_t most = 9) {
    const StepwiseLoop<Fitted> loop{
        from, most,
        [&](const Fitted&, const std::string& only, std::size_t) {
          if (only.empty()) return diagnoses.at(asked++);
          const bool fades = std::ranges::find(fading, only) != fading.end();
          return fades ? told(Verdict::adequate) : told(Verdict::effect_missing, only);
        },
        [&](const Fitted&, const std::string& effect) {
          added.push_back(effect);
          if (added.size() > fits.size()) throw Error("no such channel");
          return fits[added.size() - 1];
        }};
    return loop.run(from);
  }
};

}  // namespace

TEST_CASE("steps are taken until nothing passes") {
  Verbs verbs{{told(Verdict::effect_missing, "E"), told(Verdict::effect_missing, "F"),
               told(Verdict::adequate)},
              {with_error(0.6), with_error(0.3), with_error(0.5)}};
  Fitted fitted = with_error(1.0);
  const Stepwise course = verbs.run(fitted);
  CHECK(verbs.added == std::vector<std::string>{"E", "F", "F"});  // the last to ask for E
  REQUIRE(course.steps.size() == 2);
  CHECK(course.steps[0].promised.name == "E");
  CHECK(course.steps[0].rmse_before == 1.0);  // of vn alone
  CHECK(course.steps[0].rmse_after == 0.6);
  CHECK(course.steps[0].found_drop() == doctest::Approx(0.4));
  CHECK(course.steps[1].rmse_before == 0.6);
  CHECK(course.end == StepwiseEnd::nothing_found);
  CHECK(course.last.diagnosis.verdict == Verdict::adequate);
  CHECK(fitted.fit.rmse.front().value == 0.3);
}

TEST_CASE("what was added is dropped where a later step takes its place") {
  Verbs verbs{{told(Verdict::effect_missing, "E"), told(Verdict::effect_missing, "F"),
               told(Verdict::adequate)},
              {with_error(0.6), with_error(0.3), with_error(0.31)},
              {"E"}};
  Fitted fitted = with_error(1.0);
  Stepwise course = verbs.run(fitted);
  REQUIRE(course.steps.size() == 2);
  CHECK(course.steps[1].dropped == std::vector<std::string>{"E"});
  CHECK(list_kept(course) == std::vector<std::string>{"F"});
  CHECK(fitted.fit.rmse.front().value == 0.31);  // of the fit without E
  CHECK(course.end == StepwiseEnd::nothing_found);
  CHECK(to_text(course).find("- E: beside F it counts no more, and is dropped") !=
        std::string::npos);
  CHECK(to_text(course).find("1 effect added") != std::string::npos);

  // It does not come back for ever.
  Verbs circle{{told(Verdict::effect_missing, "E"), told(Verdict::effect_missing, "F"),
                told(Verdict::effect_missing, "E")},
               {with_error(0.6), with_error(0.3), with_error(0.31)},
               {"E"}};
  fitted = with_error(1.0);
  course = circle.run(fitted);
  CHECK(course.end == StepwiseEnd::withheld);
  CHECK(course.reason == "E would come back, which F took the place of");
}

TEST_CASE("it ends with the reason") {
  Fitted fitted = with_error(1.0);
  SUBCASE("where as many are added as were asked for, and names the next") {
    Verbs verbs{{told(Verdict::effect_missing, "E"), told(Verdict::effect_missing, "F")},
                {with_error(0.6)}};
    const Stepwise course = verbs.run(fitted, 1);
    CHECK(course.end == StepwiseEnd::most_added);
    CHECK(course.reason.find("F would be next") != std::string::npos);
    CHECK(course.steps.size() == 1);
  }
  SUBCASE("where what passes is not to be added") {
    Verbs verbs{{told(Verdict::effect_missing, "", "E: it runs away")}, {}};
    const Stepwise course = verbs.run(fitted);
    CHECK(course.end == StepwiseEnd::withheld);
    CHECK(course.reason.find("E: it runs away") != std::string::npos);
  }
  SUBCASE("where something is left that can't be told") {
    for (const Verdict verdict : {Verdict::slow_change, Verdict::unexplained}) {
      Verbs verbs{{told(verdict)}, {}};
      const Stepwise course = verbs.run(fitted);
      CHECK(course.end == StepwiseEnd::nothing_found);
      CHECK(course.reason.size() > std::string("nothing more passes").size());
    }
  }
}

TEST_CASE("a fit that fails is no step") {
  Fitted fitted = with_error(1.0);
  Verbs verbs{{told(Verdict::effect_missing, "E")}, {}};
  std::string why;
  SUBCASE("as it can't be made") { why = "E can't be added: no such channel"; }
  SUBCASE("as it does not converge") {
    verbs.fits = {with_error(0.5, FitStatus::not_converged)};
    why = "the fit with E is not converged: why";
  }
  SUBCASE("as it is not identifiable") {
    verbs.fits = {with_error(0.5, FitStatus::not_identifiable)};
    why = "the fit with E is not identifiable: why";
  }
  SUBCASE("as the error does not fall") {
    verbs.fits = {with_error(1.0)};
    why = "the error did not fall (1 -> 1)";
  }
  const Stepwise course = verbs.run(fitted);
  CHECK(course.end == StepwiseEnd::fit_failed);
  CHECK(course.reason.find(why) != std::string::npos);
  CHECK(course.steps.empty());
  CHECK(fitted.fit.rmse.front().value == 1.0);
}

TEST_CASE("a fit that was no better before may go on") {
  Fitted fitted = with_error(1.0, FitStatus::not_identifiable);
  Verbs verbs{{told(Verdict::effect_missing, "E"), told(Verdict::adequate)},
              {with_error(0.5, FitStatus::not_identifiable)}};
  CHECK(verbs.run(fitted).steps.size() == 1);
}

TEST_CASE("to add nothing at all is refused") {
  CHECK_NOTHROW(check_most({.most = 1}));
  CHECK_THROWS_WITH_AS(check_most({.most = 0}), Contains("most 0"), OptionError);
}

}  // namespace stepwise_test
