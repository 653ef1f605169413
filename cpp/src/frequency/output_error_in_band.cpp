// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/frequency/output_error_in_band.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/short_number.hpp"
#include "frequency/band_errors.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace frequency;  // this room's own

namespace {

using base::short_number;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The median step of the rows [s]. Throws Error where they are not evenly spaced.
double step_of(const Record& record) {
  constexpr double most = 0.1;  // of a step
  std::vector<double> steps;
  for (const Segment& segment : record.segments()) {
    const auto time = time_of(record, segment);
    for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  }
  if (steps.empty()) throw Error("no segment has two rows");
  std::vector<double> sorted = steps;
  const double median = numerics::select_quantile(sorted, 0.5);
  for (const double step : steps) {
    if (std::abs(step - median) <= most * median) continue;
    throw Error("rows are " + short_number(median) + " s apart and once " + short_number(step) +
                " s; output error over a band needs even steps: fit it in time");
  }
  return median;
}

/// Phi, Gamma_0, Gamma_1, H, D of deviations from the operating point.
struct LinearStep {
  MatrixXd Phi, Gamma_0, Gamma_1, H, D;
};

/// A record's means, as pairs of rows: the first at them, then with each input's change in the
/// first and in the second row, up and down.
class OperatingPoint {
 public:
  /// `varying`: which of the model's inputs change along the record.
  OperatingPoint(const StateBlockModel& model, const Record& record,
                 std::vector<std::string> varying, double dt)
      : model_(model), varying_(std::move(varying)) {
    std::vector<double> times;
    for (std::size_t pair = 0; pair < pairs(); ++pair) {
      const double begins = 10.0 * dt * static_cast<double>(pair);
      times.insert(times.end(), {begins, begins + dt});
    }
    rows_.add("time", std::move(times));
    for (const std::string& name : record.names()) {
      if (name == "time") continue;
      const auto [mean, range] = spread_of(record, name);
      std::vector<double> values(2 * pairs(), mean);
      const auto at = std::find(varying_.begin(), varying_.end(), name);
      if (at != varying_.end()) {
        const auto input = static_cast<std::size_t>(at - varying_.begin());
        const double h = small * range;
        changes_.resize(varying_.size());
        changes_[input] = h;
        const std::size_t first = 2 * (1 + 4 * input);
        values[first] += h;
        values[first + 2] -= h;
        values[first + 5] += h;
        values[first + 7] -= h;
      }
      rows_.add(name, std::move(values));
    }
  }

  const std::vector<std::string>& varying() const { return varying_; }

  /// Mean and range over the segments' rows.
  static std::pair<double, double> spread_of(const Record& record, const std::string& name) {
    double sum = 0.0;
    double count = 0.0;
    double low = infinity;
    double high = -infinity;
    const auto column = record.column(name);
    for (const Segment& segment : record.segments()) {
      for (std::size_t row = segment.first; row < segment.last; ++row) {
        sum += column[row];
        ++count;
        low = std::min(low, column[row]);
        high = std::max(high, column[row]);
      }
    }
    return {sum / count, high - low};
  }

  LinearStep linearise(const VectorXd& xi) const {
    const auto steps = model_.steps(rows_, xi);
    const VectorXd x = steps->start(0);
    const StateSteps::Reading reading = steps->read(0, x);
    const auto n_u = static_cast<Index>(varying_.size());
    LinearStep linear{steps->advance(0, x).Phi, MatrixXd(x.size(), n_u), MatrixXd(x.size(), n_u),
                      reading.H, MatrixXd(reading.z.size(), n_u)};
    for (Index i = 0; i < n_u; ++i) {
      const std::size_t first = 2 * (1 + 4 * static_cast<std::size_t>(i));
      const double width = 2.0 * changes_[static_cast<std::size_t>(i)];
      linear.Gamma_0.col(i) = (steps->next(first, x) - steps->next(first + 2, x)) / width;
      linear.Gamma_1.col(i) = (steps->next(first + 4, x) - steps->next(first + 6, x)) / width;
      linear.D.col(i) = (steps->expect(first, x) - steps->expect(first + 2, x)) / width;
    }
    return linear;
  }

 private:
  static constexpr double small = 0.02;  // of an input's range

  std::size_t pairs() const { return 1 + 4 * varying_.size(); }

