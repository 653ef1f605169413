// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/small_aircraft.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::simulation {

using Eigen::Vector3d;

enum class Maneuver { turn, popu, multisine, pitch_chirp, yaw_chirp, rudder_doublet };

struct Leg {
  std::string_view label;
  Maneuver maneuver;
  double begin;        // [s]
  double end;          // [s], included
  double angle = 0.0;  // a turn's change of track [rad]
};

struct FlightPlan {
  std::span<const Leg> legs;  // in order of time; cruise in between
  double begin;               // [s]
  double end;                 // [s]
  double speed_period;        // of the slow change of airspeed [s]
  double size = 1.0;          // of the slow motions
};

namespace {

constexpr double cruise_airspeed = 17.0;  // [m/s]

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
constexpr FlightPlan full_plan{full_legs, 380.0, 1120.0, 173.0};

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
constexpr FlightPlan condensed_plan{condensed_legs, 0.0, 120.0, 47.0};

/// Straight ahead, an eighth of the slow motions.
constexpr FlightPlan full_straight_plan{{}, 380.0, 1120.0, 173.0, 0.125};
constexpr FlightPlan condensed_straight_plan{{}, 0.0, 120.0, 47.0, 0.125};

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
Motion move(const FlightPlan& plan, double at, double sink) {
  const Moving time{at, 1.0};
  const Moving slow = 2.0 * pi * (time - plan.begin) / plan.speed_period;
  Motion motion;
  motion.airspeed = cruise_airspeed + plan.size * (3.0 * sin(slow) + 1.5 * sin(2.7 * slow));
  motion.climb = sink / motion.airspeed + plan.size * 0.05 * sin(0.8 * slow);
  motion.beta = plan.size * 0.01 * sin(11.0 * slow);
  motion.roll = plan.size * 0.02 * sin(9.0 * slow);
  for (const Leg& leg : plan.legs) add_leg(motion, leg, time);
  const Moving slowness = cruise_airspeed / motion.airspeed;
  motion.alpha += 0.09 * slowness * slowness / cos(motion.roll) - 0.02;  // lift carries the weight
  return motion;
}

const FlightPlan& choose_plan(const SimulationOptions& options) {
  if (options.excitation == Excitation::third) {
    throw Error("excitation 'third' is a magnetometer's; an aircraft can fly rich or poor");
  }
  const bool full = options.rows == 0;
  if (options.excitation == Excitation::poor) {
    return full ? full_straight_plan : condensed_straight_plan;
  }
  return full ? full_plan : condensed_plan;
}

/// Out at a fifth and at a third of the flight, in at 0.55 and 0.8, 2 s each time.
double flap_at(const FlightPlan& plan, double time) {
  constexpr double duration = 2.0;  // [s]
  const auto moved = [&](double part) {
    return step((time - plan.begin - part * (plan.end - plan.begin)) / duration).value;
  };
  return moved(0.2) + moved(1.0 / 3.0) - moved(0.55) - moved(0.8);
}

constexpr double node_spacing = 0.05;  // of the altitude [s]
constexpr int margin_nodes = 1600;     // before the first row and after the last

}  // namespace

SmallAircraft::SmallAircraft(const SimulationOptions& options, Vector3d wind, double altitude)
    : plan_(choose_plan(options)),
      wind_(std::move(wind)),
      times_(sample_times(plan_.begin, plan_.end, options)) {
  const auto climb = [&](double time) {
    const Motion motion = move(plan_, time, wind_.z());
    return -(motion.attitude().body_to_ned() * motion.velocity() + wind_).z();
  };
  // Simpson's rule from node to node.
  const auto nodes =
      static_cast<int>((plan_.end - plan_.begin) / node_spacing) + 2 * margin_nodes + 1;
  const double first = plan_.begin - margin_nodes * node_spacing;
  climbs_.push_back(climb(first));
  altitudes_.push_back(0.0);
  for (int k = 1; k < nodes; ++k) {
    const double time = first + k * node_spacing;
    const double middle = climb(time - 0.5 * node_spacing);
    const double last = climbs_.back();
    climbs_.push_back(climb(time));
    altitudes_.push_back(altitudes_.back() +
                         node_spacing / 6.0 * (last + 4.0 * middle + climbs_.back()));
  }
  const double shift = altitude - altitudes_[margin_nodes];
  for (double& node : altitudes_) node += shift;
  altitudes_[margin_nodes] = altitude;
}

/// Cubic between the nodes, with the climbs as slopes.
double SmallAircraft::altitude_at(double time) const {
  const double position = (time - plan_.begin) / node_spacing + margin_nodes;
  const auto last = static_cast<double>(altitudes_.size() - 2);
  const double left = std::clamp(std::floor(position), 0.0, last);
  const auto i = static_cast<std::size_t>(left);
  const double x = position - left;
  const double rise = altitudes_[i + 1] - altitudes_[i];
  const double begin = node_spacing * climbs_[i];
  const double end = node_spacing * climbs_[i + 1];
  return altitudes_[i] +
         x * (begin + x * (3.0 * rise - 2.0 * begin - end + x * (begin + end - 2.0 * rise)));
}

AircraftState SmallAircraft::at(double time) const {
  const Motion motion = move(plan_, time, wind_.z());
  AircraftState state;
  state.attitude = motion.attitude();
  state.rates = state.attitude.body_rates();
  state.velocity = motion.velocity();
  state.ground = state.attitude.body_to_ned() * state.velocity + wind_;
  state.altitude = altitude_at(time);
  state.air = standard_air(state.altitude);
  state.throttle = 0.5 + 0.5 * std::tanh(0.06 * (motion.airspeed.value - cruise_airspeed) +
                                         2.4 * motion.climb.value + 0.8 * wander(time, 0));
  state.current =
      1.5 + 16.0 * state.throttle * std::sqrt(state.throttle) + 2.5 * (1.0 + wander(time, 1));
  state.flap = flap_at(plan_, time);
  return state;
}

std::string_view SmallAircraft::label(double time) const {
  const auto leg = std::ranges::find_if(plan_.legs, [&](const Leg& candidate) {
    return candidate.begin <= time && time <= candidate.end;
  });
  return leg == plan_.legs.end() ? "cruise" : leg->label;
}

Moment SmallAircraft::moment(double time, const AircraftState& state) {
  return {time,
          {time, state.rates.x(), state.rates.y(), state.rates.z(), state.air.temperature,
           state.altitude, state.throttle, state.current, state.flap}};
}

Sources SmallAircraft::sources() const {
  return list_sources(
      {"time", "p", "q", "r", "temp_k", "altitude_m", "throttle", "current_a", "flap"},
      [this](double time) { return moment(time, at(time)); },
      [this](double time) { return label(time); }, times_);
}

}  // namespace sepcal::simulation
