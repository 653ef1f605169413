// SPDX-License-Identifier: BSD-3-Clause
// A probe is a model together with what it takes to bring a flight to it and back: the columns it
// needs, what must be known of the instrument, and the correction that a calibration makes.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/options.hpp"

namespace sepcal {

struct Calibration;
struct Fit;
struct TrajectoryOptions;

namespace catalogue {
struct EffectTable;
}
namespace probes {
struct ProbeQuantity;
}

/// Columns that applying a calibration adds: header and a value a row (NaN where there is none).
struct CorrectedColumn {
  std::string header;
  std::vector<double> values;
};

/// A quantity that follows from the estimates.
struct DerivedQuantity {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::map<std::string, double> slopes;  // its derivatives, by parameter; zero where not named
};

/// Estimates in another form, as people elsewhere write them.
struct Restatement {
  std::string name;                                    // "wind"
  std::string sentence;                                // "from 242 deg, 46.1 kt; ..."
  std::map<std::string, std::vector<double>> numbers;  // of the sentence, units in their names
};

/// What a calibration's effects do to readings. Empty: nothing.
struct ReadingEffects {
  /// A term of the model, at its parameters' values.
  struct Term {
    std::shared_ptr<const BlockModel> model;
    Eigen::VectorXd xi1;
    Eigen::VectorXd xi2;
  };

  std::map<std::string, Eigen::VectorXd> totals;  // by "port.component", a value a row
  std::vector<Term> terms;

  /// The total there in a row; 0 where no effect acts there.
  double at(const std::string& port_component, std::size_t row) const;
};

inline constexpr std::string_view own_app = "python -m sepcal";

/// A verb of an app as people type it: "sepcal-pitot add", or "python -m sepcal add --model
/// FILE.py:CLASS" with what the app names as its model, if it does.
std::string command_of(std::string_view app, std::string_view verb);

/// Where a model of the caller's own is written, so that people find it again and a change of it is
/// noticed.
struct ModelSource {
  std::string name;    // as --model takes it, "my_models.py:HotWire"
  std::string sha256;  // of the file's bytes; empty: there is none
};

class Probe {
 public:
  Probe() = default;
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;
  virtual ~Probe() = default;

  /// "five-hole", say: the JSON's `model`. shipped_probes() lists those that ship.
  virtual std::string_view name() const = 0;

  /// The command that calibrates it: "sepcal-pitot", "sepcal-mag"; `own_app` of a model of your
  /// own.
  virtual std::string_view app() const = 0;

  virtual const BlockModel& model() const = 0;

  /// Of a model with a state the same probe along this record, each of whose segments begins at
  /// initial states of its own, which join the model's parameters. Else nullptr.
  virtual std::shared_ptr<const Probe> along(const Record& /*record*/) const { return nullptr; }

  /// How these are called, "theta_0" of "theta_0", "theta_0[turn]" and "theta_0[2]". Empty: the
  /// model has no state.
  virtual std::vector<std::string> initial_states() const { return {}; }

  /// How a model of the caller's own is laid along a record; its calibration's file tells, and is
  /// read with no other. Else nullptr.
  virtual const TrajectoryOptions* trajectory() const { return nullptr; }

  /// Of a model of the caller's own, where that is known; else nullptr.
  virtual const ModelSource* source() const { return nullptr; }

  /// All that it reads of a log.
  virtual std::span<const probes::ProbeQuantity> quantities() const = 0;

  /// All that is known of the effects that it may lack: unless overridden what is registered under
  /// its name.
  virtual const catalogue::EffectTable& effects() const;

  /// What must be known of the instrument, by the names of the options, e.g. k_alpha {4.5},
  /// lever_arm {0.35, 0, -0.02}. make_probe() takes them back.
  virtual std::map<std::string, std::vector<double>> settings() const = 0;

  /// Where something of the instrument is to be found in the flight of a fit: the same probe, with
  /// that. Else nullptr. Throws Error as prepare() does, and where the flight doesn't show it.
  virtual std::unique_ptr<const Probe> settle(const Flight& /*flight*/,
                                              const LogChoice& /*log*/) const {
    return nullptr;
  }

  /// What a fit takes of a flight; throws Error as prepare_five_hole() and its like do.
  virtual ProbeRecord prepare(const Flight& flight, const LogChoice& log) const = 0;

