// SPDX-License-Identifier: BSD-3-Clause
// Which of a table's columns tells the time, where none of them is called so in a known unit.
#pragma once

#include <string_view>
#include <vector>

#include "flight/files/table_form.hpp"

namespace sepcal::files {

/// Some of the table's first rows, cut into cells.
using SampledRows = std::vector<std::vector<std::string_view>>;

/// Whether a cell is a time of day, a date or both.
bool is_time_text(std::string_view cell);

/// Makes the column that tells the time time_s, and says in a note how: text of a clock, with its
/// date where that is known, a count of seconds to nanoseconds, or of days, since an epoch; seconds
/// whose fractions show that they are such. Nothing where the table has such a column already, or
/// none. Numbers in a column of `mapped` stay as they are. `shown`: rows from farther down as well.
void find_time(const std::string& file, TableForm& form, const SampledRows& rows,
               const SampledRows& shown, const std::vector<std::string>& mapped);

/// Times of day that go on rising across midnight, over all rows.
class RisingClock {
 public:
  double operator()(double seconds_of_day);

 private:
  double days_ = 0.0;  // [s]
  double last_ = 0.0;
  bool begun_ = false;
};

}  // namespace sepcal::files
