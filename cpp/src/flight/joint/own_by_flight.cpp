// SPDX-License-Identifier: BSD-3-Clause
#include "flight/joint/own_by_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/aligned_doubles.hpp"
#include "sepcal/error.hpp"

namespace sepcal::joint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

std::vector<Index> find_own(const std::vector<Variable>& parameters,
                            const std::vector<std::string>& own) {
  std::vector<Index> places;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (std::ranges::find(own, parameters[k].name) != own.end()) {
      places.push_back(static_cast<Index>(k));
    }
  }
  return places;
}

void append_own(std::vector<Variable>& parameters, const std::vector<std::string>& own,
                const std::vector<std::string>& flights) {
  const std::vector<Variable> of_model = parameters;
  for (const std::string& flight : flights) {
    for (const Index k : find_own(of_model, own)) {
      Variable parameter = of_model[static_cast<std::size_t>(k)];
      parameter.name = name_of_own(parameter.name, flight);
      parameters.push_back(std::move(parameter));
    }
  }
}

Tables with_own(Tables tables, const std::vector<std::string>& own,
                const std::vector<std::string>& flights) {
  append_own(tables.linear, own, flights);
  append_own(tables.nonlinear, own, flights);
  tables.inputs.emplace_back(flight_number, "1");
  return tables;
}

/// Where a flight's own parameters begin, of `count` of the model and so many own ones a flight.
Index begin_of(Index count, const std::vector<Index>& own, Index flight) {
  return count + flight * static_cast<Index>(own.size());
}

}  // namespace

std::string name_of_own(const std::string& parameter, const std::string& flight) {
  return parameter + "@" + flight;
}

OwnByFlight::OwnByFlight(const BlockModel& model, const std::vector<std::string>& own,
                         const std::vector<std::string>& flights)
    : BlockModel(with_own(model.tables(), own, flights)),
      model_(model),
      flights_(static_cast<Index>(flights.size())),
      own_1_(find_own(model.tables().linear, own)),
      own_2_(find_own(model.tables().nonlinear, own)) {}

VectorXd OwnByFlight::on_flight(const double* all, Index count, const std::vector<Index>& own,
                                Index flight) {
  VectorXd values = Eigen::Map<const VectorXd>(all, count);
  const double* const added = all + begin_of(count, own, flight);
  for (std::size_t i = 0; i < own.size(); ++i) values[own[i]] += added[i];
  return values;
}

Index OwnByFlight::flight_of(const double* const* inputs) const {
  const double number = inputs[model_.tables().n_u()][0];
  const auto flight = static_cast<Index>(std::llround(number));
  if (!(number >= 0) || flight >= flights_) {
    throw Error(fmt::format("a row is of flight number {}; there are {}", number, flights_));
  }
  return flight;
}

Block OwnByFlight::without_number(const Block& block) const {
  Block inner = block;
  inner.inputs = block.inputs.first(static_cast<std::size_t>(model_.tables().n_u()));
  return inner;
}

void OwnByFlight::evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                           Ref<MatrixXd> rows) const {
  const Index flight = flight_of(block.inputs.data());
  const Index n_1 = model_.tables().n_1();
  const Index n_2 = model_.tables().n_2();
  const bool tangent = xi1 != nullptr;
  MatrixXd inner(rows.rows(), n_1 + (tangent ? n_2 : 0) + 1);
  const VectorXd of_flight_2 = on_flight(xi2, n_2, own_2_, flight);
  if (tangent) {
    const VectorXd of_flight_1 = on_flight(xi1, n_1, own_1_, flight);
    model_.evaluate(without_number(block), values_of(of_flight_2), values_of(of_flight_1), carry,
                    inner);
  } else {
    model_.evaluate(without_number(block), values_of(of_flight_2), nullptr, carry, inner);
  }
  rows.setZero();
  rows.leftCols(n_1) = inner.leftCols(n_1);
  const Index begin_1 = begin_of(n_1, own_1_, flight);
  for (std::size_t i = 0; i < own_1_.size(); ++i) {
    rows.col(begin_1 + static_cast<Index>(i)) = inner.col(own_1_[i]);
  }
  if (tangent) {
    const Index first = tables().n_1();
    rows.middleCols(first, n_2) = inner.middleCols(n_1, n_2);
    const Index begin_2 = first + begin_of(n_2, own_2_, flight);
    for (std::size_t i = 0; i < own_2_.size(); ++i) {
      rows.col(begin_2 + static_cast<Index>(i)) = inner.col(n_1 + own_2_[i]);
    }
  }
  rows.rightCols<1>() = inner.rightCols<1>();
}

