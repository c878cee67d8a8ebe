#include "belonging.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "compare_frames.h"
#include "math/statistics.h"

namespace softarm::identify {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;

constexpr double kFarthest = 0.4;      // of the length, mean over bodies and frames
constexpr double kLooks = 0.05;        // of the length, from which on other readings are tried
constexpr double kExplains = 0.2;      // of the length, that a reading may leave to be named
constexpr double kBetter = 1.0 / 3.0;  // of the error, that it may leave where that is less than kFarthest
constexpr double kTies = 1.25;         // ratio of errors up to which readings cannot be told apart
constexpr std::size_t kMostTies = 3;   // that are named
constexpr double kOtherLength = 0.1;   // from which on another length of the arm is a reading
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

/// How far bodies are from the base along the arm at most, over what the arm file says: the median over the
/// frames; nothing without a base.
std::optional<double> length_ratio(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  std::vector<double> ratios;
  for (const trial::Trial& trial : trials) {
    for (const trial::Frame& frame : trial.frames) {
      if (arm.base.body && !frame.base_body) continue;
      const Isometry3d base = arm.base.body ? *frame.base_body * arm.base.rod_in_body : arm.base.fixed_pose;
      const arm::MeasuredBody* last = nullptr;
      double distance_m = 0.0;
      for (const trial::BodyObservation& seen : frame.bodies) {
        const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
        if (last != nullptr && body.arclength_m < last->arclength_m) continue;
        last = &body;
        distance_m = (seen.p_mocap - base.translation()).norm();
      }
      if (last != nullptr && last->arclength_m > 0.0) ratios.push_back(distance_m / last->arclength_m);
    }
  }
  if (ratios.empty()) return std::nullopt;
  // Chords of a bent arm are shorter than it: the longest of nearly all is at rest.
  return math::quantile(ratios, 0.95);
}

arm::Arm scaled(arm::Arm arm, double factor) {
  for (arm::Segment& segment : arm.segments) segment.length_m *= factor;
  for (arm::MeasuredBody& body : arm.bodies) body.arclength_m *= factor;
  arm.payload.arclength_m *= factor;
  return arm;
}

}  // namespace

Belonging belonging(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  Belonging result;
  result.length_m = arm.total_length_m();
  const std::vector<trial::Trial> few = thinned(trials);
  const std::optional<double> given = error_of(arm, few);
  result.mean_m = given;
  result.together = given && *given <= kFarthest * result.length_m;
  if (given && *given <= kLooks * result.length_m) return result;
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
  for (const auto& [factor, units] :
       {std::pair(1e-3, "mm in place of m"), std::pair(1e3, "m in place of mm"),
        std::pair(1e-2, "cm in place of m"), std::pair(1e-1, "mm in place of cm"),
        std::pair(0.0254, "inches in place of m"), std::pair(10.0, "cm in place of mm"),
        std::pair(100.0, "m in place of cm")})
    try_reading(
        fmt::format("positions in {} (inputs.bodies.unit of the arm file, or mocap.unit of the layout)",
                    units),
        arm,
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
  const std::optional<double> ratio = length_ratio(arm, few);
  if (ratio && std::abs(*ratio - 1.0) > kOtherLength)
    try_reading(
        fmt::format("an arm {:.2f} times as long (length_m of the segments and arclength_m of bodies and "
                    "payload)",
                    *ratio),
        scaled(arm, *ratio), few);
  std::stable_sort(result.tried.begin(), result.tried.end(),
                   [](const Reading& a, const Reading& b) { return a.mean_m < b.mean_m; });
  const bool better = given && !result.tried.empty() && result.tried.front().mean_m < kBetter * *given;
  result.together = result.together && !better;
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
      "axes, units, lengths, orders of the quaternion, attitudes of the base. ",
      far, 1e3 * belonging.length_m);
  if (!explained)
    return line +
           "None of them explains it: is it this arm, are the lengths and the bodies' arclengths right?";
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostTies, belonging.tried.size()); ++i) {
    if (belonging.tried[i].mean_m <= kTies * belonging.tried.front().mean_m)
      names += (i == 0 ? "" : ", or ") + belonging.tried[i].name;
  }
  return line + fmt::format("With {} {:.0f} mm would be left", names, 1e3 * belonging.tried.front().mean_m);
}

}  // namespace softarm::identify
