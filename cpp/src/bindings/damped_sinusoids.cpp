// SPDX-License-Identifier: BSD-3-Clause
// Sums of damped sinusoids, 1 to 6 of them: each is a model of its own.
#include "sepcal/models/damped_sinusoids.hpp"

#include <memory>
#include <string>

#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal::bindings {
namespace {

template <int Modes>
std::shared_ptr<const BlockModel> make_sinusoids(int modes) {
  if constexpr (Modes > 6) {
    throw Error("modes is " + std::to_string(modes) + "; there are 1 to 6");
  } else {
    if (modes == Modes) return block_model(DampedSinusoids<Modes>{});
    return make_sinusoids<Modes + 1>(modes);
  }
}

}  // namespace

void define_damped_sinusoids(py::module_& module) {
  module.def("damped_sinusoids", [](int modes) {
    return plain_model("damped-sinusoids-" + std::to_string(modes), make_sinusoids<1>(modes));
  });
}

}  // namespace sepcal::bindings
