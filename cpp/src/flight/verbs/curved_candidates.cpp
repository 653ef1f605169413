// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/curved_candidates.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <string_view>

#include "base/parameter_values.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "numerics/residual_curves.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/error.hpp"
#include "sepcal/natural_spline.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double telling = 0.1;       // share of what a line leaves that a curve must take of it
constexpr double beyond_noise = 4.0;  // times what white noise gives a curve's coefficients
constexpr double nearly_all = 0.9;    // of what the most knots take: fewer will do
constexpr double close = 0.7;         // of the best of its kind
constexpr std::array knots_tried{4, 6, 9};
constexpr std::size_t most_thresholds = 3;
constexpr double least_level = 0.04;  // share of the rows that a level holds
constexpr std::size_t most_bins = 256;
constexpr std::size_t most_curved = 6;
constexpr std::size_t most_of_time = 4;  // beside these
constexpr std::size_t fewest_fitted = 40;
constexpr std::string_view clock = "time";

/// What a constant at a port does to every reading, and what the fit leaves of them, each output in
/// units of its own RMSE.
struct PortColumns {
  std::string port;
  MatrixXd columns;  // (n_z rows) x components
};

struct Linearised {
  std::vector<PortColumns> ports;
  VectorXd residual;  // n_z rows
  Index rows = 0;
};

/// The channel's rows in bins of about equal count, no value in two of them.
struct Bins {
  std::vector<std::size_t> of_row;
  std::vector<double> lowest;  // value of each bin
  std::vector<double> highest;
  VectorXd mean;
  std::vector<double> rows;

  std::size_t size() const { return rows.size(); }
};

/// Sums over a bin's readings of a port's columns G: G'G and G'r.
struct BinSums {
  std::vector<MatrixXd> squares;
  std::vector<VectorXd> products;
};

struct Curved {
  std::string name;
  std::string channel;
  double taken = 0.0;  // share of the residual's squares
};

/// b' A^-1 b of a positive semidefinite A, along the directions that it has.
double explained_along(const MatrixXd& A, const VectorXd& b) {
  constexpr double open = 1e-10;  // of the largest eigenvalue
  const VectorXd scale =
      A.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * A * scale.asDiagonal());
  const VectorXd along = eigen.eigenvectors().transpose() * (scale.asDiagonal() * b);
  const double least = open * eigen.eigenvalues().maxCoeff();
  double sum = 0.0;
  for (Index i = 0; i < along.size(); ++i) {
    if (eigen.eigenvalues()[i] > least) sum += along[i] * along[i] / eigen.eigenvalues()[i];
  }
  return sum;
}

/// All ports at once, in one pass.
Linearised linearise(const DiagnosedFit& fitted, base::ThreadPool& pool) {
  Record record = fitted.record;
  std::vector<EffectSetting> settings = fitted.effects;
  std::vector<Effect> effects = make_effects(fitted.kit, *fitted.model, settings, record);
  std::vector<std::string> ports;
  for (const Port& port : fitted.kit.ports) {
    try {
      effects.push_back(make_driven("constant on " + port.name, port, constant_driver(), port.unit,
                                    *fitted.model, record));
      ports.push_back(port.name);
    } catch (const Error&) {
      continue;  // the record doesn't have what the port needs
    }
  }
  const auto model = compose(fitted.model, effects, record);
  record.cut(fitted.rows);
  base::ParameterValues values = fitted.fit.by_name();
  const Tables& tables = model->tables();
  for (const Variable& parameter : tables.parameters()) values.try_emplace(parameter.name, 0.0);
  const VectorXd xi1 = base::in_order(tables.linear, values);
  const VectorXd xi2 = base::in_order(tables.nonlinear, values);
  const model::Measurements measurements(*model, record);
  const model::Sweep sweep(*model, measurements, pool);

  Linearised result{.ports = {}, .residual = {}, .rows = static_cast<Index>(record.rows())};
  const MatrixXd r = sweep.residuals(xi1, xi2);
  VectorXd weight(r.size());  // of every reading
  for (Index j = 0; j < r.cols(); ++j) {
    const double rmse = r.col(j).norm() / std::sqrt(static_cast<double>(r.rows()));
    weight.segment(j * r.rows(), r.rows()).setConstant(rmse > 0 ? 1 / rmse : 0.0);
  }
  result.residual = r.reshaped().cwiseProduct(weight);
  const std::vector<Variable> parameters = tables.parameters();
  for (const std::string& port : ports) {
    std::vector<Index> own;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (parameters[k].name.starts_with("constant on " + port + ".")) {
        own.push_back(static_cast<Index>(k));
      }
    }
    result.ports.push_back({port, weight.asDiagonal() * sweep.tangent_columns(xi1, xi2, own)});
  }
  return result;
}