  const StateBlockModel& model_;
  std::vector<std::string> varying_;
  std::vector<double> changes_;
  Record rows_;
};

/// What is transformed once.
struct Spectra {
  Grid grid;
  MatrixXcd U;      // frequencies x varying inputs
  MatrixXcd Z;      // frequencies x outputs
  VectorXcd start;  // frequencies, w_0
  std::size_t segments = 0;
};

std::vector<std::string> varying_inputs(const StateBlockModel& model, const Record& record) {
  std::vector<std::string> varying;
  for (const Variable& input : model.tables().inputs) {
    if (input.name == "time" || !record.has(input.name)) continue;
    const auto [mean, range] = OperatingPoint::spread_of(record, input.name);
    if (range > 1e-9 * std::abs(mean)) varying.push_back(input.name);
  }
  return varying;
}

MatrixXd gather(const Record& record, const Segment& segment,
                const std::vector<std::string>& names) {
  MatrixXd values(static_cast<Index>(segment.rows()), static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto column = record.column(names[i]).subspan(segment.first, segment.rows());
    const Eigen::Map<const VectorXd> all(column.data(), values.rows());
    values.col(static_cast<Index>(i)) = all.array() - all.mean();
  }
  return values;
}

/// At multiples of one over each segment's length.
Spectra transform(const StateBlockModel& model, const Record& record, const Band& band, double dt,
                  const std::vector<std::string>& inputs) {
  std::vector<std::string> names = inputs;
  for (const Variable& output : model.tables().outputs) names.push_back(output.name);
  Spectra spectra;
  std::vector<MatrixXcd> parts;
  std::vector<VectorXcd> starts;
  std::vector<double> lasting;
  for (const Segment& segment : record.segments()) {
    lasting.push_back(dt * static_cast<double>(segment.rows()));
  }
  const auto of_segments = frequencies_of(band, lasting);
  for (std::size_t s = 0; s < lasting.size(); ++s) {
    const std::vector<double>& frequencies = of_segments[s];
    if (frequencies.empty()) continue;  // too short for the band
    const Segment& segment = record.segments()[s];
    const auto time = time_of(record, segment);
    parts.push_back(fourier_transform(gather(record, segment, names), time, frequencies));
    VectorXcd start(static_cast<Index>(frequencies.size()));
    const double before = 0.5 * (time.back() - time.front());
    const double scale = std::sqrt(2.0 / static_cast<double>(segment.rows()));
    for (std::size_t m = 0; m < frequencies.size(); ++m) {
      start[static_cast<Index>(m)] =
          scale * std::polar(1.0, 2.0 * std::numbers::pi * frequencies[m] * before);
    }
    starts.push_back(std::move(start));
    spectra.grid.add(frequencies, lasting[s]);
    ++spectra.segments;
  }
  const auto count = static_cast<Index>(spectra.grid.frequencies.size());
  const auto n_u = static_cast<Index>(inputs.size());
  spectra.U.resize(count, n_u);
  spectra.Z.resize(count, model.tables().n_z());
  spectra.start.resize(count);
  Index at = 0;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const Index rows = parts[s].rows();
    spectra.U.middleRows(at, rows) = parts[s].leftCols(n_u);
    spectra.Z.middleRows(at, rows) = parts[s].rightCols(spectra.Z.cols());
    spectra.start.segment(at, rows) = starts[s];
    at += rows;
  }
  return spectra;
}

