// SPDX-License-Identifier: BSD-3-Clause
// A small aircraft flies the input design of Sun & Gebre-Egziabher, Table 5. Airspeed, flow angles,
// bank, climb and track are chosen; attitude and body rates follow from them; the wind carries the
// aircraft over the ground; the probe feels the air that it meets and reports four pressures.
#include <Eigen/Geometry>
#include <algorithm>
#include <span>

#include "sepcal/error.hpp"
#include "simulated_flight.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Vector3d;

constexpr double cruise_airspeed = 17.0;  // [m/s]

enum class Maneuver { turn, popu, multisine, pitch_chirp, yaw_chirp, rudder_doublet };

struct Leg {
  std::string_view label;
  Maneuver maneuver;
  double begin;        // [s]
  double end;          // [s], included
  double angle = 0.0;  // a turn's change of track [rad]
};

struct Plan {
  std::span<const Leg> legs;  // in order of time; cruise in between
  double begin;               // [s]
  double end;                 // [s]
  double speed_period;        // of the slow change of airspeed [s]
};

/// Table 5, with the turns (ours, labelled cruise) that bring the aircraft back each time.
constexpr Leg full_legs[] = {
    {"wind_circle_1", Maneuver::turn, 384.0, 408.2, 2 * pi},
    {"wind_circle_2", Maneuver::turn, 411.0, 438.3, -2 * pi},
    {"cruise", Maneuver::turn, 455.0, 475.0, pi},
    {"popu", Maneuver::popu, 510.9, 530.0},
    {"cruise", Maneuver::turn, 540.0, 560.0, -pi},
    {"multisine_1", Maneuver::multisine, 576.0, 596.0},
    {"cruise", Maneuver::turn, 630.0, 650.0, pi},
    {"multisine_2", Maneuver::multisine, 690.0, 711.0},
    {"cruise", Maneuver::turn, 720.0, 740.0, -pi},
    {"multisine_3", Maneuver::multisine, 752.0, 772.0},
    {"cruise", Maneuver::turn, 780.0, 800.0, pi},
    {"multisine_4", Maneuver::multisine, 810.0, 830.0},
    {"cruise", Maneuver::turn, 840.0, 860.0, -pi},
    {"pitch_chirp_1", Maneuver::pitch_chirp, 867.0, 887.0},
    {"cruise", Maneuver::turn, 920.0, 940.0, pi},
    {"yaw_chirp", Maneuver::yaw_chirp, 980.080, 1013.595},
    {"cruise", Maneuver::turn, 1018.0, 1036.0, -pi},
    {"pitch_chirp_2", Maneuver::pitch_chirp, 1041.0, 1061.0},
    {"cruise", Maneuver::turn, 1080.0, 1100.0, pi},
    {"rudder_doublet", Maneuver::rudder_doublet, 1113.0, 1115.0},
};
constexpr Plan full_plan{full_legs, 380.0, 1120.0, 173.0};

/// The same excitation without the waiting.
constexpr Leg condensed_legs[] = {
    {"wind_circle_1", Maneuver::turn, 0.0, 24.0, 2 * pi},
    {"popu", Maneuver::popu, 24.0, 36.0},
    {"multisine_1", Maneuver::multisine, 36.0, 56.0},
    {"pitch_chirp_1", Maneuver::pitch_chirp, 56.0, 72.0},
    {"yaw_chirp", Maneuver::yaw_chirp, 72.0, 92.0},
    {"rudder_doublet", Maneuver::rudder_doublet, 92.0, 96.0},
    {"wind_circle_2", Maneuver::turn, 96.0, 120.0, -2 * pi},
};
constexpr Plan condensed_plan{condensed_legs, 0.0, 120.0, 47.0};

/// How the aircraft moves through the air.
struct Motion {
  Moving airspeed;  // [m/s]
  Moving alpha;     // [rad]
  Moving beta;      // [rad]
  Moving roll;      // [rad]
  Moving climb;     // of the path through the air, up [rad]
  Moving track;     // of the path through the air, from north [rad]

  /// Path and flow angles fix where the nose points, to first order in the flow angles: close
  /// enough to keep the path, and the attitude is exact in itself.
  Attitude attitude() const {
    return {roll, climb + alpha * cos(roll) + beta * sin(roll),
            track + alpha * sin(roll) - beta * cos(roll)};
  }

