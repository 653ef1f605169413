// SPDX-License-Identifier: BSD-3-Clause
// The five-hole probe as a careful user writes it for a solver: what depends on a row's inputs
// alone is computed once, before the first evaluation (Sun & Gebre-Egziabher, Eqs. 36-42).
#pragma once

#include <cmath>
#include <vector>

#include "five_hole_file.hpp"

namespace benchmark {

struct HoistedRow {
  double C[9];         // body to NED, by rows
  double rotation[3];  // C (w x r)
  double airspeed;     // as read
  double alpha;        // as read
  double beta;
  double z[3];
};

inline std::vector<HoistedRow> hoist(const FiveHoleFile& file) {
  using F = FiveHoleFile;
  std::vector<HoistedRow> rows(file.rows);
  for (std::size_t i = 0; i < file.rows; ++i) {
    const auto at = [&](F::Column which) { return file.column(which)[i]; };
    HoistedRow& row = rows[i];
    const double cr = std::cos(at(F::roll));
    const double sr = std::sin(at(F::roll));
    const double cp = std::cos(at(F::pitch));
    const double sp = std::sin(at(F::pitch));
    const double cy = std::cos(at(F::yaw));
    const double sy = std::sin(at(F::yaw));
    const double C[9] = {cp * cy,
                         sr * sp * cy - cr * sy,
                         cr * sp * cy + sr * sy,
                         cp * sy,
                         sr * sp * sy + cr * cy,
                         cr * sp * sy - sr * cy,
                         -sp,
                         sr * cp,
                         cr * cp};
    const double w[3] = {at(F::p), at(F::q), at(F::r)};
    const double* a = file.arm;
    const double v[3] = {w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2],
                         w[0] * a[1] - w[1] * a[0]};
    for (int j = 0; j < 9; ++j) row.C[j] = C[j];
    for (int j = 0; j < 3; ++j) {
      row.rotation[j] = C[3 * j] * v[0] + C[3 * j + 1] * v[1] + C[3 * j + 2] * v[2];
    }
    const double pressure = at(F::pt) - at(F::ps);
    row.airspeed = std::sqrt(2.0 * pressure / at(F::rho));
    row.alpha = at(F::dpa) / (file.k_alpha * pressure);
    row.beta = at(F::dpb) / (file.k_beta * pressure);
    row.z[0] = at(F::vn);
    row.z[1] = at(F::ve);
    row.z[2] = at(F::vd);
  }
  return rows;
}

/// C(eps) [cos a cos b, sin b, sin a cos b] turned to NED: the air's direction (3). xi2 (5);
/// cos_eps and sin_eps, of its last.
template <class T>
void air_direction(const HoistedRow& row, const T* xi2, const T& cos_eps, const T& sin_eps, T* F) {
  using std::cos;
  using std::sin;
  const T alpha = (1.0 + xi2[0]) * row.alpha + xi2[1];
  const T beta = (1.0 + xi2[2]) * row.beta + xi2[3];
  const T cos_b = cos(beta);
  const T sin_b = sin(beta);
  const T x = cos(alpha) * cos_b;
  const T up = sin(alpha) * cos_b;
  const T y = cos_eps * sin_b + sin_eps * up;
  const T z = cos_eps * up - sin_eps * sin_b;
  for (int j = 0; j < 3; ++j) F[j] = row.C[3 * j] * x + row.C[3 * j + 1] * y + row.C[3 * j + 2] * z;
}

}  // namespace benchmark
