// SPDX-License-Identifier: BSD-3-Clause
// The whole recipe on the straight line z = s u + c, with plain channels as candidates.
#include "sepcal/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrated_flights.hpp"
#include "noises.hpp"
#include "small_models.hpp"

namespace diagnosis_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;
using Eigen::VectorXd;
using Texts = std::vector<std::string>;

namespace {

constexpr Eigen::Index rows = 600;
const auto line = block_model(Line{});

std::vector<double> as_column(const VectorXd& values) { return {values.begin(), values.end()}; }

/// Six segments of a hundred rows; z is the line, noise and `more`.
struct Bench {
  Draws draws{4};
  Record record;
  std::vector<Segment> segments = make_segments({100, 100, 100, 100, 100, 100});

  Bench() {
    for (std::size_t i = 0; i < segments.size(); ++i)
      segments[i].label = std::string(1, char('a' + i));
    record.add("time", as_column(VectorXd::LinSpaced(rows, 0.0, 59.9)));
    record.add("u", draws.uniform_column(rows, -2.0, 2.0));
  }

  VectorXd add(const std::string& channel, const VectorXd& values) {
    record.add(channel, as_column(values));
    return values;
  }

  VectorXd add_white(const std::string& channel) {
    return add(channel, draw_noise("white", rows, draws));
  }

  Diagnosis diagnose(const VectorXd& more, const Texts& candidates,
                     const DiagnosisOptions& options = {.simulations = 99, .threads = 1}) {
    VectorXd z = more + draw_noise("white", rows, draws);
    const auto u = record.column("u");
    for (Eigen::Index i = 0; i < rows; ++i) z[i] += 1.3 * u[static_cast<std::size_t>(i)] - 0.4;
    record.add("z", as_column(z));
    record.cut(segments);
    const DiagnosedFit fitted{.model = line,
                              .kit = plain_kit(line->tables()),
                              .effects = {},
                              .record = record,
                              .rows = segments,
                              .fit = fit(*line, record)};
    return sepcal::diagnose(fitted, candidates, options);
  }
};

Texts names_of(const Diagnosis& diagnosis) {
  Texts names;
  for (const EffectFinding& effect : diagnosis.effects) names.push_back(effect.name);
  return names;
}

}  // namespace

TEST_CASE("the channel at work is found among others; what can't be made is left out") {
  Bench bench;
  const VectorXd heat = bench.add_white("heat");
  bench.add_white("decoy");
  bench.add("still", VectorXd::Ones(rows));
  const Diagnosis diagnosis = bench.diagnose(
      0.4 * heat, {"c[decoy]", "c[heat]", "s[heat]", "c[still]", "c[absent]", "c[ heat ]"});
  CHECK(diagnosis.verdict == Verdict::effect_missing);
  Texts names = names_of(diagnosis);
  CHECK(names.front() == "c[heat]");
  std::ranges::sort(names);
  CHECK(names == Texts{"c[decoy]", "c[heat]", "s[heat]"});

  const EffectFinding& heated = diagnosis.effects.front();
  CHECK(heated.status == FindingStatus::found);
  CHECK(heated.drivers == Texts{"heat"});
  CHECK(list_beside(diagnosis, Beside::equivalent).empty());
  CHECK(diagnosis.pairs.empty());
  CHECK(heated.visibility > 0.95);
  CHECK(heated.coefficients[0].standard_error == Approx(1.0 / std::sqrt(600.0)).epsilon(0.15));
  CHECK(std::abs(heated.coefficients[0].estimate - 0.4) < 4.0 / std::sqrt(600.0));
  CHECK(diagnosis.effects[1].status == FindingStatus::not_seen);
}

TEST_CASE("two channels that are nearly one: equivalent while small, the proxy fades when large") {
  for (const auto& [size, beside] : {std::pair{0.4, Beside::equivalent}, {8.0, Beside::fades}}) {
    CAPTURE(size);
    Bench bench;
    const VectorXd current = bench.add_white("current");
    bench.add("voltage", -0.3 * current + 0.03 * draw_noise("white", rows, bench.draws));
    bench.add_white("decoy");
    const Diagnosis diagnosis =
        bench.diagnose(size * current, {"c[voltage]", "c[current]", "c[decoy]"});
    const EffectFinding& first = diagnosis.effects[0];
    const EffectFinding& second = diagnosis.effects[1];
    CHECK(first.status == FindingStatus::found);
    if (beside == Beside::fades) CHECK(first.name == "c[current]");
    CHECK(first.beside == Beside::untried);
    CHECK(second.name == (first.name == "c[current]" ? "c[voltage]" : "c[current]"));
    CHECK(second.beside == beside);
    CHECK(diagnosis.effects[2].beside == Beside::untried);
    CHECK(diagnosis.pairs.empty());
  }
}

