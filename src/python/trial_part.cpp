// Trials out of bags, CSV recordings and arrays, and as arrays.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "arrays.h"
#include "long_call.h"
#include "math/parallel.h"
#include "parts.h"
#include "ros/csv_bag.h"
#include "trial/trial_recorder.h"
#include "trial_handle.h"

namespace softarm::python {
namespace {

namespace fs = std::filesystem;

BagTrialHooks hooks_of(LongCall& call) {
  BagTrialHooks hooks;
  hooks.on_total = [&](std::uint64_t messages) { call.add_total(static_cast<double>(messages)); };
  hooks.on_progress = [&](std::uint64_t messages, std::uint64_t) {
    call.advance(static_cast<double>(messages));
  };
  return hooks;
}

std::vector<std::shared_ptr<TrialHandle>> read_bags(const std::shared_ptr<ArmHandle>& arm,
                                                    const std::vector<std::string>& paths, bool use_payload,
                                                    unsigned jobs, const py::object& progress) {
  check_bag_names(paths);
  std::vector<std::shared_ptr<TrialHandle>> trials(paths.size());
  LongCall call(progress);
  call.run([&] {
    const BagTrialHooks hooks = hooks_of(call);
    math::in_parallel(paths.size(), jobs, [&](std::size_t i) {
      trials[i] = std::make_shared<TrialHandle>();
      trials[i]->arm = arm;
      trials[i]->read = read_bag_trial(paths[i], arm->arm, use_payload, hooks);
    });
  });
  return trials;
}

/// A folder of its own that goes with it.
class OwnFolder {
 public:
  OwnFolder() {
    std::string name = (fs::temp_directory_path() / "softarm_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::runtime_error(fmt::format("{}: no folder can be made there", name));
    path_ = name;
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string text_of_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || !text) throw trial::CsvError(path + ": cannot be read");
  return text.str();
}

/// A bag for each trial of the recording.
std::vector<std::string> bags_of_csv(const std::string& layout_path, const std::string& path,
                                     const std::string& inputs, const fs::path& folder, LongCall& call) {
  const std::string text = text_of_file(layout_path);
  const trial::CsvLayout layout = trial::parse_csv_layout(text, layout_path);
  std::vector<std::string> bags;
  std::unique_ptr<CsvBag> bag;
  std::string of_trial;
  trial::CsvSources sources;
  sources.inputs_path = inputs;
  sources.on_bytes = [&](std::uint64_t) { call.advance(0.0); };
  const auto on_row = [&](const trial::CsvRow& row) {
    if (!bag || row.trial != of_trial) {
      if (bag) bag->close();
      of_trial = row.trial;
      std::string name = trial_name(path) + (of_trial.empty() ? "" : "_" + of_trial);
      for (char& c : name) c = c == '/' ? '_' : c;
      bags.push_back((folder / (name + ".bag")).string());
      bag = std::make_unique<CsvBag>(layout, text, bags.back());
    }
    bag->write(row);
  };
  trial::read_csv_recording(layout, path, on_row, sources);
  if (bag) bag->close();
  return bags;
}

/// As `softarm import` and a bag would give it, by that very way.
std::vector<std::shared_ptr<TrialHandle>> read_csv(const std::shared_ptr<ArmHandle>& arm,
                                                   const std::string& layout, const std::string& path,
                                                   const std::string& inputs, bool use_payload,
                                                   const py::object& progress) {
  std::vector<std::shared_ptr<TrialHandle>> trials;
  LongCall call(progress);
  call.run([&] {
    const OwnFolder folder;
    const BagTrialHooks hooks = hooks_of(call);
    for (const std::string& bag : bags_of_csv(layout, path, inputs, folder.path(), call)) {
      trials.push_back(std::make_shared<TrialHandle>());
      trials.back()->arm = arm;
      trials.back()->read = read_bag_trial(bag, arm->arm, use_payload, hooks);
    }
  });
  return trials;
}

/// Poses of all frames: x y z, or an absent one where x is NaN.
struct Poses {
  const double *p = nullptr, *q = nullptr;  // null: none
  std::optional<Eigen::Vector3d> position(Py_ssize_t i) const {
    if (!p || std::isnan(p[3 * i]) || std::isnan(p[3 * i + 1]) || std::isnan(p[3 * i + 2]))
      return std::nullopt;
    return Eigen::Vector3d(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
  }
  std::optional<Eigen::Quaterniond> orientation(Py_ssize_t i) const {
    if (!q || std::isnan(q[4 * i]) || std::isnan(q[4 * i + 1]) || std::isnan(q[4 * i + 2]) ||
        std::isnan(q[4 * i + 3]))
      return std::nullopt;
    return Eigen::Quaterniond(q[4 * i + 3], q[4 * i], q[4 * i + 1], q[4 * i + 2]);
  }
};

/// What a frame is made of, one row per frame; checked.
struct FrameArrays {
  Doubles stamp_s, bodies_p, inputs, payload_kg;
  std::optional<Doubles> bodies_q, base_p, base_q;

