// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/symmetric_magnetometer.hpp"

#include <utility>

#include "flight/probes/corrected_columns.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal::exporting {
namespace {

class SymmetricProbe final : public Probe {
 public:
  explicit SymmetricProbe(std::shared_ptr<const Probe> one)
      : one_(std::move(one)), model_(SymmetricMagnetometer{}) {}

  std::string_view name() const override { return one_->name(); }
  std::string_view app() const override { return one_->app(); }
  const BlockModel& model() const override { return model_; }
  const catalogue::EffectTable& effects() const override { return one_->effects(); }
  std::span<const probes::ProbeQuantity> quantities() const override { return one_->quantities(); }
  std::map<std::string, std::vector<double>> settings() const override { return one_->settings(); }

  ProbeRecord prepare(const Flight& flight, const LogChoice& log) const override {
    return one_->prepare(flight, log);
  }

  ProbeReadings read(const Flight& flight, const LogChoice& log) const override {
    return one_->read(flight, log);
  }

  std::vector<std::string> corrected_headers() const override { return one_->corrected_headers(); }

  std::vector<CorrectedColumn> correct(const ProbeReadings& readings, const Eigen::VectorXd& values,
                                       const ReadingEffects& effects) const override {
    return probes::correct_field(readings, SymmetricMagnetometer::matrix(values),
                                 values.segment<3>(6), corrected_headers(), effects);
  }

 private:
  std::shared_ptr<const Probe> one_;
  StaticModel<SymmetricMagnetometer> model_;
};

}  // namespace

Eigen::Matrix3d SymmetricMagnetometer::matrix(const Eigen::VectorXd& values) {
  Eigen::Matrix3d C;
  C << values[0], values[3], values[4],  //
      values[3], values[1], values[5],   //
      values[4], values[5], values[2];
  return C;
}

std::shared_ptr<const Probe> symmetric_magnetometer(std::shared_ptr<const Probe> one) {
  return std::make_shared<const SymmetricProbe>(std::move(one));
}

}  // namespace sepcal::exporting