TEST_CASE("a second cause counts beside the first, and the two are the best pair") {
  Bench bench;
  const VectorXd heat = bench.add_white("heat");
  const VectorXd load = bench.add_white("load");
  bench.add_white("decoy");
  const Diagnosis diagnosis =
      bench.diagnose(0.8 * heat - 0.6 * load, {"c[decoy]", "c[load]", "c[heat]"});
  CHECK(diagnosis.effects[0].name == "c[heat]");
  CHECK(list_beside(diagnosis, Beside::counts) == Texts{"c[load]"});
  CHECK(diagnosis.pairs == Texts{"c[heat]+c[load]"});
}

// Neither channel alone is as near as their sum, which a third one shows.
TEST_CASE("two causes behind a channel that goes with both: the pairs that may be hold the truth") {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Bench bench;
    bench.draws = Draws(seed);
    const VectorXd heat = bench.add_white("heat");
    const VectorXd load = bench.add_white("load");
    bench.add("voltage", heat + load + 0.5 * draw_noise("white", rows, bench.draws));
    bench.add_white("decoy");
    const Diagnosis diagnosis =
        bench.diagnose(0.3 * (heat + load), {"c[voltage]", "c[heat]", "c[load]", "c[decoy]"});
    REQUIRE(diagnosis.verdict == Verdict::effect_missing);
    const bool holds = std::ranges::any_of(diagnosis.pairs, [](const std::string& pair) {
      return pair == "c[heat]+c[load]" || pair == "c[load]+c[heat]";
    });
    held += holds ? 1 : 0;
  }
  CHECK(held >= 9);
}

TEST_CASE("of a straight line and a spline the line comes first, until the spline explains more") {
  for (const bool straight : {true, false}) {
    CAPTURE(straight);
    Bench bench;
    const VectorXd height = bench.add("height", VectorXd::LinSpaced(rows, -1.0, 1.0));
    const VectorXd wind = straight ? VectorXd(4.0 * height) : VectorXd(4.0 * height.array().cube());
    const Diagnosis diagnosis = bench.diagnose(wind, {"c[spline(height,6)]", "c[height]"},
                                               {.error_budget = {{"z", 0.0}}, .threads = 1});
    CHECK(diagnosis.effects.front().name == (straight ? "c[height]" : "c[spline(height,6)]"));
    CHECK(diagnosis.effects.front().status == FindingStatus::found);
  }
}

TEST_CASE("two effects that only show together are found as a pair") {
  Bench bench;
  const VectorXd common = draw_noise("white", rows, bench.draws);
  const VectorXd first = bench.add("first", common + 0.1 * draw_noise("white", rows, bench.draws));
  const VectorXd second =
      bench.add("second", common + 0.1 * draw_noise("white", rows, bench.draws));
  bench.add_white("decoy");
  const Diagnosis diagnosis =
      bench.diagnose(4.0 * (first - second), {"c[first]", "c[decoy]", "c[second]"});
  CHECK(diagnosis.verdict == Verdict::effect_missing);
  const EffectFinding& pair = diagnosis.effects.front();
  CHECK((pair.name == "c[first]+c[second]" || pair.name == "c[second]+c[first]"));
  CHECK(pair.status == FindingStatus::found);
  CHECK(pair.coefficients.size() == 2);
  for (std::size_t i = 1; i < diagnosis.effects.size(); ++i) {
    if (diagnosis.effects[i].name.find('+') != std::string::npos) continue;
    CHECK(diagnosis.effects[i].status == FindingStatus::not_seen);
  }
}

