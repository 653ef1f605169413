// SPDX-License-Identifier: BSD-3-Clause
// A file without a disk (memfd_create), for readers that open files by name.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "fuzzing.hpp"

namespace sepcal::fuzz {

class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("fuzzed", 0)) {
    require(descriptor_ >= 0, "a file in memory can be made");
    name_ = "/proc/self/fd/" + std::to_string(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(descriptor_); }

  const std::string& name() const { return name_; }

  void hold(std::string_view bytes) {
    const bool emptied = ::ftruncate(descriptor_, 0) == 0;
    const auto written = ::pwrite(descriptor_, bytes.data(), bytes.size(), 0);
    require(emptied && written == static_cast<ssize_t>(bytes.size()), "the file holds the input");
  }

 private:
  int descriptor_;
  std::string name_;
};

}  // namespace sepcal::fuzz