bool OwnByFlight::evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                                 const VisitTile& visit) const {
  const Index flight = flight_of(block.inputs);
  const Index n_1 = model_.tables().n_1();
  const Index n_z = tables().n_z();
  const Index begin = begin_of(n_1, own_1_, flight);
  std::vector<Index> source(static_cast<std::size_t>(tables().n_1()), -1);  // -1: zero on it
  for (Index c = 0; c < n_1; ++c) source[static_cast<std::size_t>(c)] = c;
  for (std::size_t i = 0; i < own_1_.size(); ++i) {
    source[static_cast<std::size_t>(begin) + i] = own_1_[i];
  }
  const auto is_left_out = [&](Index j, std::size_t c) {
    return block.zero != nullptr &&
           block.zero[static_cast<std::size_t>(j) * source.size() + c] != 0;
  };
  std::vector<unsigned char> zero(static_cast<std::size_t>(n_z * n_1), 1);
  for (Index j = 0; j < n_z; ++j) {
    for (std::size_t c = 0; c < source.size(); ++c) {
      if (source[c] >= 0 && !is_left_out(j, c)) {
        zero[static_cast<std::size_t>(j * n_1 + source[c])] = 0;
      }
    }
  }
  LaneBlock inner = block;
  inner.zero = zero.data();
  const std::size_t size = block.rows * lane_width();
  base::AlignedDoubles rows(static_cast<std::size_t>(n_z * (n_1 + 1)) * size);
  return model_.evaluate_lanes(inner, points, rows.data(), [&](std::size_t tile, double* values) {
    double* to = scratch;
    for (Index j = 0; j < n_z; ++j) {
      std::vector<const double*> at(static_cast<std::size_t>(n_1), nullptr);
      for (Index c = 0; c < n_1; ++c) {
        if (zero[static_cast<std::size_t>(j * n_1 + c)] != 0) continue;
        at[static_cast<std::size_t>(c)] = values;
        values += size;
      }
      for (std::size_t c = 0; c < source.size(); ++c) {
        if (is_left_out(j, c)) continue;
        to = source[c] < 0 ? std::fill_n(to, size, 0.0)
                           : std::copy_n(at[static_cast<std::size_t>(source[c])], size, to);
      }
      to = std::copy_n(values, size, to);
      values += size;
    }
    visit(tile, scratch);
  });
}

void OwnByFlight::input_tangent(const Block& block, const double* xi2, const double* xi1,
                                std::span<const int> inputs, Ref<MatrixXd> columns) const {
  const Index flight = flight_of(block.inputs.data());
  const VectorXd of_flight_2 = on_flight(xi2, model_.tables().n_2(), own_2_, flight);
  const VectorXd of_flight_1 = on_flight(xi1, model_.tables().n_1(), own_1_, flight);
  const int number = model_.tables().n_u();
  std::vector<int> moving;
  std::vector<Index> places;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i] == number) continue;  // a row is of its flight whatever else moves
    moving.push_back(inputs[i]);
    places.push_back(static_cast<Index>(i));
  }
  MatrixXd slopes(columns.rows(), static_cast<Index>(moving.size()));
  model_.input_tangent(without_number(block), values_of(of_flight_2), values_of(of_flight_1),
                       moving, slopes);
  columns.setZero();
  columns(Eigen::all, places) = slopes;
}

bool OwnByFlight::add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                                         Ref<MatrixXd> sum) const {
  if (!own_2_.empty()) return false;
  const VectorXd of_flight =
      on_flight(xi1, model_.tables().n_1(), own_1_, flight_of(block.inputs.data()));
  return model_.add_second_derivatives(without_number(block), xi2, values_of(of_flight), sum);
}

MatrixXd OwnByFlight::guess(const MatrixXd& u, const MatrixXd& z) const {
  if (!own_2_.empty()) return MatrixXd(tables().n_2(), 0);
  return model_.guess(u.leftCols(model_.tables().n_u()), z);
}

}  // namespace sepcal::joint
