// SPDX-License-Identifier: BSD-3-Clause
// A probe on several flights that were joined: its model with the flights' own parameters, and what
// it says of a fit, flight by flight.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "flight/joint/own_by_flight.hpp"
#include "sepcal/detail/flight/joint.hpp"

namespace sepcal::joint {

/// Whether each flight has the parameter for itself; and whether this is one flight's,
/// "w_n@monday".
bool is_own(const JointSetup& setup, const std::string& name);
bool is_of_one_flight(const JointSetup& setup, const std::string& name);

/// The fit of a joint model on one flight, whose parameters are those of the model for one: shared
/// ones and, under the model's names, what is the flight's own; not-a-numbers for no flight ("").
Fit fit_on_flight(const Fit& fit, const JointSetup& setup, const std::string& flight);

class JointProbe final : public Probe {
 public:
  JointProbe(std::shared_ptr<const Probe> one, JointSetup setup);

  const std::shared_ptr<const Probe>& one() const { return one_; }
  const JointSetup& setup() const { return setup_; }

  std::string_view name() const override { return one_->name(); }
  std::string_view app() const override { return one_->app(); }
  const BlockModel& model() const override {
    if (setup_.own.empty()) return one_->model();  // which may go along a path
    return model_;
  }
  std::shared_ptr<const Probe> along(const Record& record) const override;
  std::vector<std::string> initial_states() const override { return one_->initial_states(); }
  const catalogue::EffectTable& effects() const override { return one_->effects(); }
  std::span<const probes::ProbeQuantity> quantities() const override { return one_->quantities(); }
  const TrajectoryOptions* trajectory() const override { return one_->trajectory(); }
  const ModelSource* source() const override { return one_->source(); }
  std::map<std::string, std::vector<double>> settings() const override { return one_->settings(); }
  std::unique_ptr<const Probe> settle(const Flight& flight, const LogChoice& log) const override;
  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return one_->prepare(flight, log);
  }
  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return one_->read(flight, log);
  }
  std::vector<std::string> corrected_headers() const override { return one_->corrected_headers(); }

  /// Throws Error: a correction is of one flight (for_flight()).
  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const Eigen::VectorXd& values,
                                       const ReadingEffects& effects) const override;

  /// With the own parameters' shared part at zero.
  std::map<std::string, double> held() const override;
  FitOptions complete(const FitOptions& options, const Record& record) const override;
  std::unique_ptr<const Probe> with_noise(double standard_deviation) const override;
  void judge(Fit& fit) const override { one_->judge(fit); }
  void judge_flights(Calibration& calibration, const Flight& joined) const override;
  std::string suggest(const Fit& fit, const Record& record) const override {
    return one_->suggest(fit, record);
  }
  std::vector<DerivedQuantity> derive(const Fit& fit) const override;
  std::vector<Restatement> restate(const Fit& fit) const override;

 private:
  std::shared_ptr<const Probe> one_;
  JointSetup setup_;
  OwnByFlight model_;
};

/// Each flight's own parameter gets what was said of all flights'.
template <class Value>
void spread_own(std::map<std::string, Value>& by_name, const JointSetup& setup) {
  for (const std::string& name : setup.own) {
    const auto found = by_name.find(name);
    if (found == by_name.end()) continue;
    for (const JoinedFlight& flight : setup.flights) {
      by_name.emplace(name_of_own(name, flight.label), found->second);
    }
    by_name.erase(name);
  }
}

/// nullptr of a probe of one flight.
const JointProbe* as_joint(const Probe& probe);

}  // namespace sepcal::joint
