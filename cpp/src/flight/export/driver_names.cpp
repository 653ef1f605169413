// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/driver_names.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace sepcal::exporting {
namespace {

constexpr std::array known_channels{
    KnownChannel{"p", "p_radps", "rad/s", {0.1, -0.2, 0.3}},
    KnownChannel{"q", "q_radps", "rad/s", {0.05, -0.1, 0.2}},
    KnownChannel{"r", "r_radps", "rad/s", {-0.1, 0.2, 0.05}},
    KnownChannel{"roll", "roll_rad", "rad", {0.1, -0.3, 0.5}},
    KnownChannel{"pitch", "pitch_rad", "rad", {0.05, -0.1, 0.2}},
    KnownChannel{"yaw", "yaw_rad", "rad", {0.5, -1.0, 2.0}},
    KnownChannel{"ps", "ps_pa", "Pa, static pressure", {95000.0, 90000.0, 101000.0}},
    KnownChannel{"dp", "dp_pa", "Pa, differential pressure", {120.0, 250.0, 400.0}},
    KnownChannel{"rho", "rho_kgpm3", "kg/m^3, density of the air", {1.2, 1.1, 1.05}},
    KnownChannel{"temperature", "temp_k", "K, of the air", {280.0, 290.0, 300.0}}};

/// Words of C and C++ and of what compilers add, names of the header itself, and macros: those of
/// math.h and of vehicles' own headers are in capitals.
bool is_reserved(const std::string& name) {
  static const std::set<std::string, std::less<>> words{
      "alignas", "asm", "auto", "bool", "break", "case", "catch", "char", "class", "const",
      "continue", "default", "delete", "do", "double", "else", "enum", "explicit", "export",
      "extern", "false", "float", "for", "friend", "goto", "if", "inline", "int", "long", "mutable",
      "namespace", "new", "operator", "private", "protected", "public", "register", "restrict",
      "return", "short", "signed", "sizeof", "static", "struct", "switch", "template", "this",
      "throw", "true", "try", "typedef", "typename", "union", "unsigned", "using", "virtual",
      "void", "volatile", "while", "and", "or", "not", "xor", "compl", "bitand", "bitor", "not_eq",
      "concept", "requires", "nullptr", "noexcept", "decltype", "and_eq", "or_eq", "xor_eq",
      "bitor", "alignof", "char8_t", "char16_t", "char32_t", "wchar_t", "co_await", "co_return",
      "co_yield", "const_cast", "dynamic_cast", "reinterpret_cast", "static_cast", "consteval",
      "constexpr", "constinit", "static_assert", "thread_local", "typeid", "typeof",
      "typeof_unqual", "complex", "imaginary", "linux", "unix", "i386", "math_errhandling", "far",
      "near", "main", "std",
      // of the correction itself
      "A", "J", "F", "constants", "spline", "correct", "self_test", "ok", "bad_input",
      "no_solution", "outside", "calibration_id", "crc", "is_extrapolated", "pt_less_ps_pa", "h_ut",
      "m_ut", "alpha_read", "beta_read", "pressure", "read", "met", "i", "j", "step", "det",
      "change", "largest", "airspeed_mps", "airspeed_cal_mps", "pt_pa", "dpa_pa", "dpb_pa",
      "alpha_cal_rad", "beta_cal_rad", "u", "v", "w", "y", "z", "pow", "fabs", "sqrt", "sin", "cos",
      "atan2", "asin", "isfinite", "expm1", "log1p", "powf", "fabsf", "sqrtf", "sinf", "cosf",
      "atan2f", "asinf", "expm1f", "log1pf", "alpha", "beta", "square", "side", "below", "in",
      "out", "got", "says", "size", "status", "row", "at", "k",
      // macros of the C library that are no functions
      "errno", "stdin", "stdout", "stderr", "sa_handler", "sa_sigaction", "st_atime", "st_ctime",
      "st_mtime", "environ", "signgam"};
  const bool in_capitals = std::ranges::none_of(name, [](char c) { return c >= 'a' && c <= 'z'; });
  return in_capitals || words.contains(name) || name.starts_with("x_") ||
         name.starts_with("sepcal");
}

}  // namespace

const KnownChannel* find_known(std::string_view channel) {
  const auto* const found = std::ranges::find_if(known_channels, [&](const KnownChannel& one) {
    return one.channel == channel || one.argument == channel;
  });
  return found == known_channels.end() ? nullptr : found;
}

std::map<std::string, std::string, std::less<>> names_of_readings(const Exporter& exporter,
                                                                  bool single) {
  auto names = exporter.readings;
  if (single && exporter.by_difference) {
    for (const char* pressure : {"pt", "ps", "pt_pa", "ps_pa"}) names.erase(pressure);
  }
  return names;
}

std::string identifier(const std::string& header) {
  std::string name;
  for (const char c : header) {
    const auto byte = static_cast<unsigned char>(c);
    name += std::isalnum(byte) != 0 && byte < 128 ? c : '_';
  }
  const bool starts_well = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0;
  if (!starts_well || name[0] == '_') name.insert(0, "column_");
  return is_reserved(name) ? name + "_in" : name;
}

}  // namespace sepcal::exporting
