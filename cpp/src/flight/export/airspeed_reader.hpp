// SPDX-License-Identifier: BSD-3-Clause
// The equivalent airspeed that an autopilot makes of a differential pressure, before its own scale.
// A membrane's pressure is taken as it is. Through an SDP31, 32 or 33 air flows: the autopilots add
// what is lost in the tube and at its tip before the root, and a velocity after it.
#pragma once

#include <array>
#include <optional>

#include "sepcal/flight/export.hpp"

namespace sepcal::exporting {

/// Of the air at the sensor.
struct Air {
  double pressure = 101325.0;   // static [Pa]
  double temperature = 288.15;  // [K]
};

/// The equivalent airspeed is factor * scaled + added [m/s]; factor is what a calibration sets.
struct IndicatedAirspeed {
  double scaled = 0.0;
  double added = 0.0;
};

/// How the flow through an SDP3x is corrected: PX4's CAL_AIR_CMODEL, or ArduPilot's one way.
enum class FlowModel {
  pitot = 0,      // Drotek's tube with its tip
  no_pitot = 1,   // without the tip's loss
  tube_loss = 2,  // the loss along a tube of a given diameter
  venturi = 3,    // as the first, with the ports the other way round
  ardupilot = 4,  // not PX4's: ArduPilot's own
};

class AirspeedReader {
 public:
  /// Of a membrane.
  AirspeedReader() = default;

  /// Of an SDP3x in PX4, with CAL_AIR_CMODEL, CAL_AIR_TUBELEN [m], CAL_AIR_TUBED_MM [mm]. Throws
  /// OptionError for values that PX4 does not know.
  static AirspeedReader px4(const std::array<double, 3>& cal_air);

  /// Of an SDP3x in ArduPilot.
  static AirspeedReader ardupilot();

  /// Whether air flows through the sensor.
  bool flows() const { return model_.has_value(); }

  /// Of a differential pressure [Pa]; 0 of one that is not above zero.
  IndicatedAirspeed indicate(double dp, const Air& air) const;

  /// dp [Pa] of an equivalent airspeed [m/s] that was read with `factor`.
  double pressure_behind(double airspeed, double factor, const Air& air) const;

 private:
  IndicatedAirspeed indicate_px4(double dp, const Air& air) const;
  double less_along_tube(double dp, const Air& air) const;

  std::optional<FlowModel> model_ = {};  // none of a membrane
  double length_ = 0.0;                  // of the tubes [m]
  double diameter_ = 0.0;                // [m]
};

}  // namespace sepcal::exporting
