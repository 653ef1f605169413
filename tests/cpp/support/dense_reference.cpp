// SPDX-License-Identifier: BSD-3-Clause
#include "dense_reference.hpp"

#include "block_inputs.hpp"

namespace sepcal::test {

Eigen::MatrixXd dense_values(const BlockModel& model, const Record& record,
                             const Eigen::VectorXd& xi2) {
  const Eigen::Index n_z = model.tables().n_z();
  const auto total = static_cast<Eigen::Index>(record.rows());
  Eigen::MatrixXd all(n_z * total, model.tables().n_1() + 1);
  Eigen::Index offset = 0;
  for (const Segment& segment : record.segments()) {
    const BlockInputs inputs = block_inputs(model, record, segment.first);
    const auto rows = static_cast<Eigen::Index>(segment.rows());
    Eigen::MatrixXd part(n_z * rows, all.cols());
    const auto carry = model.new_carry();
    model.evaluate({inputs.pointers, segment.rows(), segment.first, true}, xi2.data(), nullptr,
                   carry.get(), part);
    for (Eigen::Index j = 0; j < n_z; ++j) {
      all.middleRows(j * total + offset, rows) = part.middleRows(j * rows, rows);
    }
    offset += rows;
  }
  return all;
}

Eigen::VectorXd dense_outputs(const BlockModel& model, const Record& record) {
  std::vector<double> z;
  for (const Variable& output : model.tables().outputs) {
    for (const Segment& segment : record.segments()) {
      const auto column = record.column(output.name).subspan(segment.first, segment.rows());
      z.insert(z.end(), column.begin(), column.end());
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()));
}

Eigen::VectorXd dense_prediction(const BlockModel& model, const Record& record,
                                 const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2) {
  const Eigen::MatrixXd values = dense_values(model, record, xi2);
  return values.leftCols(xi1.size()) * xi1 + values.rightCols<1>();
}

Eigen::MatrixXd dense_rows(const BlockModel& model, const Record& record,
                           const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2) {
  const Eigen::Index n_1 = xi1.size();
  const Eigen::Index n_2 = xi2.size();
  const Eigen::MatrixXd values = dense_values(model, record, xi2);
  Eigen::MatrixXd rows(values.rows(), n_1 + n_2 + 1);
  rows.leftCols(n_1) = values.leftCols(n_1);
  for (Eigen::Index k = 0; k < n_2; ++k) {
    const auto slope = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd above = xi2;
      Eigen::VectorXd below = xi2;
      above[k] += step;
      below[k] -= step;
      return (dense_prediction(model, record, xi1, above) -
              dense_prediction(model, record, xi1, below)) /
             (above[k] - below[k]);
    };
    constexpr double step = 4e-4;
    rows.col(n_1 + k) = (4.0 * slope(0.5 * step) - slope(step)) / 3.0;
  }
  rows.col(n_1 + n_2) = dense_outputs(model, record) - values.leftCols(n_1) * xi1 - values.col(n_1);
  return rows;
}

InputTangents input_tangents(const BlockModel& model, const Record& record,
                             const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                             const std::vector<int>& inputs) {
  const std::size_t rows = record.length();
  BlockInputs columns = block_inputs(model, record);
  const auto predict = [&] {
    Eigen::MatrixXd values(model.tables().n_z() * static_cast<Eigen::Index>(rows), xi1.size() + 1);
    model.evaluate({columns.pointers, rows, 0, true}, values_of(xi2), nullptr, nullptr, values);
    return Eigen::VectorXd(values.leftCols(xi1.size()) * xi1 + values.rightCols<1>());
  };
  const auto count = static_cast<Eigen::Index>(inputs.size());
  InputTangents result{predict().replicate(1, count), predict().replicate(1, count)};
  model.input_tangent({columns.pointers, rows, 0, true}, values_of(xi2), values_of(xi1), inputs,
                      result.given);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double*& pointer =
        columns.pointers[static_cast<std::size_t>(inputs[static_cast<std::size_t>(k)])];
    const Eigen::Map<const Eigen::VectorXd> logged(pointer, static_cast<Eigen::Index>(rows));
    const double step = 3e-6 * (1.0 + logged.cwiseAbs().minCoeff());
    const auto slope = [&](double by) -> Eigen::VectorXd {
      const Eigen::VectorXd above = logged.array() + by;
      pointer = above.data();
      const Eigen::VectorXd predicted = predict();
      const Eigen::VectorXd below = logged.array() - by;
      pointer = below.data();
      return (predicted - predict()) / (2.0 * by);
    };
    result.numeric.col(k) = (4.0 * slope(0.5 * step) - slope(step)) / 3.0;
    pointer = logged.data();
  }
  return result;
}

Eigen::MatrixXd whiten(Eigen::MatrixXd rows, const Eigen::VectorXd& noise) {
  const Eigen::Index each = rows.rows() / noise.size();
  for (Eigen::Index j = 0; j < noise.size(); ++j) rows.middleRows(j * each, each) /= noise[j];
  return rows;
}

}  // namespace sepcal::test
