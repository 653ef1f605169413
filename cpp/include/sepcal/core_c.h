/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * sepcal's core from C (C99 and later). A model is a C++ template, so that a program names its
 * models in one file of C++, by the macros of core_c.hpp; this header declares what C calls.
 * Numbers are `scalar`, double or float. Nothing allocates; an object is memory of the caller, of
 * so many bytes: the file of C++ does not compile where they are too few. An object is neither
 * copied nor moved.
 *
 *   SEPCAL_C_CORRECTION(compass, double, 5, 3, 3, 512)      in a header of yours, for both
 * languages SEPCAL_C_DEFINE_CORRECTION(compass, MODEL)              in a file of C++, with a model
 * as value
 */
#ifndef SEPCAL_CORE_C_H
#define SEPCAL_CORE_C_H

#ifdef __cplusplus
#define SEPCAL_C_BEGIN extern "C" {
#define SEPCAL_C_END }
#define SEPCAL_C_ALIGNED alignas(64)
#else
#define SEPCAL_C_BEGIN
#define SEPCAL_C_END
#if defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define SEPCAL_C_ALIGNED _Alignas(64)
#elif defined(__GNUC__)
#define SEPCAL_C_ALIGNED __attribute__((aligned(64)))
#else
#error "sepcal's objects are aligned by 64 bytes, for which this compiler has no word: use C11"
#endif
#endif

/* NOLINTBEGIN(bugprone-macro-parentheses, readability-identifier-naming): of C, whose names have no
   namespace, and macros of types */
/* What a correction returns. */
enum {
  SEPCAL_CORRECTION_OK = 0,
  SEPCAL_CORRECTION_REFUSED = 1,      /* a number is missing, or a pressure is not above zero */
  SEPCAL_CORRECTION_NOT_CONVERGED = 2 /* no field was found, or the sensor's matrix is singular */
};

/* How far a start is. */
enum {
  SEPCAL_START_COLLECTING = 0,     /* rows are still wanted */
  SEPCAL_START_WORKING = 1,        /* call NAME_work() again */
  SEPCAL_START_DONE = 2,           /* NAME_update() goes on with rows */
  SEPCAL_START_NOT_CONVERGED = 3,  /* no minimum was reached within the iterations */
  SEPCAL_START_NOT_DETERMINED = 4, /* the rows leave a parameter open */
  SEPCAL_START_REFUSED = 5         /* too few rows, or noises that are unfit */
};

/* What an update returns. */
enum {
  SEPCAL_UPDATE_OK = 0,
  SEPCAL_UPDATE_REFUSED = 1,      /* a number is unfit, or the start is not done: nothing changed */
  SEPCAL_UPDATE_NOT_CONVERGED = 2 /* iterations ended by their cap; the last estimate is kept */
};

/*
 * A calibration at work (correction.hpp). Of `inputs` numbers u the model's, drivers among them;
 * NAME_input() says where each stands. A magnetometer in a known field and a tube read `readings`
 * numbers z beside u (3, 1), whose own places in u are not looked at; a five-hole probe and a
 * magnetometer by strength read all in u, and z may be null. `outputs`: the field [uT] (3);
 * airspeed [m/s], alpha, beta [rad] (3); airspeed [m/s] (1); set where the status is ok.
 *
 * void NAME_init(NAME *);                                  no parameter is known
 * int NAME_set(NAME *, const char *parameter, scalar);     1; 0 where the model has none of the
 * name int NAME_input(const char *name);                        its place in u; -1 where there is
 * none int NAME_correct(const NAME *, const scalar u[], const scalar z[], scalar out[]);
 */
