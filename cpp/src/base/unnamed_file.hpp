// SPDX-License-Identifier: BSD-3-Clause
// Files without a name: Linux makes them and can name them later (O_TMPFILE, /proc/self/fd). Other
// systems, and some discs, can't. What the system lacks is known here alone.
#pragma once

#include <sys/types.h>

#include <string>

namespace sepcal::base {

/// $TMPDIR, or else /tmp.
std::string temporary_folder();

/// A file in `folder` to write and read, which is gone once it is closed. Negative, with errno,
/// where there can be none.
int open_scratch_file(const std::string& folder);

/// A file to write, on the folder's disc, to be named by name_file(). Negative where there can be
/// none, or none that could be named.
int open_unnamed_file(const std::string& folder, mode_t mode);

/// False, with errno, where that name is taken or can't be given.
bool name_file(int descriptor, const char* name);

}  // namespace sepcal::base
