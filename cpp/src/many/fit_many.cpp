// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/fit_many.hpp"

#include <algorithm>
#include <set>

#include "base/name_list.hpp"
#include "many/describe_many.hpp"
#include "many/joint_covariance.hpp"
#include "many/joint_filter_error.hpp"
#include "many/joint_stage.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace many;  // this room's own

namespace {

using Eigen::Index;
using Eigen::VectorXd;

void check_names(const std::vector<std::string>& names) {
  if (names.empty()) throw Error("there are no flights to fit; give one at least");
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) {
      throw Error("two flights are called '" + name + "'; give each a name of its own");
    }
  }
}

/// Throws Error for flights that can't be used, naming the first, unless they may be left out.
void check_left_out(const std::vector<LeftOut>& left_out, std::size_t flights, bool allowed) {
  if (left_out.empty()) return;
  const LeftOut& first = left_out.front();
  const bool nothing_left = left_out.size() == flights;
  if (allowed && !nothing_left) return;
  std::string text = "flight '" + first.name + "' can't be used: " + first.reason;
  if (left_out.size() > 1) {
    text += " (and " + std::to_string(left_out.size() - 1) + " more of " + std::to_string(flights) +
            ")";
  }
  throw Error(nothing_left ? text : text + "; mend it or leave such flights out (leave_out)");
}

numerics::Box joint_box(const estimation::Problem& problem, const Split& parting,
                        const Layout& layout) {
  const numerics::Box box = problem.box();
  const std::vector<Index> order = parting.order();
  return {layout.repeat(box.lower(order)), layout.repeat(box.upper(order))};
}

template <class Named>
const Named& find_named(const std::vector<Named>& all, std::string_view name,
                        const std::string& what, const std::string& owner) {
  const auto at = std::ranges::find(all, name, &Named::name);
  if (at != all.end()) return *at;
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  throw Error("there is no " + what + " '" + std::string(name) + "'; the " + owner +
              " has: " + base::list_names(names));
}

}  // namespace

const Parameter& ManyFit::operator[](std::string_view name) const {
  return find_named(shared, name, "shared parameter", "fit");
}

const FlightFit& ManyFit::flight(std::string_view name) const {
  return find_named(flights, name, "flight", "fit");
}

std::vector<FlightScore> FlightSource::scores(const std::vector<FlightPoint>& /*points*/) {
  throw Error("this source has no filter error; fit it by output error");
}

std::vector<FlightInnovations> FlightSource::innovations(
    const std::vector<FlightPoint>& /*points*/) {
  throw Error("this source has no filter error; fit it by output error");
}

std::vector<std::vector<TriangularFactor>> FlightSource::score_blocks(
    const std::vector<FlightPoint>& /*points*/, const std::vector<int>& /*blocks*/) {
  throw Error("this source has no filter error; fit it by output error");
}

ManyFit fit_many(const BlockModel& model, FlightSource& source, const ManyOptions& options) {
  const estimation::Problem problem(model, options.fit);
  const bool by_filter_error = options.fit.method == FitMethod::filter_error;
  if (!options.fit.process_noise.empty() && !by_filter_error) {
    throw Error(
        "process_noise is for one record's fit; many flights are fitted without, but by filter "
        "error");
  }
  if (options.fit.loss != Loss::squares) {
    throw Error("many flights are fitted jointly by least squares alone, without loss '" +
                std::string(to_string(options.fit.loss)) +
                "'; fit each flight by itself with it, and leave out the rows that it forgives");
  }
  const Split parting = split(problem, options.own);
  const std::vector<std::string> names = source.names();
  check_names(names);

  ManyFit result;
  std::vector<FlightStart> starts = source.start();
  std::vector<std::size_t> used;
  JointProblem joint{problem, parting, {}, {}, {}};
  joint.output_squares = VectorXd::Zero(model.tables().n_z());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!starts[i].error.empty()) {
      result.left_out.push_back({names[i], starts[i].error});
      continue;
    }
    joint.rows += static_cast<double>(starts[i].rows);
    if (!by_filter_error) joint.output_squares += starts[i].output_squares;
    joint.starts.push_back(std::move(starts[i]));
    used.push_back(i);
  }
  check_left_out(result.left_out, names.size(), options.leave_out);
  if (by_filter_error) {
    UsedFlights flights{used, {}, std::move(joint.starts)};
    for (const std::size_t i : used) flights.names.push_back(names[i]);
    fit_joint_filter_error(model, problem, options, source, std::move(flights), result);
    return result;
  }
  joint.layout = {static_cast<Index>(used.size()), parting.n_own(), parting.n_shared()};
  joint.box = joint_box(problem, parting, joint.layout);

  ManyObjective objective(source, std::move(used), joint.layout);
  const JointStage stage = run_joint_stage(joint, objective);
  const JointCovariance covariance = find_joint_covariance(joint, stage, objective, source);
  describe_many(model, joint, stage, objective, covariance, names, result);
  return result;
}

}  // namespace sepcal
