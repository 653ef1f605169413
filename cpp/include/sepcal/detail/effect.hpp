// SPDX-License-Identifier: BSD-3-Clause
// A physical effect that a model lacks: where it enters and what drives it. Five ways in:
//   varying     a linear parameter, or an input's share in an output, that follows a driver
//   terms       columns of the effect's own, which join A
//   corrections inputs replaced before the model sees them, by nonlinear parameters
//   delays      the record's time axis shifted or smoothed, by interpolation within a segment
//   remodel     a term in the model's own equations, which the model is built anew with
// At zero an effect vanishes. Model + effects is again a model (composition.hpp at run time,
// static_composition.hpp at compile time).
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/driver.hpp"
#include "sepcal/detail/eigen.hpp"

namespace sepcal {

/// A coefficient s for each component and function of the driver, named effect.component + suffix;
/// the columns phi_j A_p or phi_j u_source e_output join A.
struct Varying {
  struct Share {
    int output = 0;
    Variable source;  // an input
  };
  struct Component {
    std::string name;                // "n"
    std::string target;              // the model's linear parameter p ("w_n"), or none ...
    std::vector<Share> shares = {};  // ... but inputs' shares in outputs
  };

  DriverPointer driver;
  std::vector<Component> components;
  std::string unit;  // of a coefficient
};

/// Replaces some of a model's inputs: u'_c = f_c(u, xi2).
class Correction {
 public:
  /// `inputs`: what it reads, those that it replaces first, `corrected` of them; `nonlinear`: its
  /// parameters by their whole names.
  Correction(std::vector<Variable> inputs, int corrected, std::vector<Variable> nonlinear)
      : inputs_(std::move(inputs)), corrected_(corrected), nonlinear_(std::move(nonlinear)) {}
  Correction(const Correction&) = delete;
  Correction& operator=(const Correction&) = delete;
  virtual ~Correction() = default;

  const std::vector<Variable>& inputs() const { return inputs_; }
  int corrected() const { return corrected_; }
  const std::vector<Variable>& nonlinear() const { return nonlinear_; }

  /// What of the inputs is a driver, read as it was logged whatever corrects it.
  virtual bool is_driver(int /*input*/) const { return false; }

  /// How far [s] it reaches from a row along the time axis.
  virtual double reach() const { return 0.0; }

  /// Fills `values` (rows x corrected). Where asked for (not null), `slopes` is rows x (corrected *
  /// (n_u + n_2)): the derivatives of u'_c with respect to the inputs, then the parameters, stand
  /// in the columns from c * (n_u + n_2) on.
  virtual void evaluate(const Block& block, const double* xi2, Eigen::Ref<Eigen::MatrixXd> values,
                        Eigen::MatrixXd* slopes) const = 0;

 private:
  std::vector<Variable> inputs_;
  int corrected_;
  std::vector<Variable> nonlinear_;
};

/// An effect on the time axis. The rows nearer than its reach to a segment's edge are not used.
struct Delay {
  enum class Kind {
    inputs_late,     // u'(t) = u(t + tau): what was logged at t belongs to t - tau
    inputs_lagging,  // u'(t) = u(t) + tau du/dt: undoes tau du/dt + u = u0
    outputs_late,    // z(t) follows all inputs at t - tau
    outputs_lagging  // tau dz/dt + z = z0: z0 averaged over the past with exp(-age / tau)
  };

  Kind kind = Kind::outputs_late;
  Variable parameter;               // tau [s] by its whole name, with finite bounds
  std::vector<std::string> inputs;  // of the kinds that act on inputs: which
  /// Of a clock that drifts, late alone: from none at the first of these times [s] steadily to tau
  /// at the second, and no further. Empty: tau at all times.
  std::optional<std::pair<double, double>> grows = {};

  /// The share of tau at a time [s].
  double share_at(double time) const {
    if (!grows) return 1.0;
    const auto [first, last] = *grows;
    return std::clamp((time - first) / (last - first), 0.0, 1.0);
  }
};

struct Effect {
  std::string name;
  // Of an effect `port[driver]`: where it enters, and the coefficients' components; of a constant
  // on a port no driver.
  std::string port = {};
  DriverPointer driver = {};
  std::vector<std::string> components = {};
  // How it enters.
  std::vector<Varying> varying = {};
  std::vector<std::shared_ptr<const BlockModel>> terms = {};  // their outputs are the model's
  std::vector<std::shared_ptr<const Correction>> corrections = {};
  std::vector<Delay> delays = {};
  /// The model with nonlinear parameters more, at whose zero it is the same.
  std::function<std::shared_ptr<const BlockModel>(const std::shared_ptr<const BlockModel>&)>
      remodel = {};
  /// Where physics lets a coefficient be, by its whole name, and how much a driven one may amount
  /// to at its port: what plausible_range() goes by. Nothing holds a fit within.
  std::map<std::string, Interval> plausible = {};
  double most = infinity;
};

/// Where physics lets a parameter of the effect be, on the record that it was made for; its bounds
/// where nothing is said. An estimate beyond is no size of this effect, but another one that looks
/// like it.
Interval plausible_range(const Effect& effect, const Variable& parameter, const Record& record);

/// The correction u_i' = u_i + sign_i u_k sum_j s_ij phi_j(d), u_k an input or 1, a coefficient for
/// each target and function, named owner + "." + component + suffix, within `bounds` of either
/// sign. The components of one target add up.
struct DrivenInput {
  std::string component;
  Variable target;
  double sign = 1.0;
  std::optional<Variable> times = {};  // u_k; none: 1
};
std::shared_ptr<const Correction> driven_inputs(const std::string& owner, DriverPointer driver,
                                                const std::vector<DrivenInput>& components,
                                                const std::string& unit, double bounds);

}  // namespace sepcal
