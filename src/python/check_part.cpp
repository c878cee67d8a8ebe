// What is wrong with recordings.
#include <pybind11/stl.h>

#include <filesystem>

#include "arm_handle.h"
#include "long_call.h"
#include "math/parallel.h"
#include "parts.h"
#include "ros/bag_recording.h"
#include "ros/open_bag.h"
#include "softarm/check/check.h"

namespace softarm::python {
namespace {

namespace py = pybind11;

struct CheckHandle {
  std::string arm;
  std::vector<check::CheckReport> reports;
  std::vector<check::CheckFinding> together;
};

check::CheckReport check_bag(const std::string& path, const arm::Arm& arm, LongCall& call) {
  try {
    return check::check_recording(
        read_recording(
            path, arm, [&](std::uint64_t messages) { call.add_total(static_cast<double>(messages)); },
            [&](std::uint64_t messages) { call.advance(static_cast<double>(messages)); }),
        arm);
  } catch (const BagError& e) {
    return check::unreadable(path, e.what());
  }
}

CheckHandle check_bags(const std::shared_ptr<ArmHandle>& arm, const std::vector<std::string>& paths,
                       unsigned jobs, const py::object& progress) {
  for (const std::string& path : paths) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) throw BagError(path + ": no such bag");
  }
  CheckHandle handle{arm->arm.name, std::vector<check::CheckReport>(paths.size()), {}};
  LongCall call(progress);
  call.run([&] {
    math::in_parallel(paths.size(), jobs,
                      [&](std::size_t i) { handle.reports[i] = check_bag(paths[i], arm->arm, call); });
    handle.together = check::check_together(handle.reports);
  });
  return handle;
}

}  // namespace

void add_check(py::module& module) {
  py::class_<CheckHandle>(module, "CheckHandle", "What was found in recordings.")
      .def(
          "text",
          [](const CheckHandle& h, bool with_information) {
            return check::to_text(h.reports, h.together, with_information);
          },
          py::arg("with_information"))
      .def("json", [](const CheckHandle& h) { return check::to_json(h.reports, h.arm, h.together); });
  module.def("check_bags", &check_bags, py::arg("arm"), py::arg("paths"), py::arg("jobs"),
             py::arg("progress"));
}

}  // namespace softarm::python
