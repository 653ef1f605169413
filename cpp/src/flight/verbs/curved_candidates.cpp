// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/curved_candidates.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>

#include "base/parameter_values.hpp"
#include "diagnosis/projection.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "numerics/normal_equations.hpp"
#include "numerics/residual_curves.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/error.hpp"
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
constexpr std::size_t most_curved = 16;
constexpr std::size_t most_ports = 3;  // of a channel
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
  MatrixXd tangent;   // orthonormal, of the fit's own parameters
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

/// Sums over a bin's readings of a port's columns G: G'G, T'G of the tangent T and G'r.
struct BinSums {
  MatrixXd squares;
  MatrixXd shares;
  VectorXd products;

  BinSums& operator+=(const BinSums& other) {
    squares += other.squares;
    shares += other.shares;
    products += other.products;
    return *this;
  }
};

BinSums no_readings(Index components, Index parameters) {
  return {MatrixXd::Zero(components, components), MatrixXd::Zero(parameters, components),
          VectorXd::Zero(components)};
}

struct Curved {
  std::string name;
  std::string channel;
  std::string port;
  double taken = 0.0;  // share of the residual's squares
};

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

  Linearised result;
  result.rows = static_cast<Index>(record.rows());
  const MatrixXd r = sweep.residuals(xi1, xi2);
  VectorXd weight(r.size());  // of every reading
  for (Index j = 0; j < r.cols(); ++j) {
    const double rmse = r.col(j).norm() / std::sqrt(static_cast<double>(r.rows()));
    weight.segment(j * r.rows(), r.rows()).setConstant(rmse > 0 ? 1 / rmse : 0.0);
  }
  result.residual = r.reshaped().cwiseProduct(weight);
  const std::vector<Variable> parameters = tables.parameters();
  std::vector<Index> estimated;
  for (const Parameter& parameter : fitted.fit.parameters) {
    if (parameter.fixed || parameter.at_bound) continue;
    const auto at = std::ranges::find(parameters, parameter.name, &Variable::name);
    estimated.push_back(at - parameters.begin());
  }
  result.tangent = diagnosis::orthonormal_basis(weight.asDiagonal() *
                                                sweep.tangent_columns(xi1, xi2, estimated));
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

std::vector<BinSums> sum_by_bin(const Bins& bins, const MatrixXd& G, const Linearised& fit) {
  std::vector<BinSums> sums(bins.size(), no_readings(G.cols(), fit.tangent.cols()));
  for (Index i = 0; i < G.rows(); ++i) {
    BinSums& own = sums[bins.of_row[static_cast<std::size_t>(i % fit.rows)]];
    own.squares += G.row(i).transpose() * G.row(i);
    own.shares += fit.tangent.row(i).transpose() * G.row(i);
    own.products += fit.residual[i] * G.row(i).transpose();
  }
  return sums;
}

/// What functions of the channel (bins x functions) explain beyond the tangent.
double explained_by(const std::vector<BinSums>& sums, const MatrixXd& phi) {
  const Index c = sums.front().products.size();
  const Index q = phi.cols();
  MatrixXd A = MatrixXd::Zero(q * c, q * c);
  MatrixXd S = MatrixXd::Zero(sums.front().shares.rows(), q * c);
  VectorXd b = VectorXd::Zero(q * c);
  for (Index bin = 0; bin < phi.rows(); ++bin) {
    const BinSums& own = sums[static_cast<std::size_t>(bin)];
    for (Index i = 0; i < q; ++i) {
      b.segment(i * c, c) += phi(bin, i) * own.products;
      S.middleCols(i * c, c) += phi(bin, i) * own.shares;
      for (Index j = 0; j < q; ++j) {
        A.block(i * c, j * c, c, c) += phi(bin, i) * phi(bin, j) * own.squares;
      }
    }
  }
  const VectorXd lengths = A.diagonal().cwiseSqrt();
  return numerics::explained_squares(A - S.transpose() * S, b, lengths).square;
}

MatrixXd with_constant(const MatrixXd& functions) {
  MatrixXd phi(functions.rows(), functions.cols() + 1);
  phi << VectorXd::Ones(functions.rows()), functions;
  return phi;
}

