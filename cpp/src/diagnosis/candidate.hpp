// SPDX-License-Identifier: BSD-3-Clause
// A candidate effect at the fit: the columns dz/d eta at eta = 0 that it would add. An effect on a
// port has those of the port times its driver's functions.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/parameter_values.hpp"
#include "base/thread_pool.hpp"
#include "diagnosis/columns.hpp"
#include "diagnosis/linearisation.hpp"
#include "diagnosis/projection.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// A shape does not exist at zero size: it is scanned.
struct ShapeGrid {
  std::string parameter;       // "bias_step.t0"; empty: there is none
  std::vector<double> values;  // at least one: NaN where there is no shape
  double tried = 1.0;          // among how many the best was chosen
};

struct Candidate {
  std::string name = {};
  std::vector<std::string> drivers = {};
  std::vector<EffectSetting> settings = {};  // of the effect, or of a pair's
  std::vector<Effect> effects = {};
  std::vector<Variable> coefficients = {};  // in the order of the columns
  std::vector<std::size_t> counts = {};     // of each effect, how many of these
  ShapeGrid shape = {};
  std::string stepping_port = {};  // of a single effect that is a step in time
  bool stands_in = false;          // follows a channel that can't be the cause at its port
};

/// How much a candidate asks to be believed, least first: how many effects it is of; whether it has
/// a physics of its own or follows a channel as it is, a power or a product, a shape that was
/// scanned, or a function of any form; how many coefficients it has.
std::tuple<std::size_t, int, std::size_t> complexity_of(const Candidate& candidate);

/// Whether an effect of it is a function of any form.
bool is_of_any_form(const Candidate& candidate);

/// Whether it is of one effect that is no function of any form.
bool is_simple(const Candidate& candidate);

/// Whether it is so many effects that have a physics of their own or follow a channel as it is.
bool is_of_lines(const Candidate& candidate, std::size_t effects);

/// Whether it is one time by which something is late.
bool is_lag(const Candidate& candidate);

/// Whether the one is a line along the channel of which the other is a function of any form, at any
/// port or at the same.
bool is_line_of(const Candidate& line, const Candidate& curve, bool at_its_port);

/// Of which inputs columns are made: as they were read, without their white noise where that leaves
/// clearly less of the error; as the kit's disturbed ones would have been read without what the
/// model leaves; or as they were read, to the last digit.
enum class Regressors { read, undisturbed, unsmoothed };

/// A candidate's columns, as many as coefficients.
struct CandidateColumns {
  Columns whole;
  Columns varying;  // drivers about their mean: a constant share is the matter of the model's own
                    // parameters
};

/// Makes candidates and their columns for one fit. columns() may be called from several threads.
class CandidateRoom {
 public:
  /// Evaluates the fit. Throws Error for a fit whose parameters are not those of its model.
  CandidateRoom(const DiagnosedFit& fitted, base::ThreadPool& pool);

  /// At a fit that has the candidate as its last effects, as if it had not: their columns are the
  /// candidate's, and the residual is what it was before they explained their share. Of a model
  /// that integrates a state.
  CandidateRoom(const DiagnosedFit& fitted, const Candidate& released, base::ThreadPool& pool,
                Regressors regressors = Regressors::read);

  /// Adds to fit() what corrections of inputs that may wander do to the outputs.
  void add_input_drift();

  /// Keeps an orthonormal basis in the tangent's place, after add_input_drift() that needs it.
  void orthonormalise() { diagnosis::orthonormalise(linearisation_); }

  const LinearisedFit& fit() const { return linearisation_; }
  const Record& record() const { return record_; }
  const std::vector<Segment>& rows() const { return fitted_.rows; }

  /// The record of which columns are made. The residual is that of the readings.
  Record regressors() const;

  const Fit& fitted() const { return fitted_.fit; }
  const DiagnosedFit& diagnosed() const { return fitted_; }

  /// The model of the fit, and with more effects.
  std::shared_ptr<const BlockModel> model() const;
  std::shared_ptr<const BlockModel> model_with(const std::vector<Effect>& added) const;

  /// Whether the model integrates a state: its rows follow from those before them.
  bool follows_path() const { return path_ != nullptr; }

  /// From which sine on an effect can be seen, where `asked` is asked for.
  double visible_from(double asked) const {
    return follows_path() ? std::min(asked, visible_along_path) : asked;
  }

