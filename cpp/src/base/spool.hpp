// SPDX-License-Identifier: BSD-3-Clause
// Columns that are longer than memory: each is written to a file without a name and mapped. The
// kernel reads a page when it is touched; release() lets go of the pages that a pass has done with,
// so that what is resident does not grow with the columns.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sepcal::base {

class Spool {
 public:
  /// Files lie in `folder`; empty: in $TMPDIR, or /tmp.
  explicit Spool(std::string folder);
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool() = default;

  class Column {
   public:
    /// Throws Error where no file can be made in the spool's folder.
    explicit Column(Spool& spool);
    Column(const Column&) = delete;
    Column& operator=(const Column&) = delete;
    ~Column();

    /// Throws Error where the disc is full.
    void append(std::span<const double> values);
    void append(double value);

    /// All values, mapped; the spool keeps them. Call it once.
    std::span<const double> finish();

   private:
    void flush();

    Spool& spool_;
    int descriptor_ = -1;
    std::vector<double> pending_;
    std::size_t rows_ = 0;
  };

  /// Lets the pages of rows [first, last) of every finished column go; they come back when touched.
  /// From any thread.
  void release(std::size_t first, std::size_t last) const;

 private:
  struct Mapping {
    Mapping(int descriptor, std::size_t size);
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    ~Mapping();

    void* address = nullptr;
    std::size_t bytes = 0;
  };

  [[noreturn]] void fail(int error) const;

  std::string folder_;
  std::vector<std::unique_ptr<const Mapping>> mappings_;
};

}  // namespace sepcal::base