/// Rows are the real parts of all frequencies, then the imaginary ones.
class BandModel final : public BlockModel {
 public:
  BandModel(const StateBlockModel& model, const OperatingPoint& point, const Spectra& spectra,
            double dt)
      : BlockModel(tables_of(model, spectra.segments)),
        point_(point),
        spectra_(spectra),
        dt_(dt),
        columns_(columns_of(model)),
        n_(static_cast<Index>(model.tables().parameters().size())) {}

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* /*carry*/,
                Eigen::Ref<MatrixXd> rows) const override {
    const Eigen::Map<const VectorXd> theta(xi2, tables().n_2());
    put(respond(theta), block, 0, rows);  // [A | b], b in the place of the first of D
    if (xi1 == nullptr) return;
    const Index n_1 = tables().n_1();
    rows.col(rows.cols() - 1) = VectorXd(rows.col(n_1));
    const Eigen::Map<const VectorXd> ends(xi1, n_1);
    for (Index k = 0; k < theta.size(); ++k) {
      rows.col(n_1 + k) = stack(slope(theta, ends, k), block);
    }
  }

  /// By all parameters, and what the model says: of each output frequencies x (n_1 + n_2 + 1).
  std::vector<MatrixXcd> tangents(const VectorXd& xi1, const VectorXd& xi2) const {
    const std::vector<MatrixXcd> at = respond(xi2);
    std::vector<MatrixXcd> slopes;
    for (Index k = 0; k < xi2.size(); ++k) slopes.push_back(slope(xi2, xi1, k));
    std::vector<MatrixXcd> tangents;
    for (std::size_t j = 0; j < at.size(); ++j) {
      MatrixXcd one(at[j].rows(), xi1.size() + xi2.size() + 1);
      one.leftCols(xi1.size()) = at[j].leftCols(xi1.size());
      for (Index k = 0; k < xi2.size(); ++k) {
        one.col(xi1.size() + k) = slopes[static_cast<std::size_t>(k)].col(static_cast<Index>(j));
      }
      one.rightCols<1>() = at[j].leftCols(xi1.size()) * xi1 + at[j].rightCols<1>();
      tangents.push_back(std::move(one));
    }
    return tangents;
  }

 private:
  /// Of the model's parameters those that move its states, among all of them.
  static std::vector<Index> columns_of(const StateBlockModel& model) {
    std::vector<Index> columns;
    const auto own = static_cast<int>(model.plan().linear().size());
    for (const int column : model.plan().acting_columns()) {
      if (column >= own) columns.push_back(column);
    }
    return columns;
  }

  static Tables tables_of(const StateBlockModel& model, std::size_t segments) {
    Tables tables{{Variable("frequency", "Hz")}, model.tables().outputs, {}, {}};
    const TrajectoryPlan& plan = model.plan();
    for (std::size_t s = 0; s < segments; ++s) {
      for (const int state : plan.integrated()) {
        const Variable& of = plan.model().states[static_cast<std::size_t>(state)];
        const std::string number = segments > 1 ? "[" + std::to_string(s + 1) + "]" : "";
        tables.linear.emplace_back(of.name + "_end" + number, of.unit);
      }
    }
    const std::vector<Variable> all = model.tables().parameters();
    for (const Index column : columns_of(model)) {
      tables.nonlinear.push_back(all[static_cast<std::size_t>(column)]);
    }
    return tables;
  }

  /// Of each output frequencies x (n_1 + 1): [A | b].
  std::vector<MatrixXcd> respond(const VectorXd& theta) const {
    VectorXd xi = VectorXd::Zero(n_);
    for (Index k = 0; k < theta.size(); ++k) xi[columns_[static_cast<std::size_t>(k)]] = theta[k];
    const LinearStep step = point_.linearise(xi);
    const Index n_x = step.Phi.rows();
    const Index count = spectra_.Z.rows();
    std::vector<MatrixXcd> found(static_cast<std::size_t>(spectra_.Z.cols()),
                                 MatrixXcd::Zero(count, tables().n_1() + 1));
    for (Index m = 0; m < count; ++m) {
      const auto at = static_cast<std::size_t>(m);
      const Complex z =
          std::polar(1.0, 2.0 * std::numbers::pi * spectra_.grid.frequencies[at] * dt_);
      const MatrixXcd pulls = z * MatrixXcd::Identity(n_x, n_x) - step.Phi;
      MatrixXcd right(n_x, n_x + 1);
      right.leftCols(n_x) = z * spectra_.start[m] * MatrixXcd::Identity(n_x, n_x);
      const VectorXcd u = spectra_.U.row(m).transpose();
      right.col(n_x) = step.Gamma_0 * u + z * (step.Gamma_1 * u);
      MatrixXcd y = step.H * pulls.partialPivLu().solve(right);
      y.col(n_x) += step.D * u;
      const auto first = static_cast<Index>(spectra_.grid.segment[at]) * n_x;
      for (std::size_t j = 0; j < found.size(); ++j) {
        found[j].row(m).segment(first, n_x) = y.row(static_cast<Index>(j)).head(n_x);
        found[j](m, found[j].cols() - 1) = y(static_cast<Index>(j), n_x);
      }
    }
    return found;
  }

  /// d(A xi1 + b) / d theta_k, frequencies x outputs.
  MatrixXcd slope(const VectorXd& theta, const VectorXd& ends, Index k) const {
    const double h = 1e-4 * std::max(1.0, std::abs(theta[k]));
    VectorXd up = theta;
    VectorXd down = theta;
    up[k] += h;
    down[k] -= h;
    const std::vector<MatrixXcd> high = respond(up);
    const std::vector<MatrixXcd> low = respond(down);
    MatrixXcd slope(spectra_.Z.rows(), spectra_.Z.cols());
    for (std::size_t j = 0; j < high.size(); ++j) {
      const MatrixXcd change = (high[j] - low[j]) / (2.0 * h);
      slope.col(static_cast<Index>(j)) =
          change.leftCols(ends.size()) * ends + change.rightCols<1>();
    }
    return slope;
  }

  double part(const Complex& value, Index row) const {
    return row < spectra_.Z.rows() ? value.real() : value.imag();
  }

  void put(const std::vector<MatrixXcd>& found, const Block& block, Index column,
           Eigen::Ref<MatrixXd> rows) const {
    const auto n = static_cast<Index>(block.rows);
    const Index count = spectra_.Z.rows();
    for (std::size_t j = 0; j < found.size(); ++j) {
      for (Index i = 0; i < n; ++i) {
        const Index row = static_cast<Index>(block.first) + i;
        for (Index k = 0; k < found[j].cols(); ++k) {
          rows(static_cast<Index>(j) * n + i, column + k) = part(found[j](row % count, k), row);
        }
      }
    }
  }

  VectorXd stack(const MatrixXcd& by_output, const Block& block) const {
    const auto n = static_cast<Index>(block.rows);
    VectorXd values(n * by_output.cols());
    for (Index j = 0; j < by_output.cols(); ++j) {
      for (Index i = 0; i < n; ++i) {
        const Index row = static_cast<Index>(block.first) + i;
        values[j * n + i] = part(by_output(row % by_output.rows(), j), row);
      }
    }
    return values;
  }

  const OperatingPoint& point_;
  const Spectra& spectra_;
  double dt_;
  std::vector<Index> columns_;
  Index n_;
};