#define SEPCAL_C_CORRECTION(name, scalar, inputs, readings, outputs, bytes)                    \
  SEPCAL_C_BEGIN                                                                               \
  enum { name##_inputs = (inputs), name##_readings = (readings), name##_outputs = (outputs) }; \
  typedef scalar name##_scalar;                                                                \
  typedef struct {                                                                             \
    SEPCAL_C_ALIGNED unsigned char memory[bytes];                                              \
  } name;                                                                                      \
  void name##_init(name* correction);                                                          \
  int name##_set(name* correction, const char* parameter, scalar value);                       \
  int name##_input(const char* input);                                                         \
  int name##_correct(const name* correction, const scalar* u, const scalar* z, scalar* out);   \
  SEPCAL_C_END

/*
 * A stream: the two-stage start on the first rows (two_stage_start.hpp), then the iterated filter
 * row by row (joint_filter.hpp), of `parameters` numbers: linear, then nonlinear.
 *
 * void NAME_init(NAME *, const scalar noise[]);            standard deviations of z, up to a factor
 * int NAME_add(NAME *, const scalar u[], const scalar z[]);  1 where the row is kept (z: NaN
 * missing) void NAME_seal(NAME *);                                  begins with the rows that are
 * there int NAME_work(NAME *);                                   a bounded piece of the start: its
 * status int NAME_status(const NAME *); int NAME_update(NAME *, const scalar u[], const scalar
 * z[]);  a row of the filter void NAME_parameters(const NAME *, scalar out[]);        of the
 * filter; NaN before the start is done void NAME_standard_errors(const NAME *, scalar out[]);
 * likewise int NAME_most_calls(const NAME *);                       that end the start, whatever
 * the rows hold int NAME_input(const char *name);                        its place in u, and int
 * NAME_parameter(const char *name);                    among the parameters; -1
 */
#define SEPCAL_C_STREAM(name, scalar, inputs, readings, parameters, bytes) \
  SEPCAL_C_BEGIN                                                           \
  enum {                                                                   \
    name##_inputs = (inputs),                                              \
    name##_readings = (readings),                                          \
    name##_parameter_count = (parameters)                                  \
  };                                                                       \
  typedef scalar name##_scalar;                                            \
  typedef struct {                                                         \
    SEPCAL_C_ALIGNED unsigned char memory[bytes];                          \
  } name;                                                                  \
  void name##_init(name* stream, const scalar* noise);                     \
  int name##_add(name* stream, const scalar* u, const scalar* z);          \
  void name##_seal(name* stream);                                          \
  int name##_work(name* stream);                                           \
  int name##_status(const name* stream);                                   \
  int name##_update(name* stream, const scalar* u, const scalar* z);       \
  void name##_parameters(const name* stream, scalar* out);                 \
  void name##_standard_errors(const name* stream, scalar* out);            \
  int name##_most_calls(const name* stream);                               \
  int name##_input(const char* input);                                     \
  int name##_parameter(const char* parameter);                             \
  SEPCAL_C_END

/*
 * Least squares row by row without a model (information_root.hpp): y = H p + e of `rows` values and
 * `parameters` numbers, e of the standard deviations `noise`.
 *
 * void NAME_init(NAME *);                                  nothing is known
 * int NAME_absorb(NAME *, const scalar H[], const scalar y[], const scalar noise[]);
 *     H row by row, NaN in y where missing; 0 where a number is unfit: nothing is absorbed
 * int NAME_determined(const NAME *);                       1 where the rows determine every number
 * void NAME_solution(const NAME *, scalar out[]);
 * void NAME_standard_errors(const NAME *, scalar out[]);   where noise is right, and all is
 * determined
 */
#define SEPCAL_C_LEAST_SQUARES(name, scalar, parameters, rows, bytes)                      \
  SEPCAL_C_BEGIN                                                                           \
  enum { name##_parameter_count = (parameters), name##_rows = (rows) };                    \
  typedef scalar name##_scalar;                                                            \
  typedef struct {                                                                         \
    SEPCAL_C_ALIGNED unsigned char memory[bytes];                                          \
  } name;                                                                                  \
  void name##_init(name* squares);                                                         \
  int name##_absorb(name* squares, const scalar* H, const scalar* y, const scalar* noise); \
  int name##_determined(const name* squares);                                              \
  void name##_solution(const name* squares, scalar* out);                                  \
  void name##_standard_errors(const name* squares, scalar* out);                           \
  SEPCAL_C_END
/* NOLINTEND(bugprone-macro-parentheses, readability-identifier-naming) */

#endif