  /// Velocity through the air in body axes [m/s].
  Vector3d velocity() const {
    const double a = alpha.value;
    const double b = beta.value;
    return airspeed.value *
           Vector3d(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b));
  }
};

/// A sine sweep from 0.2 Hz at x = 0 to `highest` [Hz] at x = 1, `lag` [rad] behind.
Moving chirp(Moving x, double duration, double highest, double lag = 0.0) {
  constexpr double lowest = 0.2;
  const Moving cycles = duration * x * (lowest + 0.5 * (highest - lowest) * x);
  return sin(2.0 * pi * cycles - lag);
}

/// Six harmonics, every third from `first`, in Schroeder phases: axes with other `first` move
/// independently.
Moving multisine(Moving x, int first) {
  constexpr int count = 6;
  Moving sum;
  for (int k = 0; k < count; ++k) {
    sum += sin(2.0 * pi * (first + 3 * k) * x - pi * k * (k - 1) / count);
  }
  return sum / std::sqrt(count);
}

/// Adds what one leg does at `time`. A turn goes on counting in the track after its end.
void add_leg(Motion& motion, const Leg& leg, Moving time) {
  const double duration = leg.end - leg.begin;
  const Moving x = (time - leg.begin) / duration;  // 0 to 1
  const Moving envelope = window(x);
  switch (leg.maneuver) {
    case Maneuver::turn: {
      constexpr double edge = 0.15;
      const double rate = leg.angle / (1.0 - edge);  // [rad] for one unit of x
      motion.track += rate * edge * (ramp(x / edge) - ramp((x - (1.0 - edge)) / edge));
      const double bank = std::atan(cruise_airspeed * rate / duration / standard_gravity);
      motion.roll += bank * window(x, edge);
      break;
    }
    case Maneuver::popu:
      motion.alpha += 0.08 * envelope * sin(6.0 * pi * x);
      motion.climb += -0.14 * envelope * cos(6.0 * pi * x);  // the path follows the lift
      break;
    case Maneuver::multisine:
      motion.alpha += 0.04 * envelope * multisine(x, 2);
      motion.roll += 0.16 * envelope * multisine(x, 3);
      motion.beta += 0.06 * envelope * multisine(x, 4);
      break;
    case Maneuver::pitch_chirp:
      motion.alpha += 0.05 * envelope * chirp(x, duration, 1.5);
      motion.climb += 0.04 * envelope * chirp(x, duration, 1.5, 0.5 * pi);
      break;
    case Maneuver::yaw_chirp:
      motion.beta += 0.10 * envelope * chirp(x, duration, 1.2);
      motion.roll += 0.12 * envelope * chirp(x, duration, 1.2, 0.5 * pi);
      break;
    case Maneuver::rudder_doublet:
      motion.beta += 0.13 * envelope * sin(2.0 * pi * x);
      break;
  }
}

/// Cruise, and on top of it every leg. `sink` is the wind's downward part [m/s], held against.
Motion move(const Plan& plan, double at, double sink) {
  const Moving time{at, 1.0};
  const Moving slow = 2.0 * pi * (time - plan.begin) / plan.speed_period;
  Motion motion;
  motion.airspeed = cruise_airspeed + 3.0 * sin(slow) + 1.5 * sin(2.7 * slow);
  motion.climb = sink / motion.airspeed + 0.05 * sin(0.8 * slow);
  motion.beta = 0.01 * sin(11.0 * slow);
  motion.roll = 0.02 * sin(9.0 * slow);
  for (const Leg& leg : plan.legs) add_leg(motion, leg, time);
  const Moving slowness = cruise_airspeed / motion.airspeed;
  motion.alpha += 0.09 * slowness * slowness / cos(motion.roll) - 0.02;  // lift carries the weight
  return motion;
}

std::string_view label(const Plan& plan, double time) {
  const auto leg = std::find_if(plan.legs.begin(), plan.legs.end(), [&](const Leg& candidate) {
    return candidate.begin <= time && time <= candidate.end;
  });
  return leg == plan.legs.end() ? "cruise" : leg->label;
}

struct Pressures {
  double total;
  double alpha;  // of the angle-of-attack ports
  double beta;   // of the sideslip ports
};

