#include "belonging.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "compare_frames.h"

namespace softarm::identify {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;

constexpr double kFarthest = 0.4;           // of the length, mean over bodies and frames
constexpr double kExplains = 0.2;           // of the length, that a reading may leave to be named
constexpr std::size_t kFramesOfTrial = 20;  // that each reading is tried on

/// What one reading makes of a pose as it was read.
using OfPosition = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;
using OfOrientation = std::function<Quaterniond(const Quaterniond&)>;

std::vector<trial::Trial> read_otherwise(std::vector<trial::Trial> trials, const OfPosition& p,
                                         const OfOrientation& q) {
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      if (frame.base_body) {
        Isometry3d base = Isometry3d::Identity();
        base.linear() = q(Quaterniond(frame.base_body->linear())).toRotationMatrix();
        base.translation() = p(frame.base_body->translation());
        frame.base_body = base;
      }
      for (trial::BodyObservation& body : frame.bodies) {
        body.p_mocap = p(body.p_mocap);
        if (body.q_mocap) body.q_mocap = q(*body.q_mocap);
      }
    }
  }
  return trials;
}

Eigen::Vector3d same_position(const Eigen::Vector3d& p) {
  return p;
}
Quaterniond same_orientation(const Quaterniond& q) {
  return q;
}

/// A few frames of each trial, evenly spaced: which are usable depends on how they are read.
std::vector<trial::Trial> thinned(const std::vector<trial::Trial>& trials) {
  std::vector<trial::Trial> few;
  for (const trial::Trial& trial : trials) {
    trial::Trial some{trial.name, {}, trial.inputs};
    const std::size_t count = std::min(kFramesOfTrial, trial.frames.size());
    for (std::size_t k = 0; k < count; ++k)
      some.frames.push_back(trial.frames[k * trial.frames.size() / count]);
    few.push_back(std::move(some));
  }
  return few;
}

/// Mean shape error; nothing where no frame can be predicted.
std::optional<double> error_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  FrameChoice all;
  all.frames_per_trial = 0;
  all.prefer_static = false;
  const ShapeError error = shape_error(arm, trials, all);
  if (error.frames == 0) return std::nullopt;
  return error.mean_m;
}

/// "x -z y": the axes that were read, along those of the mocap frame.
std::string axes_name(const Matrix3d& m) {
  std::string name;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (m(row, column) == 0.0) continue;
      name += fmt::format("{}{}{}", row > 0 ? " " : "", m(row, column) < 0.0 ? "-" : "", "xyz"[column]);
    }
  }
  return name;
}

/// The 24 turns that take axes to axes, the identity first.
std::vector<Matrix3d> turns() {
  std::vector<Matrix3d> list;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d m = Matrix3d::Zero();
      for (int row = 0; row < 3; ++row)
        m(row, order[static_cast<std::size_t>(row)]) = (signs >> row) % 2 == 0 ? 1.0 : -1.0;
      if (m.determinant() > 0.0) list.push_back(m);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return list;
}

}  // namespace

Belonging belonging(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  Belonging result;
  result.length_m = arm.total_length_m();
  const std::vector<trial::Trial> few = thinned(trials);
  const std::optional<double> given = error_of(arm, few);
  result.mean_m = given;
  result.together = given && *given <= kFarthest * result.length_m;
  if (result.together) return result;
  const auto try_reading = [&](const std::string& name, const arm::Arm& with,
                               const std::vector<trial::Trial>& read) {
    if (const std::optional<double> error = error_of(with, read)) result.tried.push_back({name, *error});
  };
  for (const Matrix3d& m : turns()) {
    if (m.isIdentity()) continue;
    const Quaterniond turn(m);
    try_reading(fmt::format("axes '{}' (inputs.bodies.axes of the arm file, or mocap.axes of the layout)",
                            axes_name(m)),
                arm,
                read_otherwise(
                    few, [&](const Eigen::Vector3d& p) { return Eigen::Vector3d(m * p); },
                    [&](const Quaterniond& q) { return turn * q * turn.conjugate(); }));
    if (!arm.base.body) continue;
    arm::Arm turned = arm;
    turned.base.rod_in_body.linear() = turned.base.rod_in_body.linear() * m;
    try_reading(fmt::format("base.rod_in_body turned to its axes '{}'", axes_name(m)), turned, few);
  }
  for (const auto& [factor, name] :
       {std::pair(1e-3, "positions in mm"), std::pair(1e3, "positions in km, or divided by 1000 twice"),
        std::pair(1e-2, "positions in cm"), std::pair(0.0254, "positions in inches"),
        std::pair(10.0, "positions ten times as large"),
        std::pair(100.0, "positions a hundred times as large")})
    try_reading(name, arm,
                read_otherwise(
                    few, [factor = factor](const Eigen::Vector3d& p) { return Eigen::Vector3d(factor * p); },
                    same_orientation));
  try_reading("quaternions in the order w, x, y, z", arm,
              read_otherwise(few, same_position,
                             [](const Quaterniond& q) { return Quaterniond(q.x(), q.y(), q.z(), q.w()); }));
  try_reading("quaternions in the order x, y, z, w", arm,
              read_otherwise(few, same_position,
                             [](const Quaterniond& q) { return Quaterniond(q.z(), q.w(), q.x(), q.y()); }));
  try_reading("quaternions that turn the other way", arm,
              read_otherwise(few, same_position, [](const Quaterniond& q) { return q.conjugate(); }));
  std::stable_sort(result.tried.begin(), result.tried.end(),
                   [](const Reading& a, const Reading& b) { return a.mean_m < b.mean_m; });
  return result;
}

std::string describe(const Belonging& belonging) {
  const bool explained =
      !belonging.tried.empty() && belonging.tried.front().mean_m <= kExplains * belonging.length_m;
  // Frames of which none can be used may lack anything.
  if (belonging.together || (!belonging.mean_m && !explained)) return "";
  const std::string far =
      belonging.mean_m ? fmt::format("by its laws the bodies are {:.0f} mm off", 1e3 * *belonging.mean_m)
                       : "as they are read no frame can be used";
  const std::string line = fmt::format(
      "THE RECORDINGS AND THE ARM FILE DO NOT BELONG TOGETHER: {}, on an arm of {:.0f} mm. Tried: other "
      "axes, "
      "units, orders of the quaternion, attitudes of the base. ",
      far, 1e3 * belonging.length_m);
  if (!explained)
    return line +
           "None of them explains it: is it this arm, are the lengths and the bodies' arclengths right?";
  return line + fmt::format("With {} {:.0f} mm would be left", belonging.tried.front().name,
                            1e3 * belonging.tried.front().mean_m);
}

}  // namespace softarm::identify