  /// Throws Error where the record can't make it. A setting is of one effect, and may have a
  /// centre.
  const Candidate& make(const std::string& name) { return make(EffectSetting{.name = name}); }
  const Candidate& make(const EffectSetting& setting);

  /// Throws Error where the record doesn't log what the port needs. Once, before drive().
  void open(const Port& port);

  /// What the port does where a driver's functions are `phi` (N x functions): of each component a
  /// column a function. The room must outlive them.
  Columns drive(const Port& port, const Eigen::MatrixXd& phi) const;

  /// What an open port does for a driver that is 1 in every row, a column a component; nullptr
  /// where it acts on a path, along which what one row does goes on in those after it.
  const Eigen::MatrixXd* columns_of(const std::string& port) const;

  /// What a change of each of the model's inputs does to every output, stacked as the tangent, by
  /// differences, and what each correction of them does that may wander; of a model that
  /// integrates a state the corrections alone.
  Eigen::MatrixXd input_columns() const;

  /// The time of each of the N rows [s].
  std::vector<double> times() const;

  /// The functions of an effect's driver (N x functions) at a shape, where it has one; 0 where they
  /// are no number.
  Eigen::MatrixXd functions_of(const Effect& effect, double shape) const;

  /// The room must outlive them.
  CandidateColumns columns(const Candidate& candidate, double shape) const;

 private:
  /// What a change of inputs that vary does to the model's residual, by differences.
  struct ResidualSlopes {
    Eigen::VectorXd residual;         // every output's, stacked
    std::vector<std::string> inputs;  // a column each
    Eigen::VectorXd spreads;          // of their values
    Eigen::MatrixXd columns;
  };

  ResidualSlopes slopes_by(const BlockModel& model, const std::vector<std::string>& inputs,
                           const Record& at) const;
  Candidate make_anew(const EffectSetting& given);
  CandidateColumns effect_columns(const Candidate& candidate, std::size_t place,
                                  std::span<const Variable> coefficients, double shape) const;
  CandidateColumns keep(const std::string& key,
                        const std::function<CandidateColumns()>& make) const;
  CandidateColumns driven_columns(const Effect& effect, double shape) const;
  const Port& port_of(const Effect& effect) const;
  bool acts_on_path(const Port& port) const;
  PathChange change_by(const std::vector<Effect>& added, const base::ParameterValues& values,
                       const std::vector<std::string>& names) const;
  Eigen::MatrixXd path_columns(const PathChange& change) const;
  Columns drive_path(const PathChange& change, const Eigen::MatrixXd& phi) const;
  std::vector<Effect> with_those_of_fit(const std::vector<Effect>& added) const;
  Eigen::MatrixXd composed_columns(const std::vector<Effect>& added,
                                   const base::ParameterValues& shapes,
                                   const std::vector<std::string>& names) const;
  /// Rows of all outputs become those of the used ones, over their RMSE.
  void scale_outputs(Eigen::MatrixXd& stacked) const;
  void linearise(const Candidate& released, base::ThreadPool& pool, Regressors regressors);
  void smooth_regressors(std::vector<Eigen::Index> columns, base::ThreadPool& pool);
  void undisturb_regressors(std::vector<Eigen::Index> columns, base::ThreadPool& pool);
  void release(const Candidate& released, const Eigen::MatrixXd& columns);
  Eigen::MatrixXd input_drift_columns();

  const DiagnosedFit& fitted_;
  Record record_;  // with what effects derive from other columns
  std::vector<EffectSetting> settings_;
  std::vector<Effect> effects_;  // that the fit has
  base::ParameterValues values_;
  LinearisedFit linearisation_;
  Record used_;                                      // the rows of record_ that are fitted
  Record regressors_;                                // of which columns are made
  std::optional<PathNoise> noise_;                   // in which a filter follows the path
  std::shared_ptr<const BlockModel> followed_ = {};  // with effects, where it integrates a state
  std::unique_ptr<const PathTangent> path_ = {};     // its path
  std::map<std::string, Eigen::MatrixXd> ports_;     // open ones
  std::map<std::string, PathChange> path_ports_;     // that act on a path
  mutable std::mutex keeping_;
  mutable std::map<std::string, CandidateColumns> kept_columns_ = {};
  mutable Eigen::Index kept_ = 0;                          // of their numbers
  std::map<std::string, CandidateColumns> released_ = {};  // of effects that the fit has
  std::map<std::string, Candidate> made_;  // once: an effect may leave columns in the record
};

}  // namespace sepcal::diagnosis
