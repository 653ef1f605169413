// SPDX-License-Identifier: BSD-3-Clause
// Effects by their names, at run time: `port[driver]` on any model. A port is where an effect may
// enter; what a driver takes from the record that it first met (its centre, its knots) is kept, so
// that the same effect means the same on another record.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/composition.hpp"
#include "sepcal/detail/effect.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// An effect by its name, with what it took from the record that it was first made for.
struct EffectSetting {
  std::string name;                                    // whole, aliases resolved
  std::optional<double> centre = {};                   // of a power's driver
  std::optional<double> mean = {};                     // of the power, where it is taken away
  std::vector<double> knots = {};                      // of a spline
  std::vector<double> means = {};                      // of its functions, likewise
  std::vector<std::string> labels = {};                // of the driver `maneuver`
  std::optional<std::pair<double, double>> span = {};  // the record's first and last time [s]
  std::optional<double> t0 = {};                       // [s] of a step, once it was found
  bool known = false;                                  // whether the rest was filled in already

  friend bool operator==(const EffectSetting&, const EffectSetting&) = default;
};

/// Where an effect may enter. Each component gets coefficients of its own.
struct Port {
  struct Component {
    std::string name;                         // "n"; a coefficient is called effect.n
    std::string linear = {};                  // a linear parameter of the model, or
    std::string input = {};                   // one of its inputs, with
    double sign = 1.0;                        // this sign, or
    std::string times = {};                   // of this input a share, or
    std::vector<Varying::Share> shares = {};  // inputs' shares in outputs
  };

  std::string name;  // "wind"
  std::string unit;
  std::vector<Component> components;
  double plausible = infinity;  // the most that an effect there may amount to: an input's bound
  /// Whether the model takes a constant on the port as its own: powers and splines of a channel
  /// that keeps away from zero (a voltage) then go about their mean, so that the model's parameters
  /// stay those of the flight and not of a zero that nobody saw.
  bool constant_is_own = true;
  /// Channels of which the model has a straight line there: their splines go without.
  std::vector<std::string> lines = {};
  /// How the names of channels that can drive it begin, where not any can (the wind changes with
  /// time and place): any other stands in for one of these.
  std::vector<std::string> causes = {};
};

/// An error that wanders, a Gauss-Markov process, and how far instruments of the kind let it: what
/// exceeds that is no noise of theirs, and diagnose() does not take it for one.
struct ErrorBound {
  std::string name;                       // "velocity": what options call it
  std::string unit;                       // of what it is an error of
  double size = 0.0;                      // standard deviation of each component, at most [unit]
  double time_s = 0.0;                    // its correlation time; 0: any
  std::string port = {};                  // where it comes in, in each component, or
  std::vector<std::string> outputs = {};  // in each of these, or
  std::vector<int> corrections = {};      // as these of the kit's `attitude_errors`
};

/// What a model's effects can be made of.
struct EffectKit {
  using Maker =
      std::function<Effect(const BlockModel& model, EffectSetting& setting, Record& record)>;

  std::vector<Port> ports;
  std::map<std::string, Maker> own;  // effects with a physics of their own, by name
  /// Corrections whose size need not be constant: noise of the inputs, as an attitude's error that
  /// its filter lets wander. diagnose() takes nothing for found that they explain.
  std::vector<Maker> attitude_errors = {};
  /// Inputs that read what the outputs lack, as a probe's pressures hold the gusts: what the model
  /// leaves of an error may stand in them. diagnose() takes nothing for found that it would not
  /// find were they without it.
  std::vector<std::string> disturbed = {};
  /// Errors that wander within bounds; none: each output's, by as much as its white noise.
  std::vector<ErrorBound> error_budget = {};
  std::map<std::string, std::function<std::string(const Record&)>> aliases;  // to whole names
};

/// Effects of the caller's own, by name (own_effect(), column_effect()); they go before a kit's
/// own.
using OwnEffects = std::map<std::string, EffectKit::Maker>;

/// An effect whose columns are known for every row of the record: `columns` by component, each of
/// shape (rows, n_z). Throws Error for another shape and for a value that is no number within the
/// record's segments.
Effect column_effect(const std::string& name, const std::string& unit,
                     const std::vector<std::pair<std::string, Eigen::MatrixXd>>& columns,
                     const BlockModel& model, const Record& record);

/// The kit of any model: each linear parameter and each input is a port with the one component `s`.
EffectKit plain_kit(const Tables& model);

/// The effects called `settings`, whose gaps are filled in from `record`, which may get columns
/// that an effect derives from others. Throws Error for a name that is unknown, listing those that
/// there are, for a channel that the record doesn't have, and for one that doesn't vary.
std::vector<Effect> make_effects(const EffectKit& kit, const BlockModel& model,
                                 std::vector<EffectSetting>& settings, Record& record);

/// The effect called `owner` on a port, with the driver that `means` names: what make_effects()
/// does for `port[driver]`, for makers of a kit.
Effect make_named(const std::string& owner, const EffectName& means, const Port& port,
                  const BlockModel& model, EffectSetting& setting, Record& record);

/// The same with a driver made already.
Effect make_driven(const std::string& owner, const Port& port, const DriverPointer& driver,
                   const std::string& unit, const BlockModel& model, const Record& record);

/// What every effect on `port` adds to its component there, row by row over the whole record, at
/// the values of the parameters; empty where none acts there. NaN in rows outside the segments and
/// where a delay reaches beyond them. Throws Error for a parameter without a value.
Eigen::VectorXd port_total(const std::vector<Effect>& effects, const std::string& port,
                           const std::string& component,
                           const std::map<std::string, double>& values, const Record& record);

}  // namespace sepcal
