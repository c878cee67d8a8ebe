// Estimates of frames, trials and bags.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <map>
#include <mutex>

#include "arrays.h"
#include "estimate/estimate_summary.h"
#include "estimate_table.h"
#include "long_call.h"
#include "math/parallel.h"
#include "mismatch_table.h"
#include "parts.h"
#include "ros/bag_frames.h"
#include "softarm/effects/arm_effects.h"
#include "trial_handle.h"

namespace softarm::python {
namespace {

/// As the options of `softarm estimate`; absent: the arm file's.
struct EstimateOptions {
  std::optional<std::string> method, unknown, objective, dynamics;
  std::optional<bool> prior, robust;
  std::optional<double> window_s, payload_kg;
  int backbone_points = 21;
  double alarm_threshold_sd = monitor::MismatchMonitorParams().threshold_sd;  ///< of the live monitor
};

template <typename Parse>
auto word(const char* option, const std::string& text, Parse parse) {
  try {
    return parse(text);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", option, e.what()));
  }
}

arm::Arm arm_with(const ArmHandle& handle, const EstimateOptions& options) {
  arm::Arm arm = handle.arm;
  if (options.method) arm.estimator.method = word("method", *options.method, arm::parse_method);
  if (options.unknown) arm.estimator.unknown = word("unknown", *options.unknown, arm::parse_unknown);
  if (options.objective)
    arm.estimator.objective = word("objective", *options.objective, arm::parse_objective);
  if (options.dynamics) arm.estimator.dynamics = word("dynamics", *options.dynamics, arm::parse_dynamics);
  if (options.prior) arm.estimator.prior.enabled = *options.prior;
  if (options.robust) arm.estimator.robust = *options.robust;
  if (options.window_s) {
    if (!(*options.window_s >= 0.0 && *options.window_s <= 60.0))
      throw std::invalid_argument(fmt::format("window_s: {}; must be from 0 to 60 s", *options.window_s));
    arm.estimator.window_s = *options.window_s;
  }
  if (options.payload_kg) arm::assume_payload(arm, *options.payload_kg);
  if (options.backbone_points < 2 || options.backbone_points > 1000)
    throw std::invalid_argument(
        fmt::format("backbone_points: {}; must be from 2 to 1000", options.backbone_points));
  return arm;
}

monitor::MismatchMonitorParams monitor_params(const EstimateOptions& options) {
  if (!(options.alarm_threshold_sd >= 3.0 && options.alarm_threshold_sd <= 1e6))
    throw std::invalid_argument(fmt::format(
        "alarm_threshold_sd: {}; must be from 3 to 1e6 standard deviations", options.alarm_threshold_sd));
  monitor::MismatchMonitorParams params;
  params.threshold_sd = options.alarm_threshold_sd;
  return params;
}

/// One stream of frames, for one thread at a time.
class EstimatorHandle {
 public:
  EstimatorHandle(std::shared_ptr<ArmHandle> arm, const EstimateOptions& options)
      : handle_(std::move(arm)),
        options_(options),
        arm_(arm_with(*handle_, options)),
        estimator_(arm_, arm_.estimator, handle_->effects),
        monitor_(arm_, monitor_params(options)) {
    estimator_.set_backbone_points(options.backbone_points);
  }

  /// What came of a stretch of frames.
  struct Part {
    EstimateTable table;
    MismatchTable mismatch;
    estimate::EstimateSummary summary;
    std::map<std::string, std::uint64_t> rejected;
    std::uint64_t samples = 0;
    std::vector<std::string> warnings;
    py::dict take(const std::string& name) {
      py::dict d = table.take();
      d["name"] = name;
      d["summary"] = summary.text(rejected, samples) + mismatch.text();
      d["mismatch"] = mismatch.take();
      d["warnings"] = warnings;
      return d;
    }
  };
  Part new_part() const {
    return {EstimateTable(arm_, options_.backbone_points), {}, estimate::EstimateSummary(arm_), {}, 0, {}};
  }

  void add(const trial::Frame& frame, Part& part) {
    const estimate::Estimate& estimate = estimator_.estimate(frame);
    part.table.add(estimate);
    part.summary.add(estimate);
    const estimate::Estimator::ByLaws plain = estimator_.by_laws();
    part.mismatch.add(monitor_.add(plain.frame, plain.estimate));
  }

  void forget(Part& part) {
    estimator_.reset();
    monitor_.reset();
    part.mismatch.interrupt();
  }

  void add(const TrialHandle& trial, LongCall& call, Part& part) {
    const std::lock_guard<std::mutex> lock(mutex_);
    call.add_total(static_cast<double>(trial.read.trial.frames.size()));
    auto jump = trial.read.after_jumps.begin();
    for (std::size_t i = 0; i < trial.read.trial.frames.size(); ++i) {
      if (jump != trial.read.after_jumps.end() && *jump == i) {
        forget(part);
        ++jump;
      }
      trial::Frame frame = trial.read.trial.frames[i];
      if (options_.payload_kg) frame.payload_kg.reset();  // the given one counts
      add(frame, part);
      if (i % 16 == 0) call.advance(16.0);
    }
    part.rejected = trial.read.rejected;
    part.samples = trial.read.samples;
    part.warnings = trial.read.warnings;
  }

