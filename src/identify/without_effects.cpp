#include "without_effects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "math/parallel.h"
#include "model/extended_model.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

constexpr double kFarthest_s = 0.15;  // from a mean, beyond which a frame is left out

/// What effects do to one body at one instant, rod's base frame.
struct Moved {
  double stamp_s = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< rotation vector
};

Eigen::Quaterniond section_at(const model::Shape& shape, double s_m) {
  const auto nearest = std::min_element(shape.stations.begin(), shape.stations.end(),
                                        [&](const rod::RodState& x, const rod::RodState& y) {
                                          return std::abs(x.s_m - s_m) < std::abs(y.s_m - s_m);
                                        });
  return nearest->q;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q.w() < 0.0 ? Eigen::Quaterniond(-q.coeffs()) : q);
  return turn.angle() * turn.axis();
}

/// By body, in order of time.
std::vector<std::vector<Moved>> moved_by(const arm::Arm& arm, const std::vector<model::Present>& effects,
                                         const model::TrialData& trial) {
  model::ExtendedModel model(arm);
  std::vector<model::Predicted> without, with;
  const model::Dynamics at_rest{false, 0.0};
  model.predict(arm, {}, at_rest, trial, nullptr, without);
  model.predict(arm, effects, at_rest, trial, &without, with);
  std::vector<std::vector<Moved>> list(arm.bodies.size());
  for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
    if (!with[k].solved || !without[k].solved) continue;
    for (std::size_t i = 0; i < trial.blocks[k].bodies.size(); ++i) {
      const auto b = static_cast<std::size_t>(trial.blocks[k].bodies[i].body);
      const auto column = static_cast<Eigen::Index>(i);
      const double s_m = arm.bodies[b].arclength_m;
      Moved moved;
      moved.stamp_s = trial.begin_s + with[k].instant.t_s;
      moved.p = with[k].p.col(column) - without[k].p.col(column);
      moved.turn =
          rotation_vector(section_at(with[k].shape, s_m) * section_at(without[k].shape, s_m).conjugate());
      list[b].push_back(moved);
    }
  }
  return list;
}

/// Straight between means. @return nothing far from any
std::optional<Moved> at(const std::vector<Moved>& list, double stamp_s) {
  const auto after = std::lower_bound(list.begin(), list.end(), stamp_s,
                                      [](const Moved& moved, double s) { return moved.stamp_s < s; });
  const bool has_after = after != list.end() && after->stamp_s - stamp_s < kFarthest_s;
  const bool has_before = after != list.begin() && stamp_s - std::prev(after)->stamp_s < kFarthest_s;
  if (!has_after && !has_before) return std::nullopt;
  if (!has_before) return *after;
  const Moved& before = *std::prev(after);
  if (!has_after) return before;
  const double w = (stamp_s - before.stamp_s) / (after->stamp_s - before.stamp_s);
  Moved moved;
  moved.p = (1.0 - w) * before.p + w * after->p;
  moved.turn = (1.0 - w) * before.turn + w * after->turn;
  return moved;
}

trial::Trial corrected(const arm::Arm& arm, const trial::Trial& trial,
                       const std::vector<std::vector<Moved>>& moved) {
  trial::Trial out;
  out.name = trial.name;
  out.inputs = trial.inputs;
  Eigen::Matrix3d base = arm.base.fixed_pose.linear();
  bool placed = !arm.base.body;
  for (const trial::Frame& frame : trial.frames) {
    if (arm.base.body && frame.base_body && frame.base_body->matrix().allFinite()) {
      base = (*frame.base_body * arm.base.rod_in_body).linear();
      placed = true;
    }
    if (!placed) continue;
    trial::Frame changed = frame;
    changed.bodies.clear();
    for (trial::BodyObservation seen : frame.bodies) {
      if (seen.body < 0 || seen.body >= static_cast<int>(moved.size())) continue;
      const std::optional<Moved> by = at(moved[static_cast<std::size_t>(seen.body)], frame.stamp_s);
      if (!by) continue;
      if (seen.q_mocap) {
        // About the section's place, which may be off the body's origin.
        const Eigen::Vector3d turn = base * by->turn;
        const double angle = turn.norm();
        const Eigen::Quaterniond back(Eigen::AngleAxisd(
            -angle, angle > 0.0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitZ()));
        const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
        const Eigen::Vector3d lever = *seen.q_mocap * body.section_in_body.translation();
        seen.q_mocap = back * *seen.q_mocap;
        seen.p_mocap += lever - back * lever;
      }
      seen.p_mocap -= base * by->p;
      changed.bodies.push_back(seen);
    }
    if (!changed.bodies.empty()) out.frames.push_back(std::move(changed));
  }
  return out;
}

model::Prepared prepare(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  try {
    return model::prepare(arm, trials);
  } catch (const model::UnusableTrials& e) {
    throw IdentifyError(e.what());
  }
}

}  // namespace

std::vector<trial::Trial> without_effects(const arm::Arm& arm, const std::vector<model::Present>& effects,
                                          const std::vector<trial::Trial>& trials, unsigned jobs) {
  const model::Prepared prepared = prepare(arm, trials);
  std::vector<trial::Trial> out(trials.size());
  math::in_parallel(trials.size(), jobs, [&](std::size_t t) {
    out[t].name = trials[t].name;
    const auto data =
        std::find_if(prepared.trials.begin(), prepared.trials.end(),
                     [&](const model::TrialData& trial) { return trial.name == trials[t].name; });
    if (data != prepared.trials.end()) out[t] = corrected(arm, trials[t], moved_by(arm, effects, *data));
  });
  return out;
}

}  // namespace softarm::identify
