// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/innovation_rows.hpp"

#include <map>
#include <span>
#include <string>

#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::optional<PathNoise> noise_of(const Fit& fit, const BlockModel& model) {
  if (fit.method != FitMethod::filter_error) return {};
  const std::map<std::string, double> process = fit.process_noise();
  const std::span<const Variable> noises = model.process_noises();
  PathNoise noise{VectorXd(static_cast<Index>(noises.size())),
                  VectorXd(static_cast<Index>(fit.noise.size()))};
  for (std::size_t k = 0; k < noises.size(); ++k) {
    const auto found = process.find(noises[k].name);  // none of those that no output shows
    noise.process[static_cast<Index>(k)] = found == process.end() ? 0.0 : found->second;
  }
  for (std::size_t j = 0; j < fit.noise.size(); ++j) {
    noise.outputs[static_cast<Index>(j)] = fit.noise[j].value;
  }
  return noise;
}

MatrixXd innovation_rows(const BlockModel& model, const Record& rows, const VectorXd& xi,
                         const PathNoise& noise, std::vector<Index> columns) {
  const auto innovations = model.innovations(rows);
  VectorXd theta(innovations->size());
  theta << xi, noise.process.array().log().matrix(), noise.outputs.array().log().matrix();
  columns.back() = innovations->size();
  const auto N = static_cast<Index>(rows.rows());
  const Index n_z = innovations->outputs();
  MatrixXd stacked(n_z * N, static_cast<Index>(columns.size()));
  Index at = 0;
  innovations->scores(theta, [&](std::size_t /*row*/, MatrixXd& scores) {
    for (Index first = 0; first < scores.rows(); first += innovations->rows_a_sample(), ++at) {
      stacked(Eigen::seqN(at, n_z, N), Eigen::all) =
          scores.middleRows(first, n_z)(Eigen::all, columns);
    }
  });
  if (at != N) throw Error("the filter of the fit can't go through the record");
  return stacked;
}

}  // namespace sepcal::diagnosis
