// Work that takes long, called from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>

namespace softarm::python {

/// Runs work on a thread of its own, without Python's lock, while the calling thread waits for it, looks for
/// Ctrl-C and hands progress on. Progress is so always told on the thread that called.
class LongCall {
 public:
  /// @param progress called with (share done, what is being done), or None
  explicit LongCall(pybind11::object progress) : progress_(std::move(progress)) {}

  /// Returns once the work is done. Ctrl-C, or an exception of the callback, ends it at its next report
  /// or piece (math::StopScope); work that ended otherwise is rethrown.
  /// @throws pybind11::error_already_set for the two
  void run(const std::function<void()>& work);

  // For the work, from any of its threads. They throw where it is to end: work lets that pass.
  void report(double share, const std::string& what = "");
  /// More to be done, and some of it done, in any unit.
  void add_total(double work);
  void advance(double work);

 private:
  struct Stopped {};
  bool tell();

  pybind11::object progress_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  double total_ = 0.0, done_ = 0.0, share_ = 0.0;
  std::string what_;
  bool news_ = false;
};

}  // namespace softarm::python