  /// As `softarm estimate` does it, without keeping the frames.
  void add_bag(const std::string& path, LongCall& call, Part& part) {
    const std::lock_guard<std::mutex> lock(mutex_);
    BagFrames bag(path, arm_, !options_.payload_kg);
    call.add_total(static_cast<double>(bag.messages()));
    BagFrames::Callbacks callbacks;
    callbacks.on_frame = [&](const trial::Frame& frame) { add(frame, part); };
    callbacks.on_time_jump = [&] { forget(part); };
    callbacks.on_messages = [&](std::uint64_t messages) { call.advance(static_cast<double>(messages)); };
    bag.read(callbacks);
    part.rejected = bag.assembler().rejected();
    part.samples = bag.assembler().samples();
    part.warnings = bag.warnings();
    if (part.table.frames() == 0)
      throw BagError(fmt::format("{}: no frame could be put together out of {} samples", path, part.samples));
  }

  py::dict estimate_trial(const TrialHandle& trial, const py::object& progress) {
    expect_trial_of(*handle_, trial);
    Part part = new_part();
    LongCall call(progress);
    call.run([&] { add(trial, call, part); });
    return part.take(trial.read.trial.name);
  }

  /// Without a thread of its own: a frame takes a tenth of a millisecond.
  py::dict estimate_frame(const TrialHandle& frame) {
    expect_trial_of(*handle_, frame);
    Part part = new_part();
    {
      const py::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      for (trial::Frame one : frame.read.trial.frames) {
        if (options_.payload_kg) one.payload_kg.reset();
        add(one, part);
      }
    }
    return part.take(frame.read.trial.name);
  }

  void reset() {
    const std::lock_guard<std::mutex> lock(mutex_);
    estimator_.reset();
    monitor_.reset();
  }
  std::vector<std::string> notes() const {
    std::vector<std::string> list = estimator_.effect_notes();
    for (const std::string& doubt :
         {effects::doubt_about_effects(arm::ArmText{handle_->text, handle_->source}),
          estimate::advice(arm_.estimator)})
      if (!doubt.empty()) list.push_back(doubt);
    return list;
  }

 private:
  std::shared_ptr<ArmHandle> handle_;
  EstimateOptions options_;
  arm::Arm arm_;
  std::mutex mutex_;
  estimate::Estimator estimator_;
  monitor::MismatchMonitor monitor_;
};

py::list estimate_bags(const std::shared_ptr<ArmHandle>& arm, const std::vector<std::string>& paths,
                       const EstimateOptions& options, unsigned jobs, const py::object& progress) {
  check_bag_names(paths);
  std::vector<std::unique_ptr<EstimatorHandle>> estimators;
  std::vector<EstimatorHandle::Part> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    estimators.push_back(std::make_unique<EstimatorHandle>(arm, options));
    parts.push_back(estimators.back()->new_part());
  }
  LongCall call(progress);
  call.run([&] {
    math::in_parallel(paths.size(), jobs,
                      [&](std::size_t i) { estimators[i]->add_bag(paths[i], call, parts[i]); });
  });
  py::list list;
  for (std::size_t i = 0; i < paths.size(); ++i) list.append(parts[i].take(trial_name(paths[i])));
  return list;
}

std::vector<std::string> statuses() {
  std::vector<std::string> words;
  for (int i = 0; i <= static_cast<int>(estimate::Status::kInconsistent); ++i)
    words.push_back(to_string(static_cast<estimate::Status>(i)));
  return words;
}

}  // namespace

void add_estimate(py::module& module) {
  py::class_<EstimateOptions>(module, "EstimateOptions", "None: as the arm file has it.")
      .def(py::init<>())
      .def_readwrite("method", &EstimateOptions::method)
      .def_readwrite("unknown", &EstimateOptions::unknown)
      .def_readwrite("objective", &EstimateOptions::objective)
      .def_readwrite("dynamics", &EstimateOptions::dynamics)
      .def_readwrite("prior", &EstimateOptions::prior)
      .def_readwrite("robust", &EstimateOptions::robust)
      .def_readwrite("window_s", &EstimateOptions::window_s)
      .def_readwrite("payload_kg", &EstimateOptions::payload_kg)
      .def_readwrite("backbone_points", &EstimateOptions::backbone_points)
      .def_readwrite("alarm_threshold_sd", &EstimateOptions::alarm_threshold_sd);
  py::class_<EstimatorHandle>(module, "EstimatorHandle", "One stream of frames.")
      .def(py::init<std::shared_ptr<ArmHandle>, const EstimateOptions&>(), py::arg("arm"), py::arg("options"))
      .def("estimate_trial", &EstimatorHandle::estimate_trial, py::arg("trial"), py::arg("progress"))
      .def("estimate_frame", &EstimatorHandle::estimate_frame, py::arg("frame"))
      .def("reset", &EstimatorHandle::reset)
      .def("notes", &EstimatorHandle::notes);
  module.def("estimate_bags", &estimate_bags, py::arg("arm"), py::arg("paths"), py::arg("options"),
             py::arg("jobs"), py::arg("progress"));
  module.def("statuses", &statuses);
  module.def("change_kinds", &change_kinds);
  module.def("mismatch_axes", &mismatch_axes);
}

}  // namespace softarm::python
