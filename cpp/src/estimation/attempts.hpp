// SPDX-License-Identifier: BSD-3-Clause
// In which ways stage two looks for a minimum, one after the other until one of them finds it.
#pragma once

#include <vector>

#include "estimation/stages.hpp"

namespace sepcal::estimation {

struct Attempt {
  SecondStage method = SecondStage::joint;  // joint or projected
  double first_radius = 1e4;                // as in DescentOptions
  /// Where the record leaves something open at the start, hold it by a loose prior, jointly.
  bool hold = true;
  /// The start is all but the minimum: it is refined before anything else, and kept where it has to
  /// be held.
  bool near = false;
};

/// The ways from stage one's end, the first of which nearly always is enough. Behind samples: as
/// Step 5 has it, then, if that was `auto`'s projected, joint. A start that was given may be poor,
/// and what the record leaves open there it may determine at the minimum: nothing is held at first.
/// Then follow joint (`auto`) with what is open held, and the first way again with shorter steps.
std::vector<Attempt> list_attempts(const FitOptions& options, const StageOne& start);

/// From the minimum of a neighbouring problem, in which what is open was held or was not.
Attempt from_neighbour(const FitOptions& options, SecondStage method, bool hold);

/// The same by steps so short that the descent ends in the neighbour's basin; nothing is held.
Attempt within_basin(const FitOptions& options, SecondStage method);

/// How an attempt ended.
struct Ending {
  bool converged = false;
  bool open = false;  // the record leaves something open at the end
  bool held = false;  // and a prior held it
  double cost = 0.0;  // J of Eq. 6
};

/// Whether no further attempt is called for: it converged and, from a start that was given, to a
/// point that the record determines.
bool is_enough(const Ending& ending, bool start_given);

/// Whether `next` is to be kept instead of `best`: converged before not, determined before open,
/// held before run away, then the lower cost.
bool is_better(const Ending& next, const Ending& best);

/// Whether both converged and the record can't tell their ends apart: then what they leave open is
/// the record's doing.
bool agree(const Ending& one, const Ending& other);

}  // namespace sepcal::estimation
