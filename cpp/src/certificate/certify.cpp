// SPDX-License-Identifier: BSD-3-Clause
// Branch and bound for the least cost over a box of xi2, the box of the least bound first.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

#include "base/thread_pool.hpp"
#include "certificate/box_bound.hpp"
#include "certificate/limits.hpp"
#include "sepcal/certificate.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace certificate;  // this room's own

using Eigen::Index;
using Eigen::VectorXd;

std::string_view to_string(Certified status) {
  switch (status) {
    case Certified::global:
      return "global";
    case Certified::elsewhere:
      return "elsewhere";
    default:
      return "not_certified";
  }
}

namespace {

struct Box {
  Ranges ranges = {};
  double lower = 0.0;
  Index widest = 0;  // the parameter to be halved
};

struct HasMore {
  bool operator()(const Box& one, const Box& other) const { return one.lower > other.lower; }
};

/// Bounds of a fit's parameters, the fixed ones at their value.
std::map<std::string, Interval> bounds_of(const Fit& fit) {
  std::map<std::string, Interval> bounds;
  for (const Parameter& parameter : fit.parameters) {
    bounds[parameter.name] = parameter.fixed ? Interval{parameter.value, parameter.value}
                                             : Interval{parameter.lower, parameter.upper};
  }
  return bounds;
}

VectorXd sigma_of(const Fit& fit) {
  VectorXd sigma(static_cast<Index>(fit.noise.size()));
  for (std::size_t j = 0; j < fit.noise.size(); ++j) {
    sigma[static_cast<Index>(j)] = fit.noise[j].value;
  }
  return sigma;
}

void check_fit(const BlockModel& model, const Fit& fit, const FitOptions& options) {
  if (!std::ranges::equal(fit.parameters, model.tables().parameters(), {}, &Parameter::name,
                          &Variable::name)) {
    throw Error("the fit is one of another model: its parameters are not the model's");
  }
  if (fit.method == FitMethod::filter_error) {
    throw Error("a fit by filter error has no cost that a box of parameters bounds");
  }
  constexpr std::ptrdiff_t most = 3;
  const auto is_free = [&](const Parameter& parameter) { return !parameter.fixed; };
  const std::ptrdiff_t free =
      std::ranges::count_if(fit.parameters.begin() + fit.n_1, fit.parameters.end(), is_free);
  if (free > most) {
    throw Error(
        fmt::format("a certificate is of at most {} nonlinear parameters, as boxes multiply "
                    "with each: {} are free; hold some",
                    most, free));
  }
  for (const auto& [name, given] : options.bounds) {
    const auto fitted = std::ranges::find(fit.parameters, name, &Parameter::name);
    if (fitted == fit.parameters.end() || fitted->fixed) continue;
    if (given.lower != fitted->lower || given.upper != fitted->upper) {
      throw Error("the bounds of '" + name + "' are not those of the fit; give its options");
    }
  }
  if (options.loss != Loss::squares || !options.prior.empty()) {
    throw Error("a certificate is of plain least squares: fit without a loss and without priors");
  }
}

class BranchAndBound {
 public:
  BranchAndBound(const BlockModel& model, const Record& record, const Fit& fit,
                 const FitOptions& fitted_with, const CertificateOptions& options)
      : record_(record.select(fitted_with.stage_two_segments)),
        fit_(fit),
        options_(options),
        problem_(model, record_, sigma_of(fit)),
        limits_(limits_of(model.tables(), bounds_of(fit))),
        pool_(options.threads) {}

  Certificate run();

 private:
  /// Bounds boxes, keeps what may hold the minimum, and tries the middles.
  void bound(std::vector<Ranges> boxes);
  void try_point(const BoxBound& at);
  double worth() const { return upper_ * (1.0 - options_.tolerance); }
  std::vector<Ranges> halve_next();
  void may_hold(const Ranges& box);
  void conclude();