double explained_by_spline(const std::vector<BinSums>& sums, const Bins& bins, int knots) {
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
  LevelFinder(const std::vector<BinSums>& sums, const Bins& bins) : bins_(bins) {
    before_.push_back(no_readings(sums.front().products.size(), sums.front().shares.rows()));
    rows_.push_back(0.0);
    for (std::size_t b = 0; b < bins.size(); ++b) {
      before_.push_back(before_.back());
      before_.back() += sums[b];
      rows_.push_back(rows_.back() + bins.rows[b]);
    }
  }

  /// As long as a cut takes `least` more: looked for in strides, then near the best.
  Levels find(double least, std::size_t most) const {
    constexpr std::size_t strides = 40;
    const std::size_t stride = std::max<std::size_t>(1, bins_.size() / strides);
    Levels levels{{}, explained_by({})};
    while (levels.cuts.size() < most) {
      Levels best = levels;
      const auto offer = [&](std::size_t cut) {
        Levels more = levels;
        more.cuts.insert(std::ranges::upper_bound(more.cuts, cut), cut);
        if (!are_wide(more.cuts)) return;
        more.explained = explained_by(more.cuts);
        if (more.explained > best.explained) best = std::move(more);
      };
      for (std::size_t cut = stride; cut < bins_.size(); cut += stride) offer(cut);
      if (best.cuts.size() == levels.cuts.size()) break;
      const std::size_t found = newest(levels.cuts, best.cuts);
      for (std::size_t cut = found - stride + 1; cut < found + stride; ++cut) {
        if (cut < bins_.size()) offer(cut);
      }
      if (!(best.explained > levels.explained + least)) break;
      levels = std::move(best);
    }
    return levels;
  }

 private:
  static std::size_t newest(const std::vector<std::size_t>& fewer,
                            const std::vector<std::size_t>& cuts) {
    return *std::ranges::find_if(
        cuts, [&](std::size_t cut) { return std::ranges::find(fewer, cut) == fewer.end(); });
  }

  /// Of the levels between these cuts, each a constant: nearly as explained_squares() has it.
  double explained_by(const std::vector<std::size_t>& cuts) const {
    constexpr double ridge = 1e-9;  // a constant alone may be the tangent's
    const Index c = before_.front().products.size();
    const auto levels = static_cast<Index>(cuts.size()) + 1;
    MatrixXd A = MatrixXd::Zero(levels * c, levels * c);
    MatrixXd S(before_.front().shares.rows(), levels * c);
    VectorXd b(levels * c);
    for (Index i = 0; i < levels; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const BinSums& first = before_[i == 0 ? 0 : cuts[k - 1]];
      const BinSums& last = before_[i + 1 == levels ? bins_.size() : cuts[k]];
      A.block(i * c, i * c, c, c) = (1.0 + ridge) * (last.squares - first.squares);
      S.middleCols(i * c, c) = last.shares - first.shares;
      b.segment(i * c, c) = last.products - first.products;
    }
    A -= S.transpose() * S;
    return b.dot(A.ldlt().solve(b));
  }

  bool are_wide(const std::vector<std::size_t>& cuts) const {
    double first = 0.0;
    for (std::size_t i = 0; i <= cuts.size(); ++i) {
      const double last = i == cuts.size() ? rows_.back() : rows_[cuts[i]];
      if (last - first < least_level * rows_.back()) return false;
      first = last;
    }
    return true;
  }

  const Bins& bins_;
  std::vector<BinSums> before_;  // of all bins before
  std::vector<double> rows_;
};

/// The roundest number above `below` and not above `from`, to a millionth of what the channel
/// spans.
double round_between(double below, double from, double span) {
  double value = from;
  const int first = static_cast<int>(std::ceil(std::log10(span))) - 1;
  for (int power = first; power > first - 6; --power) {
    const double step = std::pow(10.0, power);
    value = std::stod(fmt::format("{:.{}f}", std::round(0.5 * (below + from) / step) * step,
                                  std::max(0, -power)));
    if (below < value && value <= from) break;
  }
  return value;
}

std::string name_levels(const Levels& levels, const Bins& bins) {
  std::vector<double> thresholds;
  for (const std::size_t cut : levels.cuts) {
    thresholds.push_back(round_between(bins.highest[cut - 1], bins.lowest[cut],
                                       bins.highest.back() - bins.lowest.front()));
  }
  return fmt::format("{}", fmt::join(thresholds, ","));
}

/// Shares of the residual's squares that functions of one channel take at one port.
struct AlongChannel {
  const PortColumns* port = nullptr;
  std::vector<BinSums> sums;
  double line = 0.0;
  std::array<double, knots_tried.size()> gains{};  // of splines, beyond the line
};

