// SPDX-License-Identifier: BSD-3-Clause
// A two-stage start, a refinement and corrections with effects, in double and in float, as flight
// software compiles them.
#include "sepcal/core.hpp"

namespace {

template <class Scalar>
Scalar run(const Scalar* y, int count) {
  namespace effects = sepcal::effects;
  const auto probe = sepcal::FiveHoleProbe{4.5, 4.6} + effects::AirspeedScale<"temp_degc">{} +
                     effects::PressureOffset<"current_a">{};
  using Probe = std::remove_const_t<decltype(probe)>;
  using Start = sepcal::TwoStageStart<Probe, 40, 3, Scalar>;
  typename Start::Outputs noise = Start::Outputs::Constant(Scalar(0.1));
  typename Start::Parameters bound = Start::Parameters::Constant(Scalar(1));
  Start start(probe, noise, -bound, bound);
  for (int k = 0; k + 20 < count; ++k) {
    start.add(Eigen::Map<const typename Start::Inputs>(y + k),
              Eigen::Map<const typename Start::Outputs>(y + k));
  }
  start.seal();
  while (start.work() == sepcal::StartStatus::working) {
  }
  using Form = sepcal::InformationForm<Start::n, Scalar>;
  sepcal::JointFilter<Probe, Form> filter(
      probe, {start.parameters(), Form::of_information_root(start.information_root())});
  const Eigen::Matrix<Scalar, 3, 3> R = Eigen::Matrix<Scalar, 3, 3>::Identity();
  filter.update_iterated(Eigen::Map<const typename Start::Inputs>(y),
                         Eigen::Map<const typename Start::Outputs>(y), R);
  const sepcal::Calibrated<Probe, Scalar> calibrated{probe, filter.xi1(), filter.p()};
  Scalar sum = sepcal::correct(calibrated,
                               typename Start::Inputs(Eigen::Map<const typename Start::Inputs>(y)))
                   .airspeed;

  const auto sensor = sepcal::Magnetometer{} + effects::Bias<"current_a">{} +
                      effects::CubicNonlinearity{} + effects::AxisScale<"temp_degc">{};
  using Sensor = std::remove_const_t<decltype(sensor)>;
  sepcal::Calibrated<Sensor, Scalar> compass{sensor};
  compass.xi1.setConstant(y[0]);
  compass.xi2.setConstant(y[1]);
  sum += sepcal::correct(compass, sepcal::Vec<Scalar, 3>(y[0], y[1], y[2]),
                         sepcal::Vec<Scalar, 5>(Eigen::Map<const sepcal::Vec<Scalar, 5>>(y)))
             .h.sum();
  return sum;
}

}  // namespace

double run_all(const double* y, const float* x, int count);

double run_all(const double* y, const float* x, int count) {
  return run(y, count) + static_cast<double>(run(x, count));
}