TEST_CASE("offsets from segment to segment that no candidate follows are called unexplained") {
  Bench bench;
  bench.add_white("decoy");
  VectorXd offsets(rows);
  const std::vector<double> sizes{1.5, -1.2, 0.9, -1.6, 1.3, -0.9};
  for (Eigen::Index i = 0; i < 6; ++i) {
    offsets.segment(100 * i, 100).setConstant(sizes[static_cast<std::size_t>(i)]);
  }
  const Diagnosis diagnosis = bench.diagnose(offsets, {"c[decoy]"});
  CHECK(diagnosis.verdict == Verdict::unexplained);
  CHECK(diagnosis.omnibus.p_value < 0.01);
  CHECK(diagnosis.omnibus.significant);
  CHECK(diagnosis.effects.front().status == FindingStatus::not_seen);
  REQUIRE(diagnosis.omnibus.windows.size() == 6);
}

TEST_CASE("a swing that no channel follows is a line, with its frequency") {
  Bench bench;
  bench.add_white("decoy");
  const VectorXd time = VectorXd::LinSpaced(rows, 0.0, 59.9);
  const VectorXd wave = 0.6 * (2.0 * std::numbers::pi * 1.3 * time.array()).sin();
  const Diagnosis diagnosis = bench.diagnose(wave, {"c[decoy]"});
  CHECK(diagnosis.verdict == Verdict::unexplained);
  CHECK(!diagnosis.omnibus.significant);
  REQUIRE(diagnosis.unmeasured.size() == 1);
  const UnmeasuredCause& cause = diagnosis.unmeasured.front();
  CHECK(cause.kind == UnmeasuredKind::spectral_line);
  CHECK(cause.outputs == Texts{"z"});
  CHECK(cause.frequency == Approx(1.3).epsilon(0.01));
  CHECK(cause.all_along);
  CHECK(cause.p_adjusted < 0.01);
}

TEST_CASE("pink noise alone, with slow channels about: adequate, and the limit says how blind") {
  const auto limit_of = [](const Diagnosis& of) {
    return std::ranges::find(of.limits, "c", &DetectionLimit::port)->size;
  };
  Bench quiet;
  quiet.add_white("decoy");
  const Diagnosis white = quiet.diagnose(VectorXd::Zero(rows), {"c[decoy]"});
  CHECK(white.verdict == Verdict::adequate);
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    Bench bench;
    bench.draws = Draws(seed);
    bench.add("altitude", draw_noise("random walk", rows, bench.draws));
    bench.add("heat", draw_noise("pink", rows, bench.draws));
    const VectorXd pink = draw_noise("pink", rows, bench.draws);
    const Diagnosis diagnosis =
        bench.diagnose(pink, {"c[altitude]", "c[heat]", "c[time]", "s[time]"});
    alarms += diagnosis.verdict == Verdict::adequate ? 0 : 1;
    CHECK(diagnosis.residual.at(0).ljung_box_p < 1e-6);  // coloured, which is no effect
    CHECK(diagnosis.floor < 0.9 * diagnosis.rmse);
    CHECK(limit_of(diagnosis) > 2.0 * limit_of(white));
  }
  CHECK(alarms <= 2);
}

TEST_CASE("a straight line in time of the limit's size is found about nine times in ten") {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bench bench;
    bench.draws = Draws(seed);
    const double size = 0.6;  // what find_limits() says of white noise of 1 in 600 rows is near it
    const VectorXd ramp = VectorXd::LinSpaced(rows, -0.5 * size, 0.5 * size);
    const Diagnosis diagnosis = bench.diagnose(
        ramp, {"c[time]"}, {.simulations = 39, .error_budget = {{"z", 0.0}}, .threads = 1});
    const double limit = std::ranges::find(diagnosis.limits, "c", &DetectionLimit::port)->size;
    CHECK(limit > 0.3);
    CHECK(limit < 1.2);
    found += diagnosis.verdict == Verdict::effect_missing ? 1 : 0;
  }
  CHECK(found >= 10);
}

TEST_CASE("verdicts and statuses by their names") {
  CHECK(to_string(Verdict::adequate) == "adequate");
  CHECK(to_string(Verdict::effect_missing) == "effect_missing");
  CHECK(to_string(Verdict::unexplained) == "unexplained");
  CHECK(to_string(FindingStatus::found) == "found");
  CHECK(to_string(FindingStatus::not_seen) == "not_seen");
  CHECK(to_string(FindingStatus::cannot_be_seen) == "cannot_be_seen");
}

}  // namespace diagnosis_test