Record record_of(const Tables& tables, const Spectra& spectra) {
  Record record;
  std::vector<double> frequencies = spectra.grid.frequencies;
  frequencies.insert(frequencies.end(), spectra.grid.frequencies.begin(),
                     spectra.grid.frequencies.end());
  record.add("frequency", std::move(frequencies));
  for (Index j = 0; j < tables.n_z(); ++j) {
    std::vector<double> parts;
    for (const Complex& value : spectra.Z.col(j)) parts.push_back(value.real());
    for (const Complex& value : spectra.Z.col(j)) parts.push_back(value.imag());
    record.add(tables.outputs[static_cast<std::size_t>(j)].name, std::move(parts));
  }
  return record;
}

/// Those that the band's model doesn't have leave.
FitOptions options_of(const Tables& tables, FitOptions options) {
  const std::vector<Variable> all = tables.parameters();
  const auto clear = [&](auto& by_name) {
    std::erase_if(by_name, [&](const auto& entry) {
      return std::find_if(all.begin(), all.end(), [&](const Variable& each) {
               return each.name == entry.first;
             }) == all.end();
    });
  };
  clear(options.fix);
  clear(options.start);
  clear(options.unsampled);
  options.process_noise.clear();
  options.stage_one_segments.clear();
  options.stage_two_segments.clear();
  options.coloured_errors = false;  // of rows in time; put_band_errors() has them
  // Differences leave more in R than rounding does.
  options.noise_tolerance = std::max(options.noise_tolerance, 1e-6);
  return options;
}

}  // namespace

Fit fit_output_error_in_band(const StateBlockModel& model, const Record& all, const Band& band,
                             const FitOptions& asked) {
  check_band(band);
  if (band.spacing > 0.0) {
    throw Error(
        "output error over a band has frequencies one over a segment's length apart; "
        "leave the spacing out");
  }
  if (!all.has("time")) throw Error("column 'time' is missing, which a band of Hz needs");
  if (asked.loss != Loss::squares) {
    throw Error(
        "over a band residuals are sums over all rows, of which no one is an outlier; "
        "leave the loss out, or fit in time");
  }
  const Record record = all.select(asked.stage_two_segments);
  const double dt = step_of(record);
  const OperatingPoint point(model, record, varying_inputs(model, record), dt);
  const Spectra spectra = transform(model, record, band, dt, point.varying());
  const BandModel over(model, point, spectra, dt);
  Fit found = fit(over, record_of(over.tables(), spectra), options_of(over.tables(), asked));
  const std::vector<MatrixXcd> at = over.tangents(found.xi1(), found.xi2());
  std::vector<BandTangent> tangents;
  for (std::size_t j = 0; j < at.size(); ++j) {
    const Index n = at[j].cols() - 1;
    tangents.push_back({at[j].leftCols(n), VectorXd::Zero(n),
                        spectra.Z.col(static_cast<Index>(j)) - at[j].col(n)});
  }
  put_band_errors(tangents, spectra.grid, asked, found);
  found.rows = record.rows();
  return found;
}

}  // namespace sepcal
