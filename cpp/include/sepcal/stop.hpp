// SPDX-License-Identifier: BSD-3-Clause
// Long work that ends early. Whatever computes asks between two pieces of its work whether it is to
// go on; no option and no result knows of it.
//
//   std::stop_source source;  // source.request_stop() from any thread
//   const sepcal::StopScope scope(source.get_token());
//   const sepcal::Fit fit = sepcal::fit(model, record);  // or throws sepcal::Stopped
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <stop_token>

namespace sepcal {

namespace base {
struct Stop;
}

/// What comes out of work that a token stopped. No Error: nothing was wrong.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped, as was asked"; }
};

/// While it lives, all that its thread has sepcal compute, on however many threads, may be stopped.
/// What was stopped throws and has no result; files appear whole or not at all. One scope within
/// another is heeded in its place.
class StopScope {
 public:
  /// Throws Stopped out of the work, mostly within a tenth of a second of the request.
  explicit StopScope(std::stop_token token);

  /// Calls `ask` on this thread alone, every 50 ms while it works. What `ask` throws ends the work
  /// and comes out of it.
  explicit StopScope(std::function<void()> ask);

  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;
  ~StopScope();

 private:
  std::unique_ptr<base::Stop> stop_;
  base::Stop* outer_;
};

}  // namespace sepcal
