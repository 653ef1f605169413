// SPDX-License-Identifier: BSD-3-Clause
// R and the parameters in turn for a straight line, where every step is known in closed form.
#include "estimation/alternation.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/record.hpp"
#include "sepcal/static_model.hpp"
#include "small_models.hpp"

using doctest::Approx;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::estimation::Alternation;
using sepcal::estimation::StageTwo;

namespace {

/// z = s u + c at u = -1, 0, 1, 2 with z = 0, 1, 2, 7: s = 2.2, c = 1.4, SSE = 4.8; R-hat =
/// 4.8 / 4.
class Straight {
 public:
  explicit Straight(FitOptions options = {})
      : model_(sepcal::block_model(sepcal::test::Line{})),
        record_(),
        problem_(*model_, options),
        pool_(1) {
    record_.add("u", {-1.0, 0.0, 1.0, 2.0}).add("z", {0.0, 1.0, 2.0, 7.0});
    measurements_ = std::make_unique<sepcal::model::Measurements>(*model_, record_);
    sweep_ = std::make_unique<sepcal::model::Sweep>(*model_, *measurements_, pool_);
    result.x = Vector2d::Zero();
    result.noise = VectorXd::Ones(1);
    result.at_bound = {false, false};
  }
  Alternation alternate() { return {problem_, *sweep_, 1e4, result}; }

  StageTwo result;

 private:
  std::shared_ptr<const sepcal::BlockModel> model_;
  sepcal::Record record_;
  sepcal::estimation::Problem problem_;
  sepcal::base::ThreadPool pool_;
  std::unique_ptr<sepcal::model::Measurements> measurements_;
  std::unique_ptr<sepcal::model::Sweep> sweep_;
};

const double root_mean_square = std::sqrt(1.2);

}  // namespace

TEST_CASE("descent, last digits and R: a line's are those of least squares") {
  Straight line;
  Alternation alternation = line.alternate();
  alternation.begin_noise();
  alternation.look_around({});
  CHECK_FALSE(alternation.holds());
  alternation.descend();
  CHECK(alternation.refine());
  CHECK((line.result.x - Vector2d(2.2, 1.4)).norm() < 1e-12);
  CHECK(sepcal::estimation::squares(line.result.factors)[0] == Approx(4.8).epsilon(1e-13));
  CHECK(alternation.update_noise() == Approx(0.2).epsilon(1e-12));  // from 1 to 1.2
  CHECK(line.result.noise[0] == Approx(root_mean_square).epsilon(1e-13));
  CHECK(alternation.update_noise() < 1e-15);
  CHECK_FALSE(alternation.ends_open());
}

TEST_CASE("a bound of a linear parameter holds, and what was projected falls back to joint") {
  // s <= 2: c = 10 / 4 - 2 / 2 = 1.5.
  FitOptions options;
  options.bounds["s"] = {-5.0, 2.0};
  Straight line(options);
  line.result.method = sepcal::SecondStage::projected;
  Alternation alternation = line.alternate();
  alternation.begin_noise();
  alternation.look_around({});
  alternation.descend();
  CHECK(alternation.refine());
  CHECK(line.result.x[0] == 2.0);
  CHECK(line.result.x[1] == Approx(1.5).epsilon(1e-12));
  CHECK(line.result.at_bound == std::vector<bool>{true, false});
  CHECK(line.result.method == sepcal::SecondStage::joint);
  CHECK(line.result.message.find("because the bound of s is active") != std::string::npos);
}

TEST_CASE("noise begins no lower than 1e-12 of the output's root mean square") {
  Straight line;
  line.result.noise[0] = 0.0;
  line.alternate().begin_noise();
  CHECK(line.result.noise[0] == Approx(1e-12 * std::sqrt(54.0 / 4.0)).epsilon(1e-12));
}
