// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/residual_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "effects/named_driver.hpp"
#include "estimation/residual_colour.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/residual_curves.hpp"
#include "sepcal/detail/natural_spline.hpp"

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index fewest_rows = 20;

struct Channel {
  std::string name;
  VectorXd values;  // a row each, about their mean
  std::vector<double> knots;
  double mean = 0.0;
};

/// The channel's rows within the segments; none where it is constant or not finite.
std::optional<Channel> read_channel(const Record& record, const std::string& name) {
  const VectorXd values = gather_rows(record.column(name), record.segments());
  if (!values.allFinite()) return std::nullopt;
  const double lowest = values.minCoeff();
  const double highest = values.maxCoeff();
  constexpr double rounding = 1e-9;  // of the largest value
  if (!(highest - lowest > rounding * std::max(std::abs(lowest), std::abs(highest)))) {
    return std::nullopt;
  }
  const double mean = values.mean();
  return Channel{name, values.array() - mean, even_knots(lowest, highest, numerics::smooth_knots),
                 mean};
}

std::vector<Channel> read_channels(const Record& record, const Tables& tables) {
  std::vector<Channel> channels;
  for (const std::string& name : record.names()) {
    if (name == "maneuver") continue;
    if (std::ranges::find(tables.outputs, name, &Variable::name) != tables.outputs.end()) continue;
    if (std::optional<Channel> channel = read_channel(record, name)) {
      channels.push_back(std::move(*channel));
    }
  }
  return channels;
}

/// Shares of each column of r (rows x n_z, about their means) that the spline explains.
VectorXd smooth_shares(const Channel& channel, const MatrixXd& r) {
  MatrixXd basis =
      numerics::spline_columns(SplineBasis(channel.knots), channel.values.array() + channel.mean);
  basis.rowwise() -= basis.colwise().mean().eval();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(basis);  // knots may have no rows between them
  const MatrixXd explained = qr.householderQ().adjoint() * r;
  return explained.topRows(qr.rank()).colwise().squaredNorm().transpose().cwiseQuotient(
      r.colwise().squaredNorm().transpose());
}

/// Quantities that a probe keeps beside its model's inputs have their unit by name.
std::string unit_of_slope(const Variable& output, const Tables& tables, const std::string& name) {
  static const std::map<std::string_view, std::string_view> kept{
      {"roll", "rad"},  {"pitch", "rad"}, {"yaw", "rad"},    {"vn", "m/s"}, {"ve", "m/s"},
      {"vd", "m/s"},    {"u", "m/s"},     {"v", "m/s"},      {"w", "m/s"},  {"phi", "rad"},
      {"theta", "rad"}, {"psi", "rad"},   {"rho", "kg/m^3"}, {"ps", "Pa"},  {"dp", "Pa"},
      {"bn", "uT"},     {"be", "uT"},     {"bd", "uT"},      {"mx", "uT"},  {"my", "uT"},
      {"mz", "uT"},     {"hx", "uT"},     {"hy", "uT"},      {"hz", "uT"},  {"temperature", "K"}};
  const auto input = std::ranges::find(tables.inputs, name, &Variable::name);
  if (input != tables.inputs.end()) {
    return input->unit.empty() ? output.unit : fmt::format("{} per {}", output.unit, input->unit);
  }
  const auto own = kept.find(name);
  if (own != kept.end()) return fmt::format("{} per {}", output.unit, own->second);
  return effects::coefficient_unit(
      output.unit,
      {.text = name, .port = {}, .base = name, .shape = EffectName::Shape::power, .number = 1});
}

/// x' Sigma x of each column of X (rows x channels), Sigma the covariance of a residual's noise.
VectorXd spread_of(const MatrixXd& X, const VectorXd& residual, const std::vector<Segment>& runs) {
  const NoiseModel noise =
      estimation::find_residual_noise({residual.data(), static_cast<std::size_t>(residual.size())},
                                      runs)
          .value_or(NoiseModel{.sigma = residual.norm() /
                                        std::sqrt(static_cast<double>(residual.size()))});
  return covariance_product(noise, runs, X).diagonal();
}

}  // namespace

std::vector<ChannelMisfit> compare_channels(const Record& record, const Tables& tables,
                                            const std::vector<std::string>& names,
                                            const MatrixXd& residuals, base::ThreadPool& pool) {
  if (residuals.rows() < fewest_rows) return {};
  const std::vector<Channel> channels = read_channels(record, tables);
  const std::vector<Segment> runs = find_runs(record);
  const MatrixXd r = residuals.rowwise() - residuals.colwise().mean();
  const auto outputs = static_cast<std::size_t>(r.cols());
  MatrixXd X(r.rows(), static_cast<Index>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    X.col(static_cast<Index>(c)) = channels[c].values;
  }
  MatrixXd shares(r.cols(), static_cast<Index>(channels.size()));
  MatrixXd spreads(static_cast<Index>(channels.size()), r.cols());
  pool.for_each(channels.size() + outputs, [&](std::size_t task) {
    if (task < channels.size()) {
      shares.col(static_cast<Index>(task)) = smooth_shares(channels[task], r);
    } else {
      const auto j = static_cast<Index>(task - channels.size());
      spreads.col(j) = spread_of(X, r.col(j), runs);
    }
  });
  std::vector<ChannelMisfit> result;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const VectorXd& x = channels[c].values;
    const double square = x.squaredNorm();
    for (std::size_t j = 0; j < outputs; ++j) {
      const auto column = static_cast<Index>(j);
      const auto row = static_cast<Index>(c);
      const double variance = r.col(column).squaredNorm();
      if (!(variance > 0.0)) continue;
      const double product = x.dot(r.col(column));
      const double line = std::min(1.0, product * product / (square * variance));
      result.push_back(
          {.driver = channels[c].name,
           .output = names[j],
           .share_line = line,
           .share_smooth = std::clamp(shares(column, row), line, 1.0),
           .slope = product / square,
           .slope_error = std::sqrt(spreads(row, column)) / square,
           .unit = unit_of_slope(*std::ranges::find(tables.outputs, names[j], &Variable::name),
                                 tables, channels[c].name)});
    }
  }
  std::ranges::stable_sort(result, std::ranges::greater{}, &ChannelMisfit::share_smooth);
  return result;
}

}  // namespace sepcal::verbs
