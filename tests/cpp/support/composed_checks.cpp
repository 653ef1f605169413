// SPDX-License-Identifier: BSD-3-Clause
#include "composed_checks.hpp"

#include <doctest/doctest.h>

#include "dense_reference.hpp"
#include "sepcal/check_model.hpp"

namespace sepcal::test {

Record five_hole_record() {
  Record record = sample(five_hole_signals(), uneven_times(60, 0.2));
  return record.cut({{"first", 0, 35}, {"second", 35, 60}});
}

Record magnetometer_record() {
  Record record = sample(magnetometer_signals(), uneven_times(60, 0.2));
  return record.cut({{"first", 0, 35}, {"second", 35, 60}});
}

void check_tangent(const BlockModel& model, Record record, const NamedValues& values,
                   double tolerance) {
  const Tables& tables = model.tables();
  const Eigen::VectorXd xi1 = in_order(tables.linear, values);
  const Eigen::VectorXd xi2 = in_order(tables.nonlinear, values);
  Draws draws(900);
  add_outputs(record, model, xi1, xi2, Eigen::VectorXd::Zero(tables.n_z()), draws);
  const Eigen::MatrixXd rows = tangent_rows(model, record, values);
  const Eigen::MatrixXd expected = dense_rows(model, record, xi1, xi2);
  for (Eigen::Index k = 0; k < xi2.size(); ++k) {
    CAPTURE(tables.nonlinear[static_cast<std::size_t>(k)].name);
    const Eigen::VectorXd numeric = expected.col(xi1.size() + k);
    const double scale = numeric.cwiseAbs().maxCoeff();
    CHECK(scale > 0.0);  // nothing is shown by a parameter without an effect
    const double difference = (rows.col(xi1.size() + k) - numeric).cwiseAbs().maxCoeff();
    CHECK(difference < tolerance * scale);
  }
  CHECK_NOTHROW(check_model(model, record));
}

void check_input_tangent(const BlockModel& model, const Record& record, const NamedValues& values) {
  for (int i = 0; i < model.tables().n_u(); ++i) {
    CAPTURE(model.tables().inputs[static_cast<std::size_t>(i)].name);
    const InputTangents both =
        input_tangents(model, record, in_order(model.tables().linear, values),
                       in_order(model.tables().nonlinear, values), {i});
    const double difference = (both.given - both.numeric).cwiseAbs().maxCoeff();
    CHECK(difference < 1e-8 * (1.0 + both.numeric.cwiseAbs().maxCoeff()));
  }
}

Eigen::VectorXd predict(const BlockModel& model, const Record& record, const NamedValues& values) {
  return dense_prediction(model, record, in_order(model.tables().linear, values),
                          in_order(model.tables().nonlinear, values));
}

Record with_column(const Record& record, const std::string& name,
                   const std::vector<double>& column) {
  Record changed;
  for (const std::string& other : record.names()) {
    const auto values = record.column(other);
    if (other != name) changed.add(other, {values.begin(), values.end()});
  }
  return changed.add(name, column).cut(record.segments());
}

std::vector<std::string> names_of(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  for (const Variable& variable : variables) names.push_back(variable.name);
  return names;
}

}  // namespace sepcal::test
