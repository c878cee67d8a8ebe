// Trials to what an arm file leaves out.
#include <pybind11/stl.h>

#include "arm/arm_writer.h"
#include "diagnose/arm_file_header.h"
#include "effects/catalogue.h"
#include "long_call.h"
#include "parts.h"
#include "report/find_page.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/report/report.h"
#include "trial_handle.h"

namespace softarm::python {
namespace py = pybind11;
namespace {

struct DiagnosisHandle {
  diagnose::Diagnosis diagnosis;
  std::shared_ptr<ArmHandle> extended;  // null: the arm file cannot be edited, and why not
  std::string no_extended;
};

DiagnosisHandle diagnose_trials(const std::shared_ptr<ArmHandle>& arm,
                                const std::vector<std::shared_ptr<TrialHandle>>& trials,
                                const std::optional<double>& payload_kg, diagnose::Options options,
                                const py::object& progress) {
  arm::Arm baseline = arm->arm;
  const std::vector<trial::Trial> list = trials_for(*arm, trials, payload_kg, baseline);
  options.known = arm->effects;
  DiagnosisHandle handle;
  LongCall call(progress);
  call.run([&] {
    handle.diagnosis = diagnose::diagnose(
        baseline, list, options, [&](double share, const std::string& what) { call.report(share, what); });
  });
  handle.diagnosis.version = SOFTARM_VERSION;
  try {
    handle.diagnosis.extended_text = arm::update_arm_text(
        arm->text, arm->source, handle.diagnosis.extended_arm.arm, handle.diagnosis.extended_arm.effects,
        diagnose::arm_file_header(handle.diagnosis, list), "diagnose",
        diagnose::to_string(handle.diagnosis.verdict));
    handle.extended = std::make_shared<ArmHandle>(handle.diagnosis.extended_text, arm->source);
  } catch (const arm::ArmError& why) {
    handle.no_extended = why.what();
  }
  return handle;
}

py::list catalogue() {
  py::list list;
  for (const auto& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    py::dict one;
    one["id"] = info.id;
    one["description"] = info.description;
    one["law"] = info.law;
    one["source"] = info.source;
    one["rivals"] = info.rivals;
    py::list parameters;
    for (const model::Parameter& p : info.parameters) {
      py::dict number;
      number["name"] = p.symbol;
      number["unit"] = p.unit;
      number["description"] = p.description;
      number["low"] = p.low;
      number["high"] = p.high;
      number["usual"] = p.usual;
      parameters.append(number);
    }
    one["parameters"] = parameters;
    list.append(one);
  }
  return list;
}

std::string html_of(const DiagnosisHandle& handle, const std::vector<std::string>& folders,
                    const std::string& command, const std::string& date,
                    const std::vector<std::pair<std::string, std::string>>& sha256) {
  return report::to_html(handle.diagnosis, report::find_page(folders).files, {command, date, sha256});
}

}  // namespace

void add_diagnose(py::module& module) {
  using diagnose::Options;
  py::class_<Options>(module, "DiagnoseOptions", "As softarm::diagnose::Options.")
      .def(py::init<>())
      .def_readwrite("block_s", &Options::block_s)
      .def_readwrite("most_effects", &Options::most_effects)
      .def_readwrite("held", &Options::held)
      .def_readwrite("tied", &Options::tied)
      .def_readwrite("jobs", &Options::jobs);
  py::class_<DiagnosisHandle>(module, "DiagnosisHandle", "A diagnosis.")
      .def_readonly("extended", &DiagnosisHandle::extended)
      .def_readonly("no_extended", &DiagnosisHandle::no_extended)
      .def("text", [](const DiagnosisHandle& h) { return report::describe(h.diagnosis); })
      .def(
          "json",
          [](const DiagnosisHandle& h, const std::string& command, const std::string& date,
             const std::vector<std::pair<std::string, std::string>>& sha256) {
            return report::to_json(h.diagnosis, {command, date, sha256});
          },
          py::arg("command"), py::arg("date"), py::arg("sha256"))
      .def("html", &html_of, py::arg("folders"), py::arg("command"), py::arg("date"), py::arg("sha256"));
  module.def("diagnose", &diagnose_trials, py::arg("arm"), py::arg("trials"), py::arg("payload_kg"),
             py::arg("options"), py::arg("progress"));
  module.def("catalogue", &catalogue);
}

}  // namespace softarm::python
