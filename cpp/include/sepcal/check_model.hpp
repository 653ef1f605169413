// SPDX-License-Identifier: BSD-3-Clause
// What the SeparableModel concept can't see: that every entry of A and b is set, that the same
// question gets the same answer, and that the derivatives are those of the values.
#pragma once

#include <map>
#include <string>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Tries `model` on a few samples of `record` at a few points within the parameters' bounds, of
/// which the first is `start` (by nonlinear parameter; without it what the record tells, or the
/// middle of the bounds). Throws
/// Error naming the entry, by output and parameter, that
///   is not finite wherever it was tried (entries start as NaN: one that is never set stays so),
///   differs between two evaluations of the same sample (bit for bit), or
///   has a derivative with respect to xi2 that central differences contradict by over 1e-4.
/// fit() calls this first.
void check_model(const BlockModel& model, const Record& record,
                 const std::map<std::string, double>& start = {});

template <SeparableModel M>
void check_model(const M& model, const Record& record,
                 const std::map<std::string, double>& start = {}) {
  check_model(StaticModel<M>(model), record, start);
}

}  // namespace sepcal
