// SPDX-License-Identifier: BSD-3-Clause
// What a flight program needs of the machine that it runs on: numbers in and out, instructions
// counted. board/ has it for the target in its emulator, host/ for this machine.
#pragma once

#include <cstdint>

#include "sepcal/detail/eigen.hpp"

namespace target {

/// The next `count` numbers of in.bin. Where they aren't there the program ends.
void read(double* numbers, int count);
/// Appends to out.bin.
void write(const double* numbers, int count);
/// Instructions since the program began; on this machine 0.
std::uint64_t instructions();
/// Bytes of stack that were ever used; on this machine 0.
std::uint32_t deepest_stack();

inline double read() {
  double number = 0;
  read(&number, 1);
  return number;
}
inline int read_count() { return static_cast<int>(read()); }
inline void write(double number) { write(&number, 1); }

/// N numbers in a program's own kind.
template <class Scalar, int N>
Eigen::Matrix<Scalar, N, 1> read_vector() {
  double numbers[N > 0 ? N : 1] = {};
  read(numbers, N);
  Eigen::Matrix<Scalar, N, 1> vector;
  for (int k = 0; k < N; ++k) vector[k] = static_cast<Scalar>(numbers[k]);
  return vector;
}

template <class Expression>
void write_all(const Eigen::MatrixBase<Expression>& expression) {
  for (Eigen::Index k = 0; k < expression.cols(); ++k) {
    for (Eigen::Index i = 0; i < expression.rows(); ++i)
      write(static_cast<double>(expression(i, k)));
  }
}

/// The largest number of instructions that a call took.
class Worst {
 public:
  template <class Call>
  auto of(const Call& call) {
    const std::uint64_t before = instructions();
    const auto result = call();
    const std::uint64_t taken = instructions() - before;
    if (taken > most_) most_ = taken;
    return result;
  }
  double most() const { return static_cast<double>(most_); }

 private:
  std::uint64_t most_ = 0;
};

}  // namespace target

/// A flight program: runs once, between in.bin and out.bin.
void fly();