/// What the probe reports [Pa] in air that it meets with `velocity` (body axes, at the probe, m/s).
Pressures read_probe(const FiveHoleTruth& truth, const Vector3d& velocity, const Air& air) {
  const auto parameter = [&](const char* name) { return truth.parameters.at(name); };
  // The probe's axes: C(eps)' of Eq. 38 is a positive turn about forward.
  const Vector3d met =
      Eigen::AngleAxisd(parameter("eps_phi"), Vector3d::UnitX()).toRotationMatrix() * velocity;
  const double airspeed = met.norm();
  const double indicated = (airspeed - parameter("b_va")) / (1.0 + parameter("lambda_va"));
  if (!(indicated > 0.0)) {
    throw Error(truth.source + ": b_va = " + format_number(parameter("b_va")) +
                " m/s leaves the probe nothing to read at " + format_number(airspeed) +
                " m/s of airspeed; choose it smaller");
  }
  const double alpha = std::atan2(met.z(), met.x());
  const double beta = std::asin(met.y() / airspeed);
  const double impact = 0.5 * air.density * indicated * indicated;
  return {
      air.pressure + impact,
      truth.k_alpha * impact * (alpha - parameter("b_alpha")) / (1.0 + parameter("lambda_alpha")),
      truth.k_beta * impact * (beta - parameter("b_beta")) / (1.0 + parameter("lambda_beta"))};
}

void check(const FiveHoleTruth& truth) {
  check_parameters(truth.source, truth.parameters, FiveHoleTruth{}.parameters);
  check_values(truth.source, "lever arm", truth.lever_arm);
  check_values(truth.source, "velocity noise", truth.noise, 0.0);
  for (const auto& [name, k] :
       {std::pair("k_alpha", truth.k_alpha), std::pair("k_beta", truth.k_beta)}) {
    if (k > 0.0 && std::isfinite(k)) continue;
    throw Error(truth.source + ": sensitivity " + format_number(k) + " 1/rad of " + name +
                " must be finite and above 0");
  }
}

}  // namespace

SimulatedFlight simulate_five_hole(const FiveHoleTruth& truth, const SimulationOptions& options) {
  check(truth);
  const Plan& plan = options.rows == 0 ? full_plan : condensed_plan;
  const std::vector<double> times = sample_times(plan.begin, plan.end, options);
  const Vector3d wind(truth.parameters.at("w_n"), truth.parameters.at("w_e"),
                      truth.parameters.at("w_d"));
  const Vector3d lever_arm(truth.lever_arm.data());
  Noise noise(options.seed);

  SimulatedFlight flight =
      open_flight({"time_s", "roll_rad", "pitch_rad", "yaw_rad", "p_radps", "q_radps", "r_radps",
                   "vn_mps", "ve_mps", "vd_mps", "pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "temp_k",
                   "rho_kgpm3", "altitude_m", "throttle", "current_a"},
                  times.size());
  flight.truth = truth.parameters;

  double altitude = truth.altitude;
  double last_time = times.front();
  double last_sink = 0.0;
  for (const double time : times) {
    const Motion motion = move(plan, time, wind.z());
    const Attitude attitude = motion.attitude();
    const Vector3d rates = attitude.body_rates();
    const Vector3d ground = attitude.body_to_ned() * motion.velocity() + wind;
    altitude -= 0.5 * (time - last_time) * (last_sink + ground.z());
    last_time = time;
    last_sink = ground.z();

    const Air air = standard_air(altitude);
    const Pressures read = read_probe(truth, motion.velocity() + rates.cross(lever_arm), air);
    const Vector3d logged = ground + noise.draw(truth.noise);
    const double throttle = std::clamp(
        0.45 + 0.03 * (motion.airspeed.value - cruise_airspeed) + 1.2 * motion.climb.value, 0.0,
        1.0);
    append_row(flight, label(plan, time),
               {time, wrap(attitude.roll.value), attitude.pitch.value, wrap(attitude.yaw.value),
                rates.x(), rates.y(), rates.z(), logged.x(), logged.y(), logged.z(), read.total,
                air.pressure, read.alpha, read.beta, air.temperature, air.density, altitude,
                throttle, 1.5 + 18.0 * throttle * std::sqrt(throttle)});
  }
  return flight;
}

}  // namespace sepcal