  /// What applying a calibration takes of a flight: every row, but for drop_invalid.
  virtual ProbeReadings read(const Flight& flight, const LogChoice& log) const = 0;

  /// Headers of the columns that correct() gives.
  virtual std::vector<std::string> corrected_headers() const = 0;

  /// The corrected readings; `values` are the model's parameters, linear then nonlinear. Throws
  /// Error where the calibration can't be inverted.
  virtual std::vector<CorrectedColumn> correct(const ProbeReadings& readings,
                                               const Eigen::VectorXd& values,
                                               const ReadingEffects& effects) const = 0;

  /// Whether applying a calibration gives what the model with its effects makes of its inputs, in
  /// place of correct().
  virtual bool predicts() const { return false; }

  /// Parameters that a fit holds at a value unless they are freed.
  virtual std::map<std::string, double> held() const { return {}; }

  /// The options with what a record says before it is fitted: bounds and a start. Throws Error
  /// where the record can't be this probe's.
  virtual FitOptions complete(const FitOptions& options, const Record& /*record*/) const {
    return options;
  }

  /// Where the model depends on the standard deviation of its own output: the same probe with that
  /// of a fit, which is then fitted again until both agree. Else nullptr.
  virtual std::unique_ptr<const Probe> with_noise(double /*standard_deviation*/) const {
    return nullptr;
  }

  /// Adds what only the probe knows to a fit's status, message and unobservable combinations.
  virtual void judge(Fit& fit) const;

  /// Of several flights: sets `departures` of a calibration of it, or adds a note that says why
  /// not.
  virtual void judge_flights(Calibration& /*calibration*/, const Flight& /*joined*/) const {}

  /// What another setting would make of a fit's record, where that is far better; else nothing.
  virtual std::string suggest(const Fit& /*fit*/, const Record& /*record*/) const { return {}; }

  virtual std::vector<DerivedQuantity> derive(const Fit& fit) const;

  /// The estimates of the probe's own parameters in other forms.
  virtual std::vector<Restatement> restate(const Fit& /*fit*/) const { return {}; }
};

/// Whether a parameter is an initial state, of one record alone.
bool is_initial_state(const Probe& probe, std::string_view parameter);

/// The model's parameters that are of every record: all but initial states.
std::vector<Variable> lasting_parameters(const Probe& probe);

/// K_alpha, K_beta [1/rad] and the lever arm from the velocity's reference point [m, body axes].
/// Throws Error where a sensitivity is not positive.
std::unique_ptr<const Probe> five_hole_probe(double k_alpha, double k_beta,
                                             const std::array<double, 3>& lever_arm);

/// A boom with two vanes and a Pitot tube, its head there from the velocity's reference point [m,
/// body axes]. Throws Error where the lever arm is not finite.
std::unique_ptr<const Probe> vane_boom_probe(const std::array<double, 3>& lever_arm);

/// A plain tube; w_d is held at zero.
std::unique_ptr<const Probe> pitot_static_probe();

/// The Earth's field, north, east, down [uT], or nothing where the flight logs it; how the sensor
/// is mounted, or nothing where the flight of a fit is to show it (settle()).
std::unique_ptr<const Probe> magnetometer_probe(
    const std::optional<std::array<double, 3>>& field,
    const std::optional<Mounting>& mounting = Mounting{});

/// The field's strength [uT] alone, or nothing where the flight of a fit is to show it (settle()):
/// then it is the mean radius of the readings' ellipsoid, in their own unit or counts. And the
/// sensor's noise [uT] where it is known already. A fit begins with the ellipsoid of the readings.
/// Throws Error where the strength is not positive or the noise is negative.
std::unique_ptr<const Probe> attitude_independent_probe(std::optional<double> field_strength,
                                                        double noise = 0.0);

/// A probe that ships: its name, and what people call it, "five-hole probe".
struct ShippedName {
  std::string name;
  std::string words;
};

/// All that ship.
std::vector<ShippedName> shipped_probes();

/// The probe of that name with settings as Probe::settings() gives them. Throws Error for a name
/// that is unknown, a setting that is missing or of the wrong length.
std::unique_ptr<const Probe> make_probe(std::string_view name,
                                        const std::map<std::string, std::vector<double>>& settings);

}  // namespace sepcal
