// Trials to the constants of an arm's laws.
#include <pybind11/stl.h>

#include "arm/arm_writer.h"
#include "arrays.h"
#include "identify/arm_file_header.h"
#include "identify/identify_extended.h"
#include "long_call.h"
#include "parts.h"
#include "softarm/identify/identify.h"
#include "trial_handle.h"

namespace softarm::python {
namespace {

py::array_t<double> square_of(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  return array_of(std::move(values), {matrix.rows(), matrix.cols()});
}

py::list constants_of(const identify::Result& result) {
  py::list list;
  for (const identify::Constant& c : result.constants) {
    py::dict one;
    one["name"] = c.name;
    one["unit"] = c.unit;
    one["initial"] = c.initial;
    one["value"] = c.value;
    one["sd"] = c.sd;
    one["scale"] = c.scale;
    one["determined"] = c.determined;
    one["at_bound"] = c.at_bound;
    one["kept"] = c.kept;
    one["advice"] = c.advice;
    list.append(one);
  }
  return list;
}

py::dict identify_trials(const std::shared_ptr<ArmHandle>& arm,
                         const std::vector<std::shared_ptr<TrialHandle>>& trials,
                         const std::optional<double>& payload_kg, const identify::Options& options,
                         unsigned jobs, const py::object& progress) {
  arm::Arm start = arm->arm;
  const std::vector<trial::Trial> list = trials_for(*arm, trials, payload_kg, start);
  identify::Result result;
  LongCall call(progress);
  call.run([&] {
    result = identify::identify_extended(
        start, arm->effects, list, options, [&](double share) { call.report(share, "fitting"); }, jobs);
  });
  py::dict d;
  d["arm"] = std::make_shared<ArmHandle>(
      arm::update_arm_text(arm->text, arm->source, result.arm, identify::arm_file_header(result)),
      arm->source);
  d["json"] = identify::to_json(result);
  d["text"] = identify::describe(result);
  d["verdict"] = identify::verdict(result);
  d["generalises"] = identify::generalises(result);
  d["constants"] = constants_of(result);
  d["correlation"] = square_of(result.correlation);
  d["covariance"] = square_of(result.covariance);
  return d;
}

}  // namespace

void add_identify(py::module& module) {
  using identify::Options;
  py::class_<Options>(module, "IdentifyOptions", "As softarm::identify::Options.")
      .def(py::init<>())
      .def_readwrite("free", &Options::free)
      .def_readwrite("also_free", &Options::also_free)
      .def_readwrite("tied", &Options::tied)
      .def_readwrite("held", &Options::held)
      .def_readwrite("held_out", &Options::held_out)
      .def_readwrite("held_out_share", &Options::held_out_share)
      .def_readwrite("seed", &Options::seed)
      .def_readwrite("leave_one_out", &Options::leave_one_out)
      .def_property(
          "frames_per_trial", [](const Options& o) { return o.frames.frames_per_trial; },
          [](Options& o, std::size_t count) { o.frames.frames_per_trial = count; })
      .def_property(
          "prefer_static", [](const Options& o) { return o.frames.prefer_static; },
          [](Options& o, bool flag) { o.frames.prefer_static = flag; })
      .def_readwrite("robust", &Options::robust)
      .def_readwrite("exact_inputs", &Options::exact_inputs);
  module.def("identify", &identify_trials, py::arg("arm"), py::arg("trials"), py::arg("payload_kg"),
             py::arg("options"), py::arg("jobs"), py::arg("progress"));
}

}  // namespace softarm::python
