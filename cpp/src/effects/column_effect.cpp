// SPDX-License-Identifier: BSD-3-Clause
// An effect whose columns the caller computed, row by row.
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A term that looks its columns up by the record's row.
class ColumnTerm final : public BlockModel {
 public:
  ColumnTerm(const std::string& name, const std::string& unit,
             const std::vector<std::pair<std::string, MatrixXd>>& columns, const BlockModel& model,
             const Record& record)
      : BlockModel(tables_for(name, unit, columns, model)), columns_(columns) {
    for (const auto& [component, values] : columns_) {
      const std::string whose = "effect " + name + ", component '" + component + "'";
      if (values.rows() != static_cast<Index>(record.length()) ||
          values.cols() != model.tables().n_z()) {
        throw Error(whose + " has the shape (" + std::to_string(values.rows()) + ", " +
                    std::to_string(values.cols()) + "); the record's is (" +
                    std::to_string(record.length()) + ", " + std::to_string(model.tables().n_z()) +
                    "): rows by outputs");
      }
      for (const Segment& segment : record.segments()) {
        const auto part = values.middleRows(static_cast<Index>(segment.first),
                                            static_cast<Index>(segment.rows()));
        if (!part.allFinite()) throw Error(whose + " holds something else than finite numbers");
      }
    }
  }

  void evaluate(const Block& block, const double* /*xi2*/, const double* /*xi1*/, Carry* /*carry*/,
                Eigen::Ref<MatrixXd> rows) const override {
    const auto first = static_cast<Index>(block.first);
    const auto count = static_cast<Index>(block.rows);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      rows.col(static_cast<Index>(k)) = columns_[k].second.middleRows(first, count).reshaped();
    }
    rows.rightCols<1>().setZero();
  }

 private:
  static Tables tables_for(const std::string& name, const std::string& unit,
                           const std::vector<std::pair<std::string, MatrixXd>>& columns,
                           const BlockModel& model) {
    Tables tables;
    tables.outputs = model.tables().outputs;
    for (const auto& [component, values] : columns) {
      tables.linear.emplace_back(name + "." + component, unit);
    }
    return tables;
  }

  std::vector<std::pair<std::string, MatrixXd>> columns_;
};

}  // namespace

Effect column_effect(const std::string& name, const std::string& unit,
                     const std::vector<std::pair<std::string, MatrixXd>>& columns,
                     const BlockModel& model, const Record& record) {
  Effect effect{.name = name};
  effect.terms.push_back(std::make_shared<const ColumnTerm>(name, unit, columns, model, record));
  return effect;
}

}  // namespace sepcal
