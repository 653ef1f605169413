// SPDX-License-Identifier: BSD-3-Clause
// h of m = C h + n with the effects: at once where they don't follow the field, else by Newton's
// steps, at most twenty.
#include <fmt/format.h>

#include <Eigen/LU>
#include <array>

#include "flight/export/bodies.hpp"

namespace sepcal::exporting {
namespace {

constexpr std::array axes{"x", "y", "z"};

std::vector<double> rows_of(const Eigen::Matrix3d& matrix) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) values.push_back(matrix(i, j));
  }
  return values;
}

/// What is left of the readings, in body axes, without n and the biases.
std::string unbiased(bool is_turned, const Correction& correction, const Dialect& dialect) {
  std::string text = "  double u[3];\n";
  for (std::size_t i = 0; i < 3; ++i) {
    std::string read = fmt::format("m_ut[{}]", i);
    if (is_turned) {
      read = fmt::format("{0}[{1}][0] * m_ut[0] + {0}[{1}][1] * m_ut[1] + {0}[{1}][2] * m_ut[2]",
                         dialect.constant("turn"), i);
    }
    text += fmt::format("  u[{0}] = {1} - ({2}[{0}]{3});\n", i, read, dialect.constant("n"),
                        correction.added(std::string("bias.") + axes[i]));
  }
  return text;
}

std::string at_once(bool is_turned, const Correction& correction, const Dialect& dialect) {
  std::string text = unbiased(is_turned, correction, dialect);
  for (int i = 0; i < 3; ++i) {
    text +=
        fmt::format("  h_ut[{0}] = {1}[{0}][0] * u[0] + {1}[{0}][1] * u[1] + {1}[{0}][2] * u[2];\n",
                    i, dialect.constant("inverse"));
  }
  return text;
}

/// Newton's steps, each solved by Cramer's rule.
std::string stepwise(bool is_turned, const Correction& correction, const Dialect& dialect) {
  std::string text = unbiased(is_turned, correction, dialect);
  text += "  double A[3][3];\n  int i;\n  int step;\n";
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::string on_diagonal =
          correction.added("scale.s") +
          correction.added(std::string("axis_scale.") + axes[static_cast<std::size_t>(i)]);
      text += fmt::format("  A[{0}][{1}] = {2}[{0}][{1}]{3};\n", i, j, dialect.constant("C"),
                          i == j ? on_diagonal : "");
    }
  }
  const std::string d = dialect.constant("cubic_d");
  const std::string c = dialect.constant("cubic_c");
  text += "  double y[3] = {0.0, 0.0, 0.0};\n  for (step = 0; step < 20; ++step) {\n";
  text += "    double J[3][3];\n    double F[3];\n    double largest = 0.0;\n";
  text += "    for (i = 0; i < 3; ++i) {\n";
  text += "      J[i][0] = A[i][0];\n      J[i][1] = A[i][1];\n      J[i][2] = A[i][2];\n";
  text += "      F[i] = u[i] - (A[i][0] * y[0] + A[i][1] * y[1] + A[i][2] * y[2]);\n";
  if (correction.is_cubic) {
    text += fmt::format("      F[i] -= ({0}[i] * y[i] + {1}[i]) * y[i] * y[i];\n", d, c);
    text += fmt::format("      J[i][i] += (3.0 * {0}[i] * y[i] + 2.0 * {1}[i]) * y[i];\n", d, c);
  }
  text += "    }\n";
  text +=
      "    const double v[3] = {J[1][1] * J[2][2] - J[1][2] * J[2][1],\n"
      "                         J[1][2] * J[2][0] - J[1][0] * J[2][2],\n"
      "                         J[1][0] * J[2][1] - J[1][1] * J[2][0]};\n"
      "    const double det = J[0][0] * v[0] + J[0][1] * v[1] + J[0][2] * v[2];\n";
  text += fmt::format("    if (!(fabs(det) > 1e-9)) return {};\n", dialect.own("no_solution"));
  text +=
      "    const double change[3] = {\n"
      "        (F[0] * v[0] + F[1] * (J[0][2] * J[2][1] - J[0][1] * J[2][2]) +\n"
      "         F[2] * (J[0][1] * J[1][2] - J[0][2] * J[1][1])) / det,\n"
      "        (F[0] * v[1] + F[1] * (J[0][0] * J[2][2] - J[0][2] * J[2][0]) +\n"
      "         F[2] * (J[0][2] * J[1][0] - J[0][0] * J[1][2])) / det,\n"
      "        (F[0] * v[2] + F[1] * (J[0][1] * J[2][0] - J[0][0] * J[2][1]) +\n"
      "         F[2] * (J[0][0] * J[1][1] - J[0][1] * J[1][0])) / det};\n"
      "    for (i = 0; i < 3; ++i) {\n"
      "      y[i] += change[i];\n"
      "      if (!(fabs(change[i]) <= largest)) largest = fabs(change[i]);\n"
      "    }\n";
  // In float a step of 1e-5 of the field is the last: the next would be its square, far below what
  // rounds.
  text += dialect.is_single()
              ? "    if (largest <= 1e-5 * (fabs(y[0]) + fabs(y[1]) + fabs(y[2]))) break;\n"
              : "    if (largest < 1e-9) break;\n";
  text += "  }\n";
  text += fmt::format("  if (step == 20) return {};\n", dialect.own("no_solution"));
  return text + "  for (i = 0; i < 3; ++i) h_ut[i] = y[i];\n";
}

}  // namespace

ProbeBody magnetometer_body(const FieldMatrix& field, bool up_to_rotation,
                            const Correction& correction, const Dialect& dialect) {
  ProbeBody body;
  body.summary = "h of m = C h + n with the effects below: the field in body axes";
  if (up_to_rotation) body.summary += ", up to a rotation that its strength does not show";
  body.readings = {{"m_ut", 3, {"mx_ut", "my_ut", "mz_ut"}, "uT, the field as read, x y z"}};
  body.outputs = {{"h_ut", 3, {"mx_cal_ut", "my_cal_ut", "mz_cal_ut"}, "uT, the field, x y z"}};
  const bool is_turned = field.turn != Eigen::Matrix3d::Identity();
  if (is_turned) {
    body.summary += "; m is turned from the sensor's axes into the body's first";
    body.constants.push_back({"turn", rows_of(field.turn), 3, "the mounting, 1, row by row"});
  }
  body.constants.push_back({"n", {field.n[0], field.n[1], field.n[2]}, 0, "n, uT, x y z"});
  const bool follows_field = correction.is_cubic || correction.has("scale.s") ||
                             correction.has("axis_scale.x") || correction.has("axis_scale.y") ||
                             correction.has("axis_scale.z");
  if (follows_field) {
    body.constants.push_back({"C", rows_of(field.C), 3, "C, 1, row by row"});
    body.text = stepwise(is_turned, correction, dialect);
  } else {
    body.constants.push_back({"inverse", rows_of(field.C.inverse()), 3, "C^-1, 1, row by row"});
    body.text = at_once(is_turned, correction, dialect);
  }
  const std::array fields{Eigen::Vector3d(20.0, -5.0, 45.0), Eigen::Vector3d(-25.0, 15.0, -35.0),
                          Eigen::Vector3d(5.0, 30.0, 20.0)};
  for (const Eigen::Vector3d& h : fields) {
    const Eigen::Vector3d m = field.turn.transpose() * (field.C * h + field.n);
    body.trials.push_back({m[0], m[1], m[2]});
  }
  return body;
}

}  // namespace sepcal::exporting
