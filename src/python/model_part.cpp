// Shapes and Jacobians.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <mutex>

#include "arm_handle.h"
#include "arrays.h"
#include "long_call.h"
#include "model/extended_statics.h"
#include "parts.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::python {
namespace {

using model::ExtendedStatics;
using model::StaticLoad;

/// Row by row into one vector.
void append_rows(std::vector<double>& to, const Eigen::MatrixXd& rows) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (Eigen::Index j = 0; j < rows.cols(); ++j) to.push_back(rows(i, j));
}

struct Results {
  std::vector<std::int8_t> outcome;
  std::vector<double> points, quaternions, curvature, force, moment, bodies, tangents;
  std::vector<double> actuation, direction, stiffness, length;
  std::vector<double> by_inputs, by_payload, by_gravity, by_constants;
};

/// An arm's statics, its effects in it, for one thread at a time.
class ModelHandle {
 public:
  ModelHandle(Arm arm, const std::vector<double>& points_m, const std::vector<std::string>& constants)
      : arm_(std::move(arm)), points_(points_m.size()), statics_(arm_->arm, arm_->effects, points_m) {
    for (const std::string& name : constants) constants_.push_back(arm_->constant(name));
  }

  /// @param stamp_s instants of one trial; absent: each is one of its own
  py::dict solve(const Doubles& inputs, const Doubles& payload_kg, const Doubles& gravity_base,
                 const std::optional<Doubles>& stamp_s, bool derivatives, const py::object& progress) {
    const Py_ssize_t count = inputs.ndim() == 2 ? inputs.shape(0) : 0;
    check(inputs, payload_kg, gravity_base, stamp_s, count);
    const double *input = inputs.data(), *payload = payload_kg.data(), *gravity = gravity_base.data();
    const double* stamp = stamp_s ? stamp_s->data() : nullptr;
    const auto scalars = static_cast<Py_ssize_t>(arm_->arm.inputs.scalars.size());
    Results out;
    LongCall call(progress);
    call.run([&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      call.add_total(static_cast<double>(count));
      statics_.begin_trial();
      for (Py_ssize_t i = 0; i < count; ++i) {
        StaticLoad load;
        for (Py_ssize_t k = 0; k < scalars; ++k) load.inputs.emplace_back(input[i * scalars + k]);
        load.payload_kg = payload[i];
        load.gravity_base = Eigen::Map<const Eigen::Vector3d>(gravity + 3 * i);
        add(stamp ? statics_.solve_next(stamp[i], load) : statics_.solve(load), load, derivatives, out);
        call.advance(1.0);
      }
    });
    return dict_of(std::move(out), count, derivatives);
  }

  /// Which effects are in it, and what the file says against them.
  std::vector<std::string> notes() const {
    std::vector<std::string> list = statics_.notes();
    const std::string doubt = effects::doubt_about_effects(arm::ArmText{arm_->text, arm_->source});
    if (!doubt.empty()) list.push_back(doubt);
    return list;
  }

 private:
  void check(const Doubles& inputs, const Doubles& payload_kg, const Doubles& gravity_base,
             const std::optional<Doubles>& stamp_s, Py_ssize_t count) const {
    const auto scalars = static_cast<Py_ssize_t>(arm_->arm.inputs.scalars.size());
    expect_shape(inputs, "inputs", {count, scalars}, "instants, inputs of the arm");
    expect_shape(payload_kg, "payload_kg", {count}, "instants");
    expect_shape(gravity_base, "gravity_base_m_s2", {count, 3}, "instants, x y z");
    expect_numbers(inputs, "inputs", false);
    expect_numbers(payload_kg, "payload_kg", false);
    expect_numbers(gravity_base, "gravity_base_m_s2", false);
    for (Py_ssize_t i = 0; i < count; ++i)
      if (payload_kg.at(i) < 0.0)
        throw std::invalid_argument(fmt::format("payload_kg: {} kg; must be 0 or more", payload_kg.at(i)));
    if (stamp_s) {
      expect_shape(*stamp_s, "stamp_s", {count}, "instants");
      expect_increasing(*stamp_s, "stamp_s");
    }
  }

