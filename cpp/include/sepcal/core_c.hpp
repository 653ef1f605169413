// SPDX-License-Identifier: BSD-3-Clause
// What core_c.h declares, for a program's own models: each macro defines the functions of one
// object in the memory that C has for it. Include it in one file of C++, after core_c.h's macros
// declared the names.
#pragma once

#include <cstddef>
#include <limits>
#include <new>
#include <optional>
#include <type_traits>

#include "sepcal/core.hpp"
#include "sepcal/core_c.h"  // IWYU pragma: export

namespace sepcal::from_c {

/// Makes the object in C's memory.
template <class Object, class Memory, class... Arguments>
void make(Memory* memory, const Arguments&... arguments) {
  static_assert(sizeof(Object) <= sizeof(Memory),
                "give the object the bytes that stand on the left");
  static_assert(alignof(Object) <= alignof(Memory));
  static_assert(std::is_trivially_destructible_v<Object>);
  new (static_cast<void*>(memory->memory)) Object(arguments...);
}

/// The object there.
template <class Object, class Memory>
Object& in(Memory* memory) {
  return *std::launder(reinterpret_cast<Object*>(memory->memory));
}
template <class Object, class Memory>
const Object& in(const Memory* memory) {
  return *std::launder(reinterpret_cast<const Object*>(memory->memory));
}

template <int N, class Scalar>
Vec<Scalar, N> vector(const Scalar* numbers) {
  Vec<Scalar, N> result;
  for (int k = 0; k < N; ++k) result[k] = numbers[k];
  return result;
}

template <class Scalar, class Vector>
void give(const Vector& numbers, Scalar* out) {
  for (Eigen::Index k = 0; k < numbers.size(); ++k) out[k] = numbers[k];
}

/// A calibration at work, whatever its probe reads.
template <SeparableModel M, class Scalar>
class Correction {
 public:
  static constexpr int n_u = Sizes<M>::n_u;
  static constexpr bool in_known_field = correcting::Of<M, Magnetometer>;
  static constexpr bool by_strength = correcting::Of<M, AttitudeIndependentMagnetometer>;
  static constexpr bool five_hole = correcting::Of<M, FiveHoleProbe>;
  static constexpr bool tube = correcting::Of<M, PitotStatic>;
  static_assert(in_known_field || by_strength || five_hole || tube,
                "there is a correction of sepcal's probes, with effects");
  static constexpr int n_readings = in_known_field ? 3 : tube ? 1 : 0;
  static constexpr int n_outputs = tube ? 1 : 3;

  explicit Correction(const M& model) : calibrated_{model} {}

  bool set(std::string_view name, Scalar value) { return calibrated_.set(name, value); }

  int correct(const Scalar* u, const Scalar* z, Scalar* out) const {
    const Vec<Scalar, n_u> inputs = vector<n_u>(u);
    if constexpr (in_known_field) {
      const auto found = sepcal::correct(calibrated_, vector<3>(z), inputs);
      return give_field(found, out);
    } else if constexpr (by_strength) {
      return give_field(sepcal::correct(calibrated_, inputs), out);
    } else if constexpr (five_hole) {
      const auto air = sepcal::correct(calibrated_, inputs);
      if (air.status == CorrectionStatus::ok) {
        give(Vec<Scalar, 3>(air.airspeed, air.alpha, air.beta), out);
      }
      return static_cast<int>(air.status);
    } else {
      const auto corrected = sepcal::correct(calibrated_, z[0], inputs);
      if (corrected.status == CorrectionStatus::ok) out[0] = corrected.airspeed;
      return static_cast<int>(corrected.status);
    }
  }

 private:
  static int give_field(const CorrectedField<Scalar>& found, Scalar* out) {
    if (found.status == CorrectionStatus::ok) give(found.h, out);
    return static_cast<int>(found.status);
  }

  Calibrated<M, Scalar> calibrated_;
};

/// A two-stage start on `Rows` rows, and the iterated filter that goes on from it.
template <SeparableModel M, int Rows, int Starts, class Scalar>
class Stream {
 public:
  using Start = TwoStageStart<M, Rows, Starts, Scalar>;
  using Form = InformationForm<Start::n, Scalar>;
  using Parameters = Start::Parameters;

