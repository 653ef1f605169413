// SPDX-License-Identifier: BSD-3-Clause
// V_m of many flights as scoring asks for it: at a point every flight hands over V_m and the factor
// of its score rows, whose rows stand for them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "many/split.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

/// theta: own parameters of each flight, then the shared ones, as Layout has them.
class FlightsLikelihood final : public ScoredLikelihood {
 public:
  /// `flights`: the places in the source of those that take part. `noises` and `outputs`: how many
  /// logarithms of process noises and of outputs' end theta. The source must outlive this.
  FlightsLikelihood(FlightSource& source, std::vector<std::size_t> flights, const Layout& layout,
                    Eigen::Index noises, Eigen::Index outputs)
      : source_(source),
        flights_(std::move(flights)),
        layout_(layout),
        noises_(noises),
        outputs_(outputs) {}

  Eigen::Index noises() const override { return noises_; }
  Eigen::Index outputs() const override { return outputs_; }
  Eigen::Index size() const override { return layout_.size(); }

  Value value(const Eigen::VectorXd& theta) const override;
  Value scores(const Eigen::VectorXd& theta, const VisitScores& visit) const override;

  const Layout& layout() const { return layout_; }
  /// What flights say at theta, in their order; a pass over the data unless it was the last asked.
  const std::vector<FlightScore>& ask(const Eigen::VectorXd& theta) const;
  std::vector<FlightPoint> points(const Eigen::VectorXd& theta) const;

  /// Rows of a flight's [own | shared | r] in columns of theta and the residual.
  Eigen::MatrixXd spread(const TriangularFactor& factor, Eigen::Index flight) const;

  int passes() const { return passes_; }

 private:
  FlightSource& source_;
  std::vector<std::size_t> flights_;
  Layout layout_;
  Eigen::Index noises_;
  Eigen::Index outputs_;
  mutable Eigen::VectorXd at_ = {};
  mutable std::vector<FlightScore> scores_ = {};
  mutable int passes_ = 0;
};

}  // namespace sepcal::many
