// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/toeplitz.hpp"

#include <unsupported/Eigen/FFT>

#include <cmath>
#include <complex>

namespace sepcal::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Of a circle on which no product of `rows` with themselves laps: a power of two.
Index circle_length(Index rows) {
  Index length = 128;
  while (length < 2 * rows) length *= 2;
  return length;
}

}  // namespace

MatrixXd multiply_toeplitz(const VectorXd& lags, const Ref<const MatrixXd>& X) {
  constexpr Index few_rows = 64;
  const Index rows = X.rows();
  if (rows <= few_rows) {
    MatrixXd S(rows, rows);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < rows; ++j) S(i, j) = lags[std::abs(i - j)];
    }
    return S * X;
  }
  const Index length = circle_length(rows);
  Eigen::FFT<double> fft;
  VectorXd circle = VectorXd::Zero(length);
  circle.head(rows) = lags.head(rows);
  circle.tail(rows - 1) = lags.segment(1, rows - 1).reverse();
  VectorXcd spectrum;
  fft.fwd(spectrum, circle);
  MatrixXd product(rows, X.cols());
  VectorXd padded(length);
  VectorXcd transformed;
  for (Index j = 0; j < X.cols(); ++j) {
    padded.setZero();
    padded.head(rows) = X.col(j);
    fft.fwd(transformed, padded);
    transformed.array() *= spectrum.array();
    fft.inv(padded, transformed);
    product.col(j) = padded.head(rows);
  }
  return product;
}

VectorXd autocovariance(const VectorXd& x, Index furthest) {
  const Index rows = x.size();
  VectorXd padded = VectorXd::Zero(circle_length(rows));
  padded.head(rows) = x;
  Eigen::FFT<double> fft;
  VectorXcd transformed;
  fft.fwd(transformed, padded);
  transformed = transformed.cwiseAbs2().cast<std::complex<double>>().eval();
  fft.inv(padded, transformed);
  return padded.head(furthest + 1) / static_cast<double>(rows);
}

}  // namespace sepcal::numerics
