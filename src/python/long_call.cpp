#include "long_call.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <thread>
#include <utility>

#include "math/stop.h"

namespace softarm::python {
namespace py = pybind11;
namespace {

constexpr std::chrono::milliseconds kLook(50);

}  // namespace

void LongCall::report(double share, const std::string& what) {
  if (stop_) throw Stopped();
  const std::lock_guard<std::mutex> lock(mutex_);
  share_ = std::max(share_, share);
  what_ = what;
  news_ = true;
}

void LongCall::add_total(double work) {
  const std::lock_guard<std::mutex> lock(mutex_);
  total_ += work;
}

void LongCall::advance(double work) {
  if (stop_) throw Stopped();
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += work;
  // A total that grows must not make the share fall.
  share_ = std::max(share_, total_ > 0.0 ? std::min(1.0, done_ / total_) : 0.0);
  news_ = true;
}

bool LongCall::tell() {
  if (PyErr_CheckSignals() != 0) return false;
  double share = 0.0;
  std::string what;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!std::exchange(news_, false) || progress_.is_none()) return true;
    share = share_;
    what = what_;
  }
  try {
    progress_(share, what);
  } catch (py::error_already_set& error) {
    error.restore();
    return false;
  }
  return true;
}

void LongCall::run(const std::function<void()>& work) {
  std::exception_ptr failure;
  bool done = false;
  std::mutex mutex;
  std::condition_variable ended;
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  {
    const py::gil_scoped_release release;
    const std::function<void()> ask = [this] {
      if (stop_) throw Stopped();
    };
    std::thread worker([&] {
      const math::StopScope scope(&ask);
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard<std::mutex> lock(mutex);
      done = true;
      ended.notify_all();
    });
    std::unique_lock<std::mutex> lock(mutex);
    while (!ended.wait_for(lock, kLook, [&] { return done; })) {
      lock.unlock();
      if (!stop_) {
        const py::gil_scoped_acquire acquire;
        if (!tell()) {
          PyErr_Fetch(&type, &value, &trace);
          stop_ = true;
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (!stop_ && !failure && !tell()) throw py::error_already_set();  // the last news
  if (stop_) {
    PyErr_Restore(type, value, trace);
    throw py::error_already_set();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace softarm::python
