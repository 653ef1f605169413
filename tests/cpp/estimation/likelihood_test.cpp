// SPDX-License-Identifier: BSD-3-Clause
// The steps of stage two for a straight line, where every one is known in closed form.
#include "estimation/likelihood.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "estimation/alternation.hpp"
#include "sepcal/record.hpp"
#include "sepcal/static_model.hpp"
#include "small_models.hpp"

namespace likelihood_test {

using doctest::Approx;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::SecondStage;
using sepcal::StageOne;
using sepcal::estimation::Likelihood;
using sepcal::estimation::StageTwo;

namespace {

constexpr double first_radius = 1e4;

/// z = s u + c at u = -1, 0, 1, 2 with z = 0, 1, 2, 7: s = 2.2, c = 1.4, SSE = 4.8; R-hat =
/// 4.8 / 4.
class Straight {
 public:
  explicit Straight(const FitOptions& options = {})
      : model_(sepcal::block_model(sepcal::test::Line{})), problem_(*model_, options), pool_(1) {
    record_.add("u", {-1.0, 0.0, 1.0, 2.0}).add("z", {0.0, 1.0, 2.0, 7.0});
    measurements_ = std::make_unique<sepcal::model::Measurements>(*model_, record_);
    sweep_ = std::make_unique<sepcal::model::Sweep>(*model_, *measurements_, pool_);
    likelihood = std::make_unique<Likelihood>(problem_, *sweep_);
  }

  StageTwo begin(double noise, SecondStage method = SecondStage::joint) const {
    StageOne start;
    start.xi1 = Vector2d::Zero();
    start.xi2 = VectorXd(0);
    start.noise = VectorXd::Constant(1, noise);
    return likelihood->begin(start, method);
  }

  std::unique_ptr<Likelihood> likelihood;

 private:
  std::shared_ptr<const sepcal::BlockModel> model_;
  sepcal::Record record_;
  sepcal::estimation::Problem problem_;
  sepcal::base::ThreadPool pool_;
  std::unique_ptr<sepcal::model::Measurements> measurements_;
  std::unique_ptr<sepcal::model::Sweep> sweep_;
};

}  // namespace

TEST_CASE("descent, last digits and R: a line's are those of least squares") {
  const Straight line;
  const StageTwo begun = line.likelihood->hold_open(line.begin(1.0), false);
  CHECK_FALSE(begun.hold);
  const StageTwo end = line.likelihood->refine(line.likelihood->descend(begun, first_radius));
  CHECK(end.refined);
  CHECK((end.x - Vector2d(2.2, 1.4)).norm() < 1e-12);
  CHECK(sepcal::estimation::squares(end.factors)[0] == Approx(4.8).epsilon(1e-13));
  CHECK(line.likelihood->noise_at(end)[0] == Approx(std::sqrt(1.2)).epsilon(1e-13));
  CHECK_FALSE(line.likelihood->leaves_open(end));
  CHECK(line.likelihood->cost(end) == Approx(0.5 * 4.8).epsilon(1e-13));  // at the noise 1
}

TEST_CASE("a step leaves the point that it begins at as it was") {
  const Straight line;
  const StageTwo begun = line.begin(1.0);
  const StageTwo end = line.likelihood->refine(line.likelihood->descend(begun, first_radius));
  CHECK(begun.x == Vector2d::Zero());
  CHECK(begun.iterations == 0);
  CHECK(end.iterations > 0);
}

TEST_CASE("close by, a few steps downhill do; from afar they say that they don't") {
  FitOptions options;
  options.bounds["s"] = {-5.0, 2.0};  // s <= 2: c = 10 / 4 - 2 / 2 = 1.5
  const Straight line(options);
  const auto end = line.likelihood->refine_downhill(line.begin(1.0));
  REQUIRE(end);  // a linear problem is near everywhere
  CHECK(end->x[0] == 2.0);
  CHECK(end->x[1] == Approx(1.5).epsilon(1e-12));
}

TEST_CASE("a bound of a linear parameter holds, and what was projected falls back to joint") {
  FitOptions options;
  options.bounds["s"] = {-5.0, 2.0};
  const Straight line(options);
  const StageTwo end = line.likelihood->refine(
      line.likelihood->descend(line.begin(1.0, SecondStage::projected), first_radius));
  CHECK(end.refined);
  CHECK(end.x[0] == 2.0);
  CHECK(end.x[1] == Approx(1.5).epsilon(1e-12));
  CHECK(end.at_bound == std::vector<bool>{true, false});
  CHECK(end.method == SecondStage::joint);
  REQUIRE(end.sentences.size() == 1);
  CHECK(end.sentences.front().find("because the bound of s is active") != std::string::npos);
}

TEST_CASE("noise begins no lower than 1e-12 of the output's root mean square") {
  const Straight line;
  CHECK(line.begin(0.0).noise[0] == Approx(1e-12 * std::sqrt(54.0 / 4.0)).epsilon(1e-12));
}

namespace {

/// The minimum x at noise s is s / 2 + 1, and the noise at x is x: both are 2 where they agree. The
/// first `blind` searches fail.
struct Halving {
  struct Point {
    double x = 0.0;
    VectorXd noise = VectorXd::Constant(1, 8.0);
    bool refined = false;
    bool settled = false;
    int noise_iterations = 0;
  };

  bool given = false;
  int blind = 0;
  int searches = 0;

  bool noise_given() const { return given; }
  Point find_minimum(Point at) {
    at.refined = ++searches > blind;
    at.x = 0.5 * at.noise[0] + 1.0;
    return at;
  }
  Point follow_minimum(Point at) { return find_minimum(at); }
  VectorXd noise_at(const Point& at) const { return VectorXd::Constant(1, at.x); }
  void take_noise(Point& at, const VectorXd& noise) const { at.noise = noise; }
};

}  // namespace

TEST_CASE("R and the parameters alternate until R settles") {
  Halving halving;
  const auto end = sepcal::estimation::alternate(halving, Halving::Point{}, FitOptions{});
  CHECK(end.refined);
  CHECK(end.settled);
  CHECK(end.x == Approx(2.0).epsilon(1e-9));
  CHECK(end.noise_iterations == halving.searches);
}

TEST_CASE("a given R stays, and one search is enough") {
  Halving halving{.given = true};
  const auto end = sepcal::estimation::alternate(halving, Halving::Point{}, FitOptions{});
  CHECK(end.settled);
  CHECK(end.noise[0] == 8.0);
  CHECK(halving.searches == 1);
}

TEST_CASE("after three failures or the last update R is that of the parameters returned") {
  Halving never{.blind = 100};
  auto end = sepcal::estimation::alternate(never, Halving::Point{}, FitOptions{});
  CHECK_FALSE(end.refined);
  CHECK_FALSE(end.settled);
  CHECK(never.searches == 3);
  CHECK(end.noise[0] == end.x);

  FitOptions two;
  two.noise_iterations = 2;
  Halving slow;
  end = sepcal::estimation::alternate(slow, Halving::Point{}, two);
  CHECK(end.refined);
  CHECK_FALSE(end.settled);
  CHECK(end.noise_iterations == 2);
  CHECK(end.noise[0] == end.x);
}

}  // namespace likelihood_test