  void check(const arm::Arm& arm) const {
    const auto n = static_cast<Py_ssize_t>(stamp_s.size());
    const auto bodies = static_cast<Py_ssize_t>(arm.bodies.size());
    const auto scalars = static_cast<Py_ssize_t>(arm.inputs.scalars.size());
    expect_shape(stamp_s, "stamp_s", {n}, "frames");
    expect_increasing(stamp_s, "stamp_s");
    const auto check_one = [](const Doubles& array, const char* name, const Shape& shape, const char* what) {
      expect_shape(array, name, shape, what);
      expect_numbers(array, name, true);
    };
    check_one(bodies_p, "bodies_p_mocap_m", {n, bodies, 3}, "frames, bodies of the arm, x y z");
    if (bodies_q)
      check_one(*bodies_q, "bodies_q_mocap_xyzw", {n, bodies, 4}, "frames, bodies of the arm, x y z w");
    if (base_p) check_one(*base_p, "base_p_mocap_m", {n, 3}, "frames, x y z");
    if (base_q) check_one(*base_q, "base_q_mocap_xyzw", {n, 4}, "frames, x y z w");
    check_one(inputs, "inputs", {n, scalars}, "frames, inputs of the arm");
    check_one(payload_kg, "payload_kg", {n}, "frames");
    if (arm.base.body && !(base_p && base_q))
      throw std::invalid_argument(fmt::format(
          "base_p_mocap_m, base_q_mocap_xyzw: the arm {} has its base on the body {}, so both are needed",
          arm.name, *arm.base.body));
  }
};

trial::Frame frame_of(const FrameArrays& arrays, const arm::Arm& arm, Py_ssize_t i) {
  trial::Frame frame;
  frame.stamp_ns = trial::to_nanoseconds(arrays.stamp_s.data()[i]);
  const auto bodies = static_cast<Py_ssize_t>(arm.bodies.size());
  const auto scalars = static_cast<Py_ssize_t>(arm.inputs.scalars.size());
  if (arrays.base_p && arrays.base_q) {
    const Poses base{arrays.base_p->data(), arrays.base_q->data()};
    const auto p = base.position(i);
    const auto q = base.orientation(i);
    if (p && q && q->norm() > 0.5) {
      Eigen::Isometry3d pose(q->normalized());
      pose.translation() = *p;
      frame.base_body = pose;
    }
  }
  const Poses poses{arrays.bodies_p.data(), arrays.bodies_q ? arrays.bodies_q->data() : nullptr};
  for (Py_ssize_t k = 0; k < bodies; ++k) {
    if (const auto p = poses.position(i * bodies + k))
      frame.bodies.push_back({static_cast<int>(k), *p, poses.orientation(i * bodies + k)});
  }
  for (Py_ssize_t k = 0; k < scalars; ++k) {
    frame.inputs.push_back(present(arrays.inputs.data()[i * scalars + k]));
    if (frame.inputs.back())
      frame.samples.push_back({static_cast<int>(k), frame.stamp_ns, *frame.inputs.back()});
  }
  frame.payload_kg = present(arrays.payload_kg.data()[i]);
  return frame;
}

std::shared_ptr<TrialHandle> trial_of(std::shared_ptr<ArmHandle> arm, const std::string& name,
                                      const FrameArrays& arrays) {
  arrays.check(arm->arm);
  trial::TrialRecorder recorder(arm->arm, name);
  for (Py_ssize_t i = 0; i < arrays.stamp_s.size(); ++i) recorder.add(frame_of(arrays, arm->arm, i));
  auto handle = std::make_shared<TrialHandle>();
  handle->read.trial = recorder.take();
  handle->read.samples = static_cast<std::uint64_t>(arrays.stamp_s.size());
  handle->arm = std::move(arm);
  return handle;
}

py::dict arrays_of(const TrialHandle& handle) {
  const std::vector<trial::Frame>& frames = handle.read.trial.frames;
  const auto n = static_cast<Py_ssize_t>(frames.size());
  const auto bodies = static_cast<Py_ssize_t>(handle.arm->arm.bodies.size());
  const auto scalars = static_cast<Py_ssize_t>(handle.arm->arm.inputs.scalars.size());
  std::vector<double> stamp, base_p, base_q, payload, inputs;
  std::vector<double> p(static_cast<std::size_t>(3 * n * bodies), kAbsent);
  std::vector<double> q(static_cast<std::size_t>(4 * n * bodies), kAbsent);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const trial::Frame& frame = frames[i];
    stamp.push_back(frame.stamp_s());
    append(payload, frame.payload_kg);
    for (int k = 0; k < 3; ++k)
      append(base_p,
             frame.base_body ? std::optional<double>(frame.base_body->translation()[k]) : std::nullopt);
    const Eigen::Vector4d turned = frame.base_body ? Eigen::Quaterniond(frame.base_body->linear()).coeffs()
                                                   : Eigen::Vector4d(Eigen::Vector4d::Constant(kAbsent));
    base_q.insert(base_q.end(), turned.data(), turned.data() + 4);
    for (const trial::BodyObservation& seen : frame.bodies) {
      const std::size_t at = i * static_cast<std::size_t>(bodies) + static_cast<std::size_t>(seen.body);
      put(&p[3 * at], seen.p_mocap);
      if (seen.q_mocap) put(&q[4 * at], seen.q_mocap->coeffs());  // x y z w
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(scalars); ++k)
      append(inputs, k < frame.inputs.size() ? frame.inputs[k] : std::nullopt);
  }
  py::dict d;
  d["stamp_s"] = array_of(std::move(stamp), {n});
  d["bodies_p_mocap_m"] = array_of(std::move(p), {n, bodies, 3});
  d["bodies_q_mocap_xyzw"] = array_of(std::move(q), {n, bodies, 4});
  d["base_p_mocap_m"] = array_of(std::move(base_p), {n, 3});
  d["base_q_mocap_xyzw"] = array_of(std::move(base_q), {n, 4});
  d["inputs"] = array_of(std::move(inputs), {n, scalars});
  d["payload_kg"] = array_of(std::move(payload), {n});
  return d;
}

py::dict series_of(const TrialHandle& handle) {
  py::dict d;
  for (std::size_t i = 0; i < handle.read.trial.inputs.size(); ++i) {
    const trial::InputSeries& series = handle.read.trial.inputs[i];
    std::vector<double> stamps;
    for (const std::int64_t stamp_ns : series.stamp_ns) stamps.push_back(trial::to_seconds(stamp_ns));
    const auto n = static_cast<Py_ssize_t>(stamps.size());
    std::vector<double> values = series.value;
    d[py::str(handle.arm->arm.inputs.scalars[i].name)] =
        py::make_tuple(array_of(std::move(stamps), {n}), array_of(std::move(values), {n}));
  }
  return d;
}

}  // namespace

void expect_trial_of(const ArmHandle& arm, const TrialHandle& trial) {
  const auto names = [](const arm::Arm& of) {
    std::string all;
    for (const arm::MeasuredBody& body : of.bodies) all += " " + body.name;
    for (const arm::ScalarInput& input : of.inputs.scalars) all += " " + input.name;
    return all;
  };
  if (names(arm.arm) != names(trial.arm->arm))
    throw std::invalid_argument(
        fmt::format("trial {}: was read for the arm {}, whose bodies or inputs are others than those of {}",
                    trial.read.trial.name, trial.arm->arm.name, arm.arm.name));
}

std::vector<trial::Trial> trials_for(const ArmHandle& handle,
                                     const std::vector<std::shared_ptr<TrialHandle>>& trials,
                                     const std::optional<double>& payload_kg, arm::Arm& arm) {
  std::vector<trial::Trial> list;
  for (const std::shared_ptr<TrialHandle>& trial : trials) {
    expect_trial_of(handle, *trial);
    list.push_back(trial->read.trial);
  }
  if (!payload_kg) return list;
  arm::assume_payload(arm, *payload_kg);
  for (trial::Trial& trial : list)
    for (trial::Frame& frame : trial.frames) frame.payload_kg.reset();
  return list;
}

void add_trial(py::module& module) {
  py::class_<TrialHandle, std::shared_ptr<TrialHandle>>(module, "TrialHandle", "A recorded trial.")
      .def_property_readonly("name", [](const TrialHandle& h) { return h.read.trial.name; })
      .def_property_readonly("frames", [](const TrialHandle& h) { return h.read.trial.frames.size(); })
      .def_property_readonly("warnings", [](const TrialHandle& h) { return h.read.warnings; })
      .def_property_readonly("rejected", [](const TrialHandle& h) { return h.read.rejected; })
      .def("arrays", &arrays_of)
      .def("series", &series_of);
  module.def("read_bags", &read_bags, py::arg("arm"), py::arg("paths"), py::arg("use_payload"),
             py::arg("jobs"), py::arg("progress"));
  module.def("read_csv", &read_csv, py::arg("arm"), py::arg("layout"), py::arg("path"), py::arg("inputs"),
             py::arg("use_payload"), py::arg("progress"));
  module.def(
      "trial_of",
      [](std::shared_ptr<ArmHandle> arm, const std::string& name, const Doubles& stamp_s,
         const Doubles& bodies_p, const std::optional<Doubles>& bodies_q,
         const std::optional<Doubles>& base_p, const std::optional<Doubles>& base_q, const Doubles& inputs,
         const Doubles& payload_kg) {
        return trial_of(std::move(arm), name,
                        {stamp_s, bodies_p, inputs, payload_kg, bodies_q, base_p, base_q});
      },
      py::arg("arm"), py::arg("name"), py::arg("stamp_s"), py::arg("bodies_p_mocap_m"),
      py::arg("bodies_q_mocap_xyzw"), py::arg("base_p_mocap_m"), py::arg("base_q_mocap_xyzw"),
      py::arg("inputs"), py::arg("payload_kg"));
}

}  // namespace softarm::python