/// Nothing of a channel that does not vary, or is no number somewhere.
std::optional<Bins> bin(const VectorXd& values) {
  if (!values.allFinite()) return std::nullopt;
  const auto rows = static_cast<std::size_t>(values.size());
  std::vector<std::size_t> order(rows);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t row) { return values[static_cast<Index>(row)]; });
  const auto at = [&](std::size_t i) { return values[static_cast<Index>(order[i])]; };
  std::size_t distinct = 1;
  for (std::size_t i = 1; i < rows; ++i) distinct += at(i) > at(i - 1);
  if (distinct < 3) return std::nullopt;  // of two values a line is all that there is
  const std::size_t least = distinct <= most_bins ? 1 : rows / most_bins;
  Bins bins;
  bins.of_row.resize(rows);
  std::vector<double> sums;
  for (std::size_t i = 0; i < rows; ++i) {
    const bool full = bins.size() == 0 || (bins.rows.back() >= static_cast<double>(least) &&
                                           at(i) > bins.highest.back());
    if (full) {
      bins.lowest.push_back(at(i));
      bins.highest.push_back(at(i));
      bins.rows.push_back(0.0);
      sums.push_back(0.0);
    }
    bins.highest.back() = at(i);
    bins.rows.back() += 1.0;
    sums.back() += at(i);
    bins.of_row[order[i]] = bins.size() - 1;
  }
  bins.mean.resize(static_cast<Index>(bins.size()));
  for (std::size_t b = 0; b < bins.size(); ++b) {
    bins.mean[static_cast<Index>(b)] = sums[b] / bins.rows[b];
  }
  return bins;
}

BinSums sum_by_bin(const Bins& bins, const MatrixXd& G, const Linearised& fit) {
  const Index c = G.cols();
  BinSums sums{std::vector<MatrixXd>(bins.size(), MatrixXd::Zero(c, c)),
               std::vector<VectorXd>(bins.size(), VectorXd::Zero(c))};
  for (Index i = 0; i < G.rows(); ++i) {
    const std::size_t b = bins.of_row[static_cast<std::size_t>(i % fit.rows)];
    sums.squares[b] += G.row(i).transpose() * G.row(i);
    sums.products[b] += fit.residual[i] * G.row(i).transpose();
  }
  return sums;
}

/// What functions of the channel (bins x functions) explain.
double explained_by(const BinSums& sums, const MatrixXd& phi) {
  const Index c = sums.products.front().size();
  const Index q = phi.cols();
  MatrixXd A = MatrixXd::Zero(q * c, q * c);
  VectorXd b = VectorXd::Zero(q * c);
  for (Index bin = 0; bin < phi.rows(); ++bin) {
    const auto k = static_cast<std::size_t>(bin);
    for (Index i = 0; i < q; ++i) {
      b.segment(i * c, c) += phi(bin, i) * sums.products[k];
      for (Index j = 0; j < q; ++j) {
        A.block(i * c, j * c, c, c) += phi(bin, i) * phi(bin, j) * sums.squares[k];
      }
    }
  }
  return explained_along(A, b);
}

MatrixXd with_constant(const MatrixXd& functions) {
  MatrixXd phi(functions.rows(), functions.cols() + 1);
  phi << VectorXd::Ones(functions.rows()), functions;
  return phi;
}

double explained_by_spline(const BinSums& sums, const Bins& bins, int knots) {
  const SplineBasis spline(even_knots(bins.lowest.front(), bins.highest.back(), knots));
  return explained_by(sums, with_constant(numerics::spline_columns(spline, bins.mean)));
}

/// The channel cut into levels, each a constant of its own, one cut after another where it takes
/// most.
struct Levels {
  std::vector<std::size_t> cuts;  // first bins of the levels but the lowest
  double explained = 0.0;
};

class LevelFinder {
 public:
  LevelFinder(const BinSums& sums, const Bins& bins) : bins_(bins) {
    const Index c = sums.products.front().size();
    squares_.emplace_back(MatrixXd::Zero(c, c));
    products_.emplace_back(VectorXd::Zero(c));
    rows_.push_back(0.0);
    for (std::size_t b = 0; b < bins.size(); ++b) {
      squares_.emplace_back(squares_.back() + sums.squares[b]);
      products_.emplace_back(products_.back() + sums.products[b]);
      rows_.push_back(rows_.back() + bins.rows[b]);
    }
  }

  /// As long as a cut takes `least` more.
  Levels find(double least) const {
    Levels levels{{}, level(0, bins_.size())};
    while (levels.cuts.size() < most_thresholds) {
      std::size_t best = 0;
      double gain = least;
      for (std::size_t i = 0; i <= levels.cuts.size(); ++i) {
        const std::size_t first = i == 0 ? 0 : levels.cuts[i - 1];
        const std::size_t last = i == levels.cuts.size() ? bins_.size() : levels.cuts[i];
        const double whole = level(first, last);
        for (std::size_t cut = first + 1; cut < last; ++cut) {
          if (!is_wide(first, cut) || !is_wide(cut, last)) continue;
          const double more = level(first, cut) + level(cut, last) - whole;
          if (!(more > gain)) continue;
          gain = more;
          best = cut;
        }
      }
      if (best == 0) break;
      levels.cuts.insert(std::ranges::upper_bound(levels.cuts, best), best);
      levels.explained += gain;
    }
    return levels;
  }