  void append_shape(Results& out, bool solved) const {
    for (int i = 0; i < static_cast<int>(points_); ++i) {
      const rod::RodState state = solved ? statics_.point(i) : rod::RodState();
      append(out.points, state.p);
      for (const double c : {state.q.x(), state.q.y(), state.q.z(), state.q.w()})
        out.quaternions.push_back(c);
      append(out.curvature, state.u);
      append(out.force, state.n);
      append(out.moment, state.m);
    }
    for (int i = 0; i < static_cast<int>(arm_->arm.bodies.size()); ++i) {
      append(out.bodies, solved ? statics_.body_position(i) : Eigen::Vector3d::Zero());
      append(out.tangents, solved ? statics_.body_tangent(i) : Eigen::Vector3d::Zero());
    }
    for (std::size_t i = 0; i < arm_->arm.segments.size(); ++i) {
      const arm::SegmentPrediction law = solved ? statics_.laws()[i] : arm::SegmentPrediction();
      const Eigen::Vector2d moment = law.actuation_nm();
      out.actuation.push_back(moment.norm());
      out.direction.push_back(std::atan2(moment.y(), moment.x()));
      out.stiffness.push_back(law.bending_stiffness_nm2);
      out.length.push_back(law.length_m);
    }
  }

  void add(ExtendedStatics::Outcome outcome, const StaticLoad& load, bool derivatives, Results& out) {
    const bool solved = outcome == ExtendedStatics::Outcome::kSolved;
    out.outcome.push_back(static_cast<std::int8_t>(outcome));
    append_shape(out, solved);
    if (!derivatives) return;
    const auto rows = static_cast<Eigen::Index>(3 * (arm_->arm.bodies.size() + points_));
    const auto put_rows = [&](std::vector<double>& to, Eigen::Index columns, auto derivative) {
      append_rows(to, solved ? Eigen::MatrixXd(derivative()) : Eigen::MatrixXd::Zero(rows, columns));
    };
    put_rows(out.by_inputs, static_cast<Eigen::Index>(load.inputs.size()),
             [&] { return statics_.by_inputs(); });
    put_rows(out.by_payload, 1, [&] { return statics_.by_payload(); });
    put_rows(out.by_gravity, 3, [&] { return statics_.by_gravity(); });
    put_rows(out.by_constants, static_cast<Eigen::Index>(constants_.size()),
             [&] { return statics_.by_constants(constants_); });
  }

  py::dict dict_of(Results&& r, Py_ssize_t n, bool derivatives) const {
    const auto points = static_cast<Py_ssize_t>(points_);
    const auto bodies = static_cast<Py_ssize_t>(arm_->arm.bodies.size());
    const auto segments = static_cast<Py_ssize_t>(arm_->arm.segments.size());
    const auto inputs = static_cast<Py_ssize_t>(arm_->arm.inputs.scalars.size());
    py::dict d;
    d["outcome"] = array_of(std::move(r.outcome), {n});
    d["p_base_m"] = array_of(std::move(r.points), {n, points, 3});
    d["q_base_xyzw"] = array_of(std::move(r.quaternions), {n, points, 4});
    d["curvature_per_m"] = array_of(std::move(r.curvature), {n, points, 3});
    d["force_base_n"] = array_of(std::move(r.force), {n, points, 3});
    d["moment_base_nm"] = array_of(std::move(r.moment), {n, points, 3});
    d["bodies_p_base_m"] = array_of(std::move(r.bodies), {n, bodies, 3});
    d["bodies_tangent_base"] = array_of(std::move(r.tangents), {n, bodies, 3});
    d["M0_nm"] = array_of(std::move(r.actuation), {n, segments});
    d["phi_rad"] = array_of(std::move(r.direction), {n, segments});
    d["EI_nm2"] = array_of(std::move(r.stiffness), {n, segments});
    d["L_m"] = array_of(std::move(r.length), {n, segments});
    if (!derivatives) return d;
    const Py_ssize_t all = bodies + points;
    d["by_inputs"] = array_of(std::move(r.by_inputs), {n, all, 3, inputs});
    d["by_payload"] = array_of(std::move(r.by_payload), {n, all, 3});
    d["by_gravity"] = array_of(std::move(r.by_gravity), {n, all, 3, 3});
    d["by_constants"] =
        array_of(std::move(r.by_constants), {n, all, 3, static_cast<Py_ssize_t>(constants_.size())});
    return d;
  }

  Arm arm_;
  std::size_t points_;
  std::vector<arm::ConstantRef> constants_;
  std::mutex mutex_;
  ExtendedStatics statics_;
};

}  // namespace

void add_model(py::module& module) {
  py::class_<ModelHandle>(module, "ModelHandle", "An arm's laws and rod.")
      .def(py::init([](std::shared_ptr<ArmHandle> arm, const std::vector<double>& points_m,
                       const std::vector<std::string>& constants) {
             return std::make_unique<ModelHandle>(std::move(arm), points_m, constants);
           }),
           py::arg("arm"), py::arg("points_m"), py::arg("constants"))
      .def("solve", &ModelHandle::solve, py::arg("inputs"), py::arg("payload_kg"),
           py::arg("gravity_base_m_s2"), py::arg("stamp_s"), py::arg("derivatives"), py::arg("progress"))
      .def("notes", &ModelHandle::notes);
}

}  // namespace softarm::python
