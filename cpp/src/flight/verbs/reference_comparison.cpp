// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/reference_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/gaps.hpp"
#include "base/name_list.hpp"
#include "base/parts_of_record.hpp"
#include "estimation/residual_colour.hpp"
#include "flight/files/known_names.hpp"
#include "flight/files/units.hpp"
#include "sepcal/error.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using files::Unit;
using files::UnitKind;

constexpr std::size_t fewest_pairs = 10;

constexpr std::array kinds{UnitKind::angle,    UnitKind::rate,        UnitKind::length,
                           UnitKind::speed,    UnitKind::field,       UnitKind::force,
                           UnitKind::pressure, UnitKind::acceleration};

/// A column that apply gives, by the quantity that it is.
struct Calibrated {
  std::string quantity;
  const Unit* unit = nullptr;  // that used inside
  CorrectedColumn column;
  bool is_corrected = false;  // a reading that was corrected, not what a model says
};

/// "airspeed_cal_mps": the airspeed in m/s. Nothing for a column of another make.
std::optional<Calibrated> recognise_calibrated(const CorrectedColumn& column) {
  const std::size_t cut = column.header.rfind('_');
  if (cut == std::string::npos) return std::nullopt;
  for (const UnitKind kind : kinds) {
    const Unit* const unit =
        files::find_unit(kind, std::string_view(column.header).substr(cut + 1));
    if (unit == nullptr || !unit->is_inside()) continue;
    std::string quantity = column.header.substr(0, cut);
    for (const std::string_view made : {"_cal", "_model", "_fit"}) {
      if (!quantity.ends_with(made)) continue;
      quantity.resize(quantity.size() - made.size());
      return Calibrated{std::move(quantity), unit, column, made == "_cal"};
    }
    return std::nullopt;
  }
  return std::nullopt;
}

/// Those that can be set against a reference, one a quantity; with a field's strength.
std::vector<Calibrated> recognise_calibrated(const std::vector<CorrectedColumn>& columns) {
  std::vector<Calibrated> found;
  for (const CorrectedColumn& column : columns) {
    std::optional<Calibrated> one = recognise_calibrated(column);
    if (!one) continue;
    const auto there = std::ranges::find(found, one->quantity, &Calibrated::quantity);
    if (there == found.end()) {
      found.push_back(std::move(*one));
    } else if (one->is_corrected) {
      *there = std::move(*one);
    }
  }
  std::vector<double> strength;
  int axes = 0;
  for (const char* const axis : {"mx", "my", "mz"}) {
    const auto one = std::ranges::find(found, axis, &Calibrated::quantity);
    if (one == found.end()) continue;
    ++axes;
    strength.resize(one->column.values.size(), 0.0);
    std::ranges::transform(strength, one->column.values, strength.begin(),
                           [](double sum, double value) { return std::hypot(sum, value); });
  }
  if (axes == 3) {
    found.push_back({"field",
                     files::find_unit(UnitKind::field, "ut"),
                     {"field_cal_ut", std::move(strength)},
                     true});
  }
  return found;
}

/// What is compared with what, in which unit the latter is logged.
struct Pair {
  const Calibrated* calibrated = nullptr;
  const Unit* unit = nullptr;
};

std::vector<std::string> quantities_of(const std::vector<Calibrated>& calibrated) {
  std::vector<std::string> names;
  for (const Calibrated& one : calibrated) names.push_back(one.quantity);
  return names;
}

/// How far words are from the name of a quantity: 0 of its own name, 1 where it is among other
/// words, 2 where nothing but its unit speaks for it.
int distance_of(std::string_view quantity, files::Words words) {
  if (files::rank_name(quantity, words)) return 0;
  for (std::size_t first = 0; first < words.size(); ++first) {
    for (std::size_t count = 1; first + count <= words.size(); ++count) {
      const files::Words part = words.subspan(first, count);
      if (files::join_words(part) == quantity) return 1;
      if (quantity.size() > 1 && files::rank_name(quantity, part, false)) return 1;
    }
  }
  return 2;
}