AlongChannel scan(const Bins& bins, const PortColumns& port, const Linearised& fit) {
  AlongChannel along{.port = &port, .sums = sum_by_bin(bins, port.columns, fit)};
  const double whole = fit.residual.squaredNorm();
  along.line = explained_by(along.sums, with_constant(bins.mean)) / whole;
  for (std::size_t i = 0; i < along.gains.size(); ++i) {
    if (static_cast<std::size_t>(knots_tried[i]) > bins.size()) continue;
    along.gains[i] = explained_by_spline(along.sums, bins, knots_tried[i]) / whole - along.line;
  }
  return along;
}

/// Whether so many functions more than a line take enough at a port: `gain` of all squares.
bool tells(const AlongChannel& along, double gain, double functions, const Linearised& fit) {
  const auto components = static_cast<double>(along.port->columns.cols());
  const auto readings = static_cast<double>(fit.residual.size());
  return gain >
         (1.0 - along.line) * std::max(telling, beyond_noise * components * functions / readings);
}

/// Which of knots_tried: the fewest with which some port has nearly all that any has; none where
/// no port's curve tells. The same for all ports, also for one whose line takes nearly all: the
/// wrong port with more knots than the right one may follow the curve closer.
std::optional<std::size_t> choose_knots(const std::vector<AlongChannel>& ports,
                                        const Linearised& fit) {
  std::array<double, knots_tried.size()> best{};
  for (const AlongChannel& port : ports) {
    std::ranges::transform(best, port.gains, best.begin(), std::ranges::max);
  }
  const double enough = nearly_all * std::ranges::max(best);
  const auto chosen = static_cast<std::size_t>(
      std::ranges::find_if(best, [&](double gain) { return gain >= enough; }) - best.begin());
  const bool tell = std::ranges::any_of(ports, [&](const AlongChannel& port) {
    return tells(port, port.gains[chosen], knots_tried[chosen] - 2.0, fit);
  });
  return tell ? std::optional(chosen) : std::nullopt;
}

/// What tells enough along one channel at one port: a spline, levels, or both where it is close.
std::vector<Curved> find_curves(const std::string& channel, const Bins& bins,
                                const AlongChannel& along, std::optional<std::size_t> knots,
                                const Linearised& fit) {
  const std::string& port = along.port->port;
  const double whole = fit.residual.squaredNorm();
  const double line = along.line;
  std::vector<Curved> found;
  if (knots) {
    found.push_back({fmt::format("{}[spline({},{})]", port, channel, knots_tried[*knots]), channel,
                     port, line + along.gains[*knots]});
  }
  const std::size_t most_cuts = channel == clock ? 1 : most_thresholds;
  const Levels levels =
      LevelFinder(along.sums, bins).find(0.5 * telling * (1.0 - line) * whole, most_cuts);
  const double gain = levels.explained / whole - line;
  const auto steps = static_cast<double>(levels.cuts.size());
  if (levels.cuts.empty() || !tells(along, gain, 2.0 * steps, fit)) return found;
  if (channel == clock) {  // whose row is scanned
    found.push_back({fmt::format("{}[step(time)]", port), channel, port, line + gain});
    return found;
  }
  found.push_back({fmt::format("{}[levels({},{})]", port, channel, name_levels(levels, bins)),
                   channel, port, line + gain});
  const double best = std::max(found.front().taken, line + gain);
  std::erase_if(found, [&](const Curved& one) { return one.taken < close * best; });
  return found;
}

/// The most telling first, of one channel a few ports, those that come near its best.
std::vector<std::string> keep_telling(std::vector<Curved> found) {
  std::ranges::stable_sort(found, std::ranges::greater{}, &Curved::taken);
  std::map<std::string, std::set<std::string>> ports;  // of each channel
  std::vector<std::string> names;
  for (const Curved& curve : found) {
    if (names.size() == most_curved) break;
    const auto best = std::ranges::find(found, curve.channel, &Curved::channel);
    if (curve.taken < close * best->taken) continue;
    std::set<std::string>& of_channel = ports[curve.channel];
    if (of_channel.size() == most_ports && !of_channel.contains(curve.port)) continue;
    of_channel.insert(curve.port);
    names.push_back(curve.name);
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
    std::vector<AlongChannel> ports;
    for (const PortColumns& port : fit.ports) ports.push_back(scan(*bins, port, fit));
    const std::optional<std::size_t> knots = choose_knots(ports, fit);
    for (const AlongChannel& port : ports) {
      std::ranges::move(find_curves(channels[i], *bins, port, knots, fit),
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