  Stream(const M& model, const Scalar* noise)
      : model_(model), noise_(vector<Start::n_z>(noise)), start_(model, noise_) {}

  bool add(const Scalar* u, const Scalar* z) {
    return start_.add(vector<Start::n_u>(u), vector<Start::n_z>(z));
  }
  void seal() { start_.seal(); }

  int work() {
    const StartStatus status = start_.work();
    if (status == StartStatus::done && !filter_) {
      filter_.emplace(model_,
                      Filter<Start::n, Form>(start_.parameters(),
                                             Form::of_information_root(start_.information_root())));
    }
    return static_cast<int>(status);
  }
  int status() const { return static_cast<int>(start_.status()); }
  int most_calls() const { return start_.most_calls(); }

  int update(const Scalar* u, const Scalar* z) {
    if (!filter_) return static_cast<int>(FilterStatus::refused);
    const Scalar s = start_.noise_ratio();
    const Eigen::Matrix<Scalar, Start::n_z, Start::n_z> R = (s * noise_).cwiseAbs2().asDiagonal();
    return static_cast<int>(
        filter_->update_iterated(vector<Start::n_u>(u), vector<Start::n_z>(z), R).status);
  }

  Parameters parameters() const { return filter_ ? filter_->filter().x() : unknown(); }
  Parameters standard_errors() const {
    if (!filter_) return unknown();
    return filter_->filter().covariance().diagonal().cwiseSqrt();
  }

 private:
  static Parameters unknown() {
    return Parameters::Constant(std::numeric_limits<Scalar>::quiet_NaN());
  }

  M model_;
  Start::Outputs noise_;
  Start start_;
  std::optional<JointFilter<M, Form>> filter_;
};

/// y = H p + e of M values a row, whose errors go each by itself.
template <int N, int M, class Scalar>
class LeastSquares {
 public:
  bool absorb(const Scalar* H, const Scalar* y, const Scalar* noise) {
    Eigen::Matrix<Scalar, M, N> rows;
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < N; ++j) rows(i, j) = H[i * N + j];
    }
    const Eigen::Matrix<Scalar, M, M> W = vector<M>(noise).cwiseAbs2().asDiagonal();
    return root_.template absorb<M>(rows, vector<M>(y), W);
  }
  bool determined() const { return root_.determined(); }
  Vec<Scalar, N> solution() const { return root_.solution(); }
  Vec<Scalar, N> standard_errors() const { return root_.covariance().diagonal().cwiseSqrt(); }

 private:
  InformationRoot<N, Scalar> root_;
};

}  // namespace sepcal::from_c

/// Defines what SEPCAL_C_CORRECTION(name, ...) declared; ...: the model, an expression that
/// NAME_init() evaluates.
#define SEPCAL_C_DEFINE_CORRECTION(name, ...)                                                \
  using name##_model_type = std::remove_cvref_t<decltype(__VA_ARGS__)>;                      \
  using name##_object = sepcal::from_c::Correction<name##_model_type, name##_scalar>;        \
  static_assert(name##_object::n_u == name##_inputs, "inputs of the model");                 \
  static_assert(name##_object::n_readings == name##_readings, "readings beside the inputs"); \
  static_assert(name##_object::n_outputs == name##_outputs, "outputs of the correction");    \
  extern "C" void name##_init(name* correction) {                                            \
    sepcal::from_c::make<name##_object>(correction, __VA_ARGS__);                            \
  }                                                                                          \
  extern "C" int name##_set(name* correction, const char* parameter, name##_scalar value) {  \
    return sepcal::from_c::in<name##_object>(correction).set(parameter, value) ? 1 : 0;      \
  }                                                                                          \
  extern "C" int name##_input(const char* input) {                                           \
    return sepcal::place_of(input, name##_model_type::inputs);                               \
  }                                                                                          \
  extern "C" int name##_correct(const name* correction, const name##_scalar* u,              \
                                const name##_scalar* z, name##_scalar* out) {                \
    return sepcal::from_c::in<name##_object>(correction).correct(u, z, out);                 \
  }                                                                                          \
  static_assert(true)

