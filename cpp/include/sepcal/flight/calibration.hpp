// SPDX-License-Identifier: BSD-3-Clause
// A calibration: one probe fitted on one flight, with every option of the fit, so that later verbs
// need nothing but this and a flight. It is what BASE.json holds.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

/// Options of a fit on a flight: the engine's, and what the files add.
struct CalibrationOptions {
  FitOptions fit;
  std::vector<std::string> free;  // parameters freed that the probe holds by default
  LogChoice log = {};
  std::vector<EffectSetting> effects = {};  // that join the model, in this order
  OwnEffects own_effects = {};              // of the caller's making, that may be among them
};

/// The flight that was fitted.
struct FittedFlight {
  std::string file;
  std::string sha256;  // of the file's bytes; of arrays empty, for an aircraft that of their values
  std::size_t rows = 0;
  std::size_t rows_used = 0;  // by stage two
};

/// A quantity that follows from the estimates, with its uncertainty by the delta method.
struct Derived {
  std::string name;
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;        // NaN where that of a parameter it depends on is
  double standard_error_white = 0.0;  // what it would be if the residuals were white
  double standard_error_noise_model = not_a_number;  // these two as in Parameter
  double standard_error_blocks = not_a_number;
};

/// One step of a chain of added effects. Undefined numbers are NaN; errors are RMSE over all
/// outputs together, before and after on the same rows: in the outputs' unit or, where they have
/// several (Tables::output_unit()), each in units of its own before the first step.
struct HistoryEntry {
  std::string effect;
  double rmse_before = not_a_number;
  double rmse_after = not_a_number;
  double held_out_before = not_a_number;
  double held_out_after = not_a_number;
  double predicted_drop = not_a_number;
};

/// Of a joint fit: whether a flight agrees with the others. Undefined numbers are NaN.
struct FlightDeparture {
  std::string flight;       // its label
  double p = not_a_number;  // of a larger difference by chance, by Holm for the number of flights
  std::string parameter = {};        // shared, the most different in standard errors; may be empty
  double difference = not_a_number;  // own estimate less that of the others
  double standard_error = not_a_number;
};

struct Calibration {
  std::shared_ptr<const Probe> probe;
  CalibrationOptions options;
  FittedFlight flight;
  Fit fit;
  std::vector<Derived> derived;  // in the probe's order
  std::vector<Restatement> restated;
  std::vector<HistoryEntry> history;
  std::vector<FlightDeparture> departures = {};  // of a joint fit, in the order of its flights
  std::vector<std::string> notes = {};           // one line each, for people; not part of the JSON
  std::string file = {};                         // that it was read from; empty: it was just fitted
  /// Of each channel that an effect on the reading follows: its least and its greatest value in the
  /// rows that were fitted, in the unit used inside. A file of before has none.
  std::map<std::string, Interval> driver_ranges = {};
};

/// Fits `probe` to `flight`. Throws Error for bad input (prepare_five_hole() and its like), fewer
/// rows than parameters, and misuse (fit()).
Calibration calibrate(std::shared_ptr<const Probe> probe, const Flight& flight,
                      const CalibrationOptions& options = {});

/// The same with a record that has the columns of Probe::prepare() already.
Calibration calibrate(std::shared_ptr<const Probe> probe, const Record& record,
                      const CalibrationOptions& options = {});

/// `base` with `effect` (a name, an alias, or several joined by '+'), refitted to `flight` from the
/// base's estimates. Its history is the base's and one entry more, in which both errors are of the
/// rows that the new fit used. `own` joins the base's own effects. Throws Error for bad input and
/// for an effect that the base has already.
Calibration add(const Calibration& base, const Flight& flight, const std::string& effect,
                const OwnEffects& own = {}, const FitProgress& progress = {});

/// The values of the probe's own parameters, in the order of its tables.
Eigen::VectorXd own_values(const Calibration& calibration);

/// Of every JSON object that is written, whatever it is of.
inline constexpr int schema_version = 3;

/// The JSON of interface.md's "Results": one object, two-space indented, numbers that read back as
/// the same doubles, null where a number is undefined.
std::string to_json(const Calibration& calibration);

/// What to_text() gives of a fit's message, a sentence a line, the worst first.
enum class Detail {
  brief,      // the three worst, each without its reasons where it would not fit a line
  explained,  // all of it
};

/// The page that the apps print: status, parameters, errors, what the stages did, and the chain of
/// added effects, each with the error before and after.
std::string to_text(const Calibration& calibration, Detail detail = Detail::brief);

/// The same of a fit without a flight, as far as it goes.
std::string to_text(const Fit& fit, const CalibrationOptions& options,
                    Detail detail = Detail::brief);

/// Reads what to_json() wrote, of which to_json() is the same text, and what it wrote as version 1.
/// `source` opens the messages. Throws Error for text that is not such an object, any other schema
/// version, or a model of another app than `app` ("sepcal-pitot"; empty: any).
Calibration parse_calibration(std::string_view json, const std::string& source,
                              std::string_view app = {});

/// The same of a model of your own (own_model.hpp). Throws Error also where the calibration is of
/// another model.
Calibration parse_calibration(std::string_view json, const std::string& source,
                              std::shared_ptr<const Probe> own);

/// parse_calibration() of a file. Throws Error also where it can't be read.
Calibration read_calibration(const std::string& file, std::string_view app = {});
Calibration read_calibration(const std::string& file, std::shared_ptr<const Probe> own);

/// Writes to_json() to a file that appears whole or not at all.
void write_calibration(const Calibration& calibration, const std::string& file);

}  // namespace sepcal