 private:
  double level(std::size_t first, std::size_t last) const {
    return explained_along(squares_[last] - squares_[first], products_[last] - products_[first]);
  }

  bool is_wide(std::size_t first, std::size_t last) const {
    return rows_[last] - rows_[first] >= least_level * rows_.back();
  }

  const Bins& bins_;
  std::vector<MatrixXd> squares_;  // of all bins before
  std::vector<VectorXd> products_;
  std::vector<double> rows_;
};

/// The number of fewest digits above `below` and not above `from`.
double round_between(double below, double from) {
  for (int digits = 1; digits < 17; ++digits) {
    const double value = std::stod(fmt::format("{:.{}g}", 0.5 * (below + from), digits));
    if (below < value && value <= from) return value;
  }
  return from;
}

std::string name_levels(const Levels& levels, const Bins& bins) {
  std::vector<double> thresholds;
  for (const std::size_t cut : levels.cuts) {
    thresholds.push_back(round_between(bins.highest[cut - 1], bins.lowest[cut]));
  }
  return fmt::format("{}", fmt::join(thresholds, ","));
}

/// What tells enough along one channel at one port: a spline, levels, or both where it is close.
std::vector<Curved> find_curves(const std::string& channel, const Bins& bins,
                                const PortColumns& port, const Linearised& fit) {
  const BinSums sums = sum_by_bin(bins, port.columns, fit);
  const double whole = fit.residual.squaredNorm();
  const auto readings = static_cast<double>(fit.residual.size());
  const auto components = static_cast<double>(port.columns.cols());
  const double line = explained_by(sums, with_constant(bins.mean)) / whole;
  const double left = 1.0 - line;
  const auto tells = [&](double gain, double functions) {
    return gain > left * std::max(telling, beyond_noise * components * functions / readings);
  };
  std::vector<Curved> found;
  std::array<double, knots_tried.size()> gains{};
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (static_cast<std::size_t>(knots_tried[i]) > bins.size()) continue;
    gains[i] = explained_by_spline(sums, bins, knots_tried[i]) / whole - line;
  }
  const double most = std::ranges::max(gains);
  for (std::size_t i = 0; i < gains.size() && found.empty(); ++i) {
    if (gains[i] < nearly_all * most || !tells(gains[i], knots_tried[i] - 2.0)) continue;
    found.push_back({fmt::format("{}[spline({},{})]", port.port, channel, knots_tried[i]), channel,
                     line + gains[i]});
  }
  if (channel == clock) return found;  // a step in time is scanned by candidates of its own
  const Levels levels = LevelFinder(sums, bins).find(0.5 * telling * left * whole);
  const double gain = levels.explained / whole - line;
  const auto steps = static_cast<double>(levels.cuts.size());
  if (levels.cuts.empty() || !tells(gain, 2.0 * steps)) return found;
  found.push_back({fmt::format("{}[levels({},{})]", port.port, channel, name_levels(levels, bins)),
                   channel, line + gain});
  const double best = std::max(found.front().taken, line + gain);
  std::erase_if(found, [&](const Curved& one) { return one.taken < close * best; });
  return found;
}

/// The most telling first; of one channel what comes near its best port. Time, along which noise
/// that wanders curves too, takes no channel's place.
std::vector<std::string> keep_telling(std::vector<Curved> found) {
  std::ranges::stable_sort(found, std::ranges::greater{}, &Curved::taken);
  std::vector<std::string> names;
  std::size_t of_channels = 0;
  std::size_t of_time = 0;
  for (const Curved& curve : found) {
    const bool is_of_time = curve.channel == clock;
    std::size_t& count = is_of_time ? of_time : of_channels;
    if (count == (is_of_time ? most_of_time : most_curved)) continue;
    const auto best = std::ranges::find(found, curve.channel, &Curved::channel);
    if (curve.taken < close * best->taken) continue;
    names.push_back(curve.name);
    ++count;
  }
  return names;
}

}  // namespace

std::vector<std::string> find_curved(const DiagnosedFit& fitted,
                                     const std::vector<std::string>& channels,
                                     base::ThreadPool& pool) {
  const Linearised fit = linearise(fitted, pool);
  if (static_cast<std::size_t>(fit.rows) < fewest_fitted) return {};
  if (!(fit.residual.squaredNorm() > 0)) return {};
  std::vector<std::vector<Curved>> by_channel(channels.size());
  pool.for_each(channels.size(), [&](std::size_t i) {
    const auto bins = bin(gather_rows(fitted.record.column(channels[i]), fitted.rows));
    if (!bins) return;
    for (const PortColumns& port : fit.ports) {
      std::ranges::move(find_curves(channels[i], *bins, port, fit),
                        std::back_inserter(by_channel[i]));
    }
  });
  std::vector<Curved> found;
  for (std::vector<Curved>& some : by_channel) {
    std::ranges::move(some, std::back_inserter(found));
  }
  return keep_telling(std::move(found));
}

}  // namespace sepcal::verbs