  Record record_;
  const Fit& fit_;
  const CertificateOptions& options_;
  EnclosedProblem problem_;
  Limits limits_;
  base::ThreadPool pool_;
  std::vector<Box> open_;  // a heap
  double upper_ = infinity;
  double dropped_ = infinity;  // least bound of what was dropped
  Certificate result_;
};

void BranchAndBound::try_point(const BoxBound& at) {
  const Enclosure cost = problem_.cost(at.xi1, at.middle);
  if (!(cost.upper() < worth())) return;
  FitOptions options;  // down to the bottom of this valley
  options.samples = 0;
  options.coloured_errors = false;
  options.threads = 1;
  options.second_stage = SecondStage::joint;
  for (const OutputValue& noise : fit_.noise) options.noise[noise.name] = noise.value;
  for (std::size_t k = 0; k < fit_.parameters.size(); ++k) {
    const Parameter& parameter = fit_.parameters[k];
    if (parameter.fixed) {
      options.fix[parameter.name] = parameter.value;
      continue;
    }
    options.bounds[parameter.name] = {parameter.lower, parameter.upper};
    const auto j = static_cast<Index>(k) - fit_.n_1;
    if (j >= 0) options.start[parameter.name] = at.middle[j];
  }
  VectorXd best(at.xi1.size() + at.middle.size());
  best << at.xi1, at.middle;
  double least = cost.upper();
  try {
    const Fit lower = sepcal::fit(problem_.model(), record_, options);
    const double found = problem_.cost(lower.xi1(), lower.xi2()).upper();
    if (found < least) {
      least = found;
      best = lower.values();
    }
  } catch (const Error&) {
    least = cost.upper();  // the point itself is lower already
  }
  upper_ = least;
  for (std::size_t k = 0; k < fit_.parameters.size(); ++k) {
    result_.better[fit_.parameters[k].name] = best[static_cast<Index>(k)];
  }
  result_.better_cost = least;
}

void BranchAndBound::bound(std::vector<Ranges> boxes) {
  std::vector<BoxBound> bounds(boxes.size());
  pool_.for_each(boxes.size(), [&](std::size_t i) {
    bounds[i] = bound_over(problem_, boxes[i], limits_.linear, upper_);
  });
  result_.boxes += boxes.size();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    try_point(bounds[i]);
    if (!(bounds[i].lower < worth())) {
      dropped_ = std::min(dropped_, bounds[i].lower);
      if (bounds[i].lower < upper_) may_hold(boxes[i]);
      continue;
    }
    Box box{std::move(boxes[i]), bounds[i].lower, 0};
    bounds[i].swing.maxCoeff(&box.widest);
    if (!(bounds[i].swing.maxCoeff() > 0.0)) {  // the model sees none of them here: the widest
      double widest = -1.0;
      for (std::size_t j = 0; j < box.ranges.size(); ++j) {
        const double width = box.ranges[j].upper() - box.ranges[j].lower();
        if (width > widest) box.widest = static_cast<Index>(j);
        widest = std::max(widest, width);
      }
    }
    open_.push_back(std::move(box));
    std::ranges::push_heap(open_, HasMore());
  }
}

std::vector<Ranges> BranchAndBound::halve_next() {
  constexpr std::size_t at_once = 8;  // whatever the number of threads: the result is the same
  std::vector<Ranges> halves;
  while (!open_.empty() && halves.size() < 2 * at_once && open_.front().lower < worth()) {
    std::ranges::pop_heap(open_, HasMore());
    const Box box = std::move(open_.back());
    open_.pop_back();
    const auto j = static_cast<std::size_t>(box.widest);
    const double middle = box.ranges[j].middle();
    for (const Enclosure& half :
         {Enclosure(box.ranges[j].lower(), middle), Enclosure(middle, box.ranges[j].upper())}) {
      halves.push_back(box.ranges);
      halves.back()[j] = half;
    }
  }
  return halves;
}

/// Widens the region by a box in which the minimum may be.
void BranchAndBound::may_hold(const Ranges& box) {
  const std::vector<Variable>& names = problem_.model().tables().nonlinear;
  for (std::size_t j = 0; j < names.size(); ++j) {
    Interval& range =
        result_.region.try_emplace(names[j].name, Interval{infinity, -infinity}).first->second;
    range.lower = std::min(range.lower, box[j].lower());
    range.upper = std::max(range.upper, box[j].upper());
  }
}

void BranchAndBound::conclude() {
  result_.lower = std::min({dropped_, upper_, open_.empty() ? infinity : open_.front().lower});
  for (const Box& box : open_) {
    if (box.lower < upper_) may_hold(box.ranges);
  }
  const bool proven = !(result_.lower < worth());
  const std::string gap = fmt::format("{:.2g} of it", (upper_ - result_.lower) / upper_);
  if (!std::isnan(result_.better_cost)) {
    result_.status = Certified::elsewhere;
    result_.message = fmt::format("a cost of {:.6g} is reached elsewhere, the fit's is {:.6g}{}",
                                  result_.better_cost, result_.cost,
                                  proven ? "; that one is the least within the bounds" : "");
  } else if (proven) {
    result_.status = Certified::global;
    result_.message = fmt::format(
        "proven: no parameters within the bounds have a cost lower by more than {}", gap);
  } else {
    result_.message = fmt::format(
        "not proven within {} boxes: the least cost may be lower by up to {}; ask for more boxes, "
        "or narrow the bounds",
        result_.boxes, gap);
  }
}

Certificate BranchAndBound::run() {
  result_.cost = problem_.cost(fit_.xi1(), fit_.xi2()).upper();
  upper_ = result_.cost;
  bound({limits_.nonlinear});
  while (!open_.empty() && open_.front().lower < worth() && result_.boxes < options_.boxes) {
    bound(halve_next());
  }
  conclude();
  return std::move(result_);
}

}  // namespace

Certificate certify(const BlockModel& model, const Record& record, const Fit& fit,
                    const FitOptions& fitted_with, const CertificateOptions& options) {
  check_fit(model, fit, fitted_with);
  if (!(options.tolerance > 0.0)) throw Error("the tolerance of a certificate must be above zero");
  const std::size_t rows = record.select(fitted_with.stage_two_segments).rows();
  if (rows != fit.rows) {
    throw Error(fmt::format("the fit is of {} rows, its options select {}: give those of the fit",
                            fit.rows, rows));
  }
  return BranchAndBound(model, record, fit, fitted_with, options).run();
}

}  // namespace sepcal
