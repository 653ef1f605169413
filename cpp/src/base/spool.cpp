// SPDX-License-Identifier: BSD-3-Clause
#include "base/spool.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/unnamed_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal::base {
namespace {

constexpr std::size_t pending_rows = 4096;
// A fault maps the pages round it too, in aligned windows of this size (Linux's fault-around).
constexpr std::size_t window = std::size_t{1} << 16U;

}  // namespace

Spool::Spool(std::string folder)
    : folder_(folder.empty() ? temporary_folder() : std::move(folder)) {}

void Spool::fail(int error) const {
  throw Error(folder_ + ": can't hold the columns of a streamed log: " +
              std::strerror(error) +  // NOLINT(concurrency-mt-unsafe)
              "; name a folder with room for them in TMPDIR");
}

void Spool::release(std::size_t first, std::size_t last) const {
  const std::size_t from = first * sizeof(double) / window * window;
  const std::size_t to = (last * sizeof(double) + window - 1) / window * window;
  for (const auto& mapping : mappings_) {
    const std::size_t end = std::min(to, mapping->bytes);
    if (from >= end) continue;
    ::madvise(static_cast<char*>(mapping->address) + from, end - from, MADV_DONTNEED);
  }
}

Spool::Mapping::Mapping(int descriptor, std::size_t size) : bytes(size) {
  address = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor, 0);
}

Spool::Mapping::~Mapping() {
  if (address != MAP_FAILED) ::munmap(address, bytes);  // NOLINT
}

Spool::Column::Column(Spool& spool) : spool_(spool), descriptor_(open_scratch_file(spool.folder_)) {
  if (descriptor_ < 0) spool.fail(errno);
  pending_.reserve(pending_rows);
}

Spool::Column::~Column() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Spool::Column::append(std::span<const double> values) {
  for (const double value : values) append(value);
}

void Spool::Column::append(double value) {
  pending_.push_back(value);
  if (pending_.size() == pending_rows) flush();
}

void Spool::Column::flush() {
  const char* from = reinterpret_cast<const char*>(pending_.data());  // NOLINT
  std::size_t left = pending_.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = ::write(descriptor_, from, left);
    if (written < 0 && errno != EINTR) spool_.fail(errno);
    if (written <= 0) continue;
    from += written;
    left -= static_cast<std::size_t>(written);
  }
  rows_ += pending_.size();
  pending_.clear();
}

std::span<const double> Spool::Column::finish() {
  flush();
  if (rows_ == 0) return {};
  auto mapping = std::make_unique<const Mapping>(descriptor_, rows_ * sizeof(double));
  if (mapping->address == MAP_FAILED) spool_.fail(errno);  // NOLINT
  ::close(std::exchange(descriptor_, -1));
  const auto* values = static_cast<const double*>(mapping->address);
  spool_.mappings_.push_back(std::move(mapping));
  return {values, rows_};
}

}  // namespace sepcal::base