/// What a header says by its unit and its name. Throws Error where that is nothing, or not one
/// thing; `column` is what the log calls it.
Pair find_pair(const std::string& header, const std::string& column,
               const std::vector<Calibrated>& calibrated, const std::string& flight) {
  const std::vector<std::string> words = files::split_words(header);
  std::vector<Pair> nearest;
  int least = 3;
  bool has_unit = false;
  for (const Calibrated& one : calibrated) {
    for (const Unit& unit : files::known_units(one.unit->kind)) {
      for (std::size_t cut = 1; cut < words.size(); ++cut) {
        if (!files::spell_unit(files::Words(words).subspan(cut), unit)) continue;
        has_unit = true;
        const int distance = distance_of(one.quantity, files::Words(words).first(cut));
        if (distance > least) continue;
        if (distance < least) nearest.clear();
        least = distance;
        if (!nearest.empty() && nearest.back().unit == &unit && nearest.back().calibrated == &one) {
          continue;
        }
        nearest.push_back({&one, &unit});
      }
    }
  }
  if (nearest.size() == 1) return nearest.front();
  const Calibrated& example = calibrated.front();
  const std::string way_out =
      fmt::format("say what it is, as in {}_{}={}; calibrated here: {}", example.quantity,
                  example.unit->suffix, column, base::list_names(quantities_of(calibrated)));
  throw Error(fmt::format("{}: reference '{}' {}; {}", flight, column,
                          has_unit ? "may be of several quantities"
                                   : "is in no unit of what is calibrated, by its name",
                          way_out));
}

/// The log's column of that name; nothing where there is none.
const Flight::Column* find_column(const ReferenceLog& log, std::string_view name) {
  for (const Flight* const flight : {&log.given, &log.read}) {
    for (const Flight::Column& column : flight->columns()) {
      if (column.header == name || column.logged_header() == name) return &column;
    }
  }
  return nullptr;
}

const Flight::Column& column_of(const ReferenceLog& log, const std::string& name) {
  if (const Flight::Column* const column = find_column(log, name)) return *column;
  std::vector<std::string> there;
  for (const Flight::Column& column : log.given.columns()) there.push_back(column.logged_header());
  constexpr std::size_t slips = 2;
  constexpr std::size_t most = 12;
  throw Error(fmt::format("{}: there is no column '{}' to compare with{}; it has: {}",
                          log.given.name(), name, base::ask_for_similar(name, there, slips),
                          base::list_first(there, most)));
}

/// Cut where time has a gap or runs back.
std::vector<Segment> runs_of(const VectorXd& time) {
  std::vector<double> intervals;
  for (Index i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) intervals.push_back(time[i] - time[i - 1]);
  }
  const double gap = base::find_gap(std::move(intervals));
  std::vector<Segment> runs{{"", 0, 1}};
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    const auto row = static_cast<std::size_t>(i);
    if (!(interval > 0.0 && interval <= gap)) runs.push_back({"", row, row});
    runs.back().last = row + 1;
  }
  return runs;
}

/// Of the coefficients of columns X that left the residual, whatever the colour of that.
MatrixXd covariance_of(const MatrixXd& X, const VectorXd& residual,
                       const std::vector<Segment>& runs) {
  const MatrixXd inverse = (X.transpose() * X).inverse();
  const NoiseModel noise =
      estimation::find_residual_noise({residual.data(), static_cast<std::size_t>(residual.size())},
                                      runs)
          .value_or(NoiseModel{.sigma = residual.norm() /
                                        std::sqrt(static_cast<double>(residual.size()))});
  return inverse * covariance_product(noise, runs, X) * inverse;
}

double lag_one_of(const VectorXd& about_mean, const std::vector<Segment>& runs) {
  double product = 0.0;
  for (const Segment& run : runs) {
    const auto n = static_cast<Index>(run.rows());
    const auto part = about_mean.segment(static_cast<Index>(run.first), n);
    product += part.head(n - 1).dot(part.tail(n - 1));
  }
  const double square = about_mean.squaredNorm();
  return square > 0.0 ? product / square : not_a_number;
}

/// The line through both, each way.
void regress(ReferenceMisfit& misfit, const std::vector<Segment>& runs) {
  const VectorXd& x = misfit.against;
  const double mean = x.mean();
  MatrixXd X(x.size(), 2);
  X.col(0).setOnes();
  X.col(1) = x.array() - mean;
  constexpr double rounding = 1e-9;  // of the reference's size: it doesn't move
  if (!(X.col(1).cwiseAbs().maxCoeff() > rounding * x.cwiseAbs().maxCoeff())) return;
  const VectorXd y = x + misfit.difference;
  const VectorXd y_about = y.array() - y.mean();
  const double product = X.col(1).dot(y_about);
  misfit.scale = product / X.col(1).squaredNorm();
  misfit.offset = y.mean() - misfit.scale * mean;
  misfit.scale_reversed = product == 0.0 ? not_a_number : y_about.squaredNorm() / product;
  const MatrixXd C = covariance_of(X, y_about - misfit.scale * X.col(1), runs);
  misfit.scale_error = std::sqrt(C(1, 1));
  misfit.offset_error = std::sqrt(C(0, 0) - 2.0 * mean * C(0, 1) + mean * mean * C(1, 1));
}