/// Defines what SEPCAL_C_STREAM(name, ...) declared. row_count: that the start keeps; start_count:
/// points of stage one that stage two refines; ...: the model, likewise.
#define SEPCAL_C_DEFINE_STREAM(name, row_count, start_count, ...)                                 \
  using name##_model_type = std::remove_cvref_t<decltype(__VA_ARGS__)>;                           \
  using name##_object =                                                                           \
      sepcal::from_c::Stream<name##_model_type, row_count, start_count, name##_scalar>;           \
  static_assert(name##_object::Start::n_u == name##_inputs, "inputs of the model");               \
  static_assert(name##_object::Start::n_z == name##_readings, "outputs of the model");            \
  static_assert(name##_object::Start::n == name##_parameter_count, "parameters of the model");    \
  extern "C" void name##_init(name* stream, const name##_scalar* noise) {                         \
    sepcal::from_c::make<name##_object>(stream, __VA_ARGS__, noise);                              \
  }                                                                                               \
  extern "C" int name##_add(name* stream, const name##_scalar* u, const name##_scalar* z) {       \
    return sepcal::from_c::in<name##_object>(stream).add(u, z) ? 1 : 0;                           \
  }                                                                                               \
  extern "C" void name##_seal(name* stream) { sepcal::from_c::in<name##_object>(stream).seal(); } \
  extern "C" int name##_work(name* stream) {                                                      \
    return sepcal::from_c::in<name##_object>(stream).work();                                      \
  }                                                                                               \
  extern "C" int name##_status(const name* stream) {                                              \
    return sepcal::from_c::in<name##_object>(stream).status();                                    \
  }                                                                                               \
  extern "C" int name##_update(name* stream, const name##_scalar* u, const name##_scalar* z) {    \
    return sepcal::from_c::in<name##_object>(stream).update(u, z);                                \
  }                                                                                               \
  extern "C" void name##_parameters(const name* stream, name##_scalar* out) {                     \
    sepcal::from_c::give(sepcal::from_c::in<name##_object>(stream).parameters(), out);            \
  }                                                                                               \
  extern "C" void name##_standard_errors(const name* stream, name##_scalar* out) {                \
    sepcal::from_c::give(sepcal::from_c::in<name##_object>(stream).standard_errors(), out);       \
  }                                                                                               \
  extern "C" int name##_most_calls(const name* stream) {                                          \
    return sepcal::from_c::in<name##_object>(stream).most_calls();                                \
  }                                                                                               \
  extern "C" int name##_input(const char* input) {                                                \
    return sepcal::place_of(input, name##_model_type::inputs);                                    \
  }                                                                                               \
  extern "C" int name##_parameter(const char* parameter) {                                        \
    const int linear = sepcal::place_of(parameter, name##_model_type::linear);                    \
    if (linear >= 0) return linear;                                                               \
    const int other = sepcal::place_of(parameter, name##_model_type::nonlinear);                  \
    return other < 0 ? -1 : other + name##_object::Start::n_1;                                    \
  }                                                                                               \
  static_assert(true)

// NOLINTBEGIN(bugprone-macro-parentheses): of types
/// Defines what SEPCAL_C_LEAST_SQUARES(name, ...) declared.
#define SEPCAL_C_DEFINE_LEAST_SQUARES(name)                                                    \
  using name##_object =                                                                        \
      sepcal::from_c::LeastSquares<name##_parameter_count, name##_rows, name##_scalar>;        \
  extern "C" void name##_init(name* squares) { sepcal::from_c::make<name##_object>(squares); } \
  extern "C" int name##_absorb(name* squares, const name##_scalar* H, const name##_scalar* y,  \
                               const name##_scalar* noise) {                                   \
    return sepcal::from_c::in<name##_object>(squares).absorb(H, y, noise) ? 1 : 0;             \
  }                                                                                            \
  extern "C" int name##_determined(const name* squares) {                                      \
    return sepcal::from_c::in<name##_object>(squares).determined() ? 1 : 0;                    \
  }                                                                                            \
  extern "C" void name##_solution(const name* squares, name##_scalar* out) {                   \
    sepcal::from_c::give(sepcal::from_c::in<name##_object>(squares).solution(), out);          \
  }                                                                                            \
  extern "C" void name##_standard_errors(const name* squares, name##_scalar* out) {            \
    sepcal::from_c::give(sepcal::from_c::in<name##_object>(squares).standard_errors(), out);   \
  }                                                                                            \
  static_assert(true)
// NOLINTEND(bugprone-macro-parentheses)