std::string unit_text(const Unit& unit) {
  constexpr std::array spelled{std::pair{"mps", "m/s"},     std::pair{"mps2", "m/s^2"},
                               std::pair{"radps", "rad/s"}, std::pair{"ut", "uT"},
                               std::pair{"pa", "Pa"},       std::pair{"n", "N"}};
  for (const auto& [suffix, text] : spelled) {
    if (unit.suffix == suffix) return text;
  }
  return std::string(unit.suffix);
}

ReferenceMisfit compare_pair(const Pair& pair, const Flight::Column& reference,
                             const ReferenceLog& log, const ComparedRows& rows) {
  const std::vector<double> time = base::gather_time(rows.record);
  std::vector<double> times;
  std::vector<double> differences;
  std::vector<double> against;
  std::size_t k = 0;
  for (const Segment& segment : rows.record.segments()) {
    for (std::size_t at = segment.first; at < segment.last; ++at, ++k) {
      const std::size_t row = rows.flight_rows[at];
      const double other = pair.unit->convert(reference.values[row]);
      double difference = pair.calibrated->column.values[row] - other;
      if (!std::isfinite(difference)) continue;
      if (pair.unit->kind == UnitKind::angle) {
        difference = std::remainder(difference, 2.0 * std::numbers::pi);
      }
      times.push_back(time[k]);
      differences.push_back(difference);
      against.push_back(other);
    }
  }
  if (differences.size() < fewest_pairs) {
    throw Error(fmt::format(
        "{}: reference '{}' has a number in {} of the {} rows compared; give "
        "one that has {} or more",
        log.given.name(), reference.logged_header(), differences.size(), k, fewest_pairs));
  }
  const auto vector_of = [](const std::vector<double>& values) -> VectorXd {
    return VectorXd::Map(values.data(), static_cast<Index>(values.size()));
  };
  ReferenceMisfit misfit{.quantity = pair.calibrated->quantity,
                         .unit = unit_text(*pair.calibrated->unit),
                         .calibrated = pair.calibrated->column.header,
                         .reference = reference.logged_header(),
                         .rows = differences.size(),
                         .time = vector_of(times),
                         .difference = vector_of(differences),
                         .against = vector_of(against)};
  const auto n = static_cast<double>(misfit.rows);
  const VectorXd& d = misfit.difference;
  misfit.bias = d.mean();
  misfit.rms = d.norm() / std::sqrt(n);
  const VectorXd about_mean = d.array() - misfit.bias;
  misfit.sd = about_mean.norm() / std::sqrt(n);
  const std::vector<Segment> runs = runs_of(misfit.time);
  misfit.lag_one = lag_one_of(about_mean, runs);
  misfit.bias_error = std::sqrt(covariance_of(MatrixXd::Ones(d.size(), 1), about_mean, runs)(0, 0));
  regress(misfit, runs);
  return misfit;
}

}  // namespace

std::vector<ReferenceMisfit> compare_references(const std::vector<std::string>& asked,
                                                const std::vector<CorrectedColumn>& columns,
                                                const ReferenceLog& log, const ComparedRows& rows) {
  const std::vector<Calibrated> calibrated = recognise_calibrated(columns);
  if (calibrated.empty()) {
    throw Error("nothing is calibrated here that a reference could be set against; leave it out");
  }
  std::vector<ReferenceMisfit> result;
  for (const std::string& one : asked) {
    // As it stands, where a column's own name has the mark.
    const std::size_t mark = find_column(log, one) == nullptr ? one.find('=') : std::string::npos;
    const std::string name = mark == std::string::npos ? one : one.substr(mark + 1);
    const std::string header = mark == std::string::npos ? one : one.substr(0, mark);
    const Flight::Column& column = column_of(log, name);
    result.push_back(
        compare_pair(find_pair(header, name, calibrated, log.given.name()), column, log, rows));
  }
  return result;
}

}  // namespace sepcal::verbs
