#include "simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arm_cut.h"
#include "draught.h"
#include "input_path.h"
#include "laws.h"
#include "protocol.h"
#include "ritz_rod.h"
#include "sensors.h"
#include "wall_creep.h"

namespace softarm::rig {
namespace {

constexpr int kBackbonePoints = 21;

Pose to_pose(const Eigen::Isometry3d& transform) {
  return {transform.translation(), Eigen::Quaterniond(transform.linear()).normalized()};
}

/// Whether the rod's differences are of the second order only, because a wall lags by less than a step.
bool hardly_damped(const Scenario& scenario) {
  const double step_s = std::min(scenario.numerics.max_step_s, 1.0 / scenario.mocap.rate_hz);
  const auto hardly = [step_s](const SegmentSpec& segment) { return segment.retardation_s < step_s; };
  return std::any_of(scenario.arm.segments.begin(), scenario.arm.segments.end(), hardly);
}

/// How many times as many steps are needed where the order falls: to one at what is hidden with kinks in
/// time, to two where the wall hardly damps. With the default of 1/360 s a core that slips has 960 steps a
/// second and more.
double finer_steps(const Scenario& scenario) {
  constexpr double kAtSlewLimit = 8.0, kAtCore = 960.0 / 360.0, kAtYield = 2.0 * kAtCore, kAtRubbing = 3.0,
                   kHardlyDamped = 3.0;
  double times = hardly_damped(scenario) ? kHardlyDamped : 1.0;
  if (scenario.body.wall && scenario.body.wall->everywhere) times = std::max(times, kAtRubbing);
  if (core_slips(scenario)) times = std::max(times, scenario.body.core->smooth ? kAtCore : kAtYield);
  if (scenario.input_path.slew_limit) times = std::max(times, kAtSlewLimit);
  return times;
}

}  // namespace

std::string topic_of(InputKind kind, int number) {
  switch (kind) {
    case InputKind::kChamber:
      return fmt::format("/pressure/chamber_{}", number + 1);
    case InputKind::kTendon:
      return fmt::format("/tendon/{}/tension", number + 1);
    case InputKind::kServo:
      return fmt::format("/servo/{}/angle", number + 1);
    case InputKind::kVacuum:
      break;
  }
  return "/pressure/vacuum";
}

struct Simulator::Impl {
  explicit Impl(const Scenario& spec)
      : scenario(spec),
        protocol(spec),
        cut(cut_arm(spec)),
        rod(rod_params(spec, cut)),
        draught(spec.body.draught, spec.arm.length_m(), spec.seed),
        sensors(scenario, protocol),
        commands(protocol.at(0.0)),
        input_path(scenario, commands) {
    const MocapSpec& mocap = scenario.mocap;
    if (mocap.base_measured) names.push_back(mocap.base.name);
    for (const SegmentSpec& segment : scenario.arm.segments) walls.emplace_back(segment.creep);
    for (std::size_t i = 0; i < mocap.ring_fractions.size(); ++i)
      names.push_back(mocap.rings.empty() ? fmt::format("ring_{}", i + 1) : mocap.rings[i].name);
    const double frame_s = 1.0 / scenario.mocap.rate_hz;
    const double usual_step_s = std::min(scenario.numerics.max_step_s, frame_s);
    substeps = static_cast<int>(std::ceil(finer_steps(scenario) * frame_s / usual_step_s - 1e-9));
    settle();
  }

  /// To equilibrium at t = 0. Where what acts depends on how the arm is bent, by repetition.
  void settle() {
    constexpr int kMostTimes = 100;
    constexpr double kSameRad = 1e-10;
    for (int times = 0; times < kMostTimes; ++times) {
      if (!rod.settle(inputs_at(0.0))) break;
      const std::vector<Bend> before = bends;
      feel_bending(false);
      double change = 0.0;
      for (std::size_t i = 0; i < before.size(); ++i)
        change = std::max({change, std::abs(bends[i].rad - before[i].rad),
                           (bends[i].towards_rad - before[i].towards_rad).norm()});
      if (change <= kSameRad && before.size() == bends.size()) return;
    }
    throw SimulationError(
        fmt::format("scenario {}: no static equilibrium found to start from", scenario.name));
  }

  /// How far each segment is bent now, where that matters to what acts: the integral of its curvature.
  void feel_bending(bool moving) {
    if (!input_path.feels_bending()) return;
    constexpr int kPlaces = 8;
    const std::vector<Bend> before = bends;
    bends.assign(scenario.arm.segments.size(), {});
    double begin = 0.0;
    for (std::size_t i = 0; i < bends.size(); ++i) {
      const double share = scenario.arm.segments[i].length_m / scenario.arm.length_m();
      for (int k = 0; k < kPlaces; ++k) {
        const Eigen::Vector3d u = rod.curvature(begin + share * (k + 0.5) / kPlaces);
        bends[i].rad += u.head<2>().norm() * actuation[i].length_m / kPlaces;
        // Bending towards x is a turn about y.
        bends[i].towards_rad += actuation[i].length_m / kPlaces * Eigen::Vector2d(u.y(), -u.x());
      }
      begin += share;
    }
    // As it will be at the end of the next step, if it goes on.
    next_bends = bends;
    for (std::size_t i = 0; moving && i < before.size(); ++i) {
      next_bends[i].rad = std::max(0.0, 2.0 * bends[i].rad - before[i].rad);
      next_bends[i].towards_rad = 2.0 * bends[i].towards_rad - before[i].towards_rad;
    }
  }

  /// To be asked in the order of time: the path of the inputs remembers.
  RitzRodInputs inputs_at(double t_s) {
    commands = protocol.at(t_s);
    const std::vector<Acting> acting = input_path.act(commands, t_s, next_bends);
    actuation.clear();
    for (const SegmentSpec& segment : scenario.arm.segments) {
      try {
        actuation.push_back(apply_laws(segment, acting.at(actuation.size()), scenario.input_path.laws));
        walls.at(actuation.size() - 1).act(t_s, actuation.back());
      } catch (const LawError& error) {
        throw SimulationError(fmt::format("scenario {}: at t = {:.3f} s in segment {}: {}", scenario.name,
                                          t_s, actuation.size() + 1, error.what()));
      }
    }
    RitzRodInputs inputs;
    inputs.pieces = piece_inputs(cut, actuation);
    inputs.payload_kg = commands.payload_kg;
    inputs.hand_damping_n_s_m = commands.hand_damping_n_s_m;
    inputs.draught_base_n_per_m = scenario.mount.q_mocap_base.conjugate() * draught.at(t_s);
    return inputs;
  }

  void advance() {
    const double step_s = 1.0 / (scenario.mocap.rate_hz * substeps);
    for (int i = 1; i <= substeps; ++i) {
      const double t =
          (static_cast<double>(frame - 1) + static_cast<double>(i) / substeps) / scenario.mocap.rate_hz;
      if (!rod.step(inputs_at(t), step_s))
        throw SimulationError(
            fmt::format("scenario {}: the equations of motion did not converge at t = {:.4f} s (smaller "
                        "numerics.max_step_s may help)",
                        scenario.name, t));
      feel_bending(true);
    }
  }

  /// Fraction of the rest length of the section at an actual arclength.
  double material_fraction(double arclength_m) const {
    double rest_m = 0.0;
    for (std::size_t i = 0; i < actuation.size(); ++i) {
      const double rest_length_m = scenario.arm.segments[i].length_m;
      if (arclength_m <= actuation[i].length_m)
        return (rest_m + rest_length_m * arclength_m / actuation[i].length_m) / scenario.arm.length_m();
      arclength_m -= actuation[i].length_m;
      rest_m += rest_length_m;
    }
    return 1.0;
  }

  Truth truth(double stamp_s) const {
    Truth t;
    t.stamp_s = stamp_s;
    double length_m = 0.0;
    for (const Actuation& a : actuation) {
      t.segments.push_back({a.moment_nm, a.bending_stiffness_nm2, a.length_m});
      length_m += a.length_m;
    }
    t.payload_kg = commands.payload_kg;
    t.payload_steadied = commands.hand_damping_n_s_m > 0.0;
    t.pressures_pa = commands.pressures_pa;
    t.tensions_n = commands.tensions_n;
    t.angles_rad = commands.angles_rad;
    t.vacuum_pa = commands.vacuum_pa;
    for (double fraction : scenario.mocap.ring_fractions) t.rings_base.push_back(to_pose(rod.pose(fraction)));
    for (int i = 0; i < kBackbonePoints; ++i)
      t.backbone_base.emplace_back(
          rod.pose(material_fraction(length_m * i / (kBackbonePoints - 1))).translation());
    const Eigen::Isometry3d tip = rod.pose(1.0);
    t.tip_base = to_pose(tip);
    t.tip_angle_rad = std::atan2(tip.linear().col(2).head<2>().norm(), tip.linear()(2, 2));
    t.energy_j = rod.energy_j();
    return t;
  }

  Scenario scenario;
  Protocol protocol;
  Cut cut;
  RitzRod rod;
  DraughtForce draught;
  Sensors sensors;
  std::vector<std::string> names;
  int substeps = 1;
  Commands commands;
  InputPath input_path;
  std::vector<Actuation> actuation;  ///< per segment
  std::vector<WallCreep> walls;      ///< per segment
  /// Per segment, after the last step and after the next; empty: not felt.
  std::vector<Bend> bends, next_bends;
  std::size_t frame = 0;
};

Simulator::Simulator(const Scenario& scenario) : impl_(std::make_unique<Impl>(scenario)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

std::optional<Sample> Simulator::next() {
  Impl& m = *impl_;
  const std::optional<std::size_t> count = frame_count();
  if (count && m.frame >= *count) return std::nullopt;
  if (m.frame > 0) m.advance();

  Sample sample;
  sample.stamp_s = static_cast<double>(m.frame) / m.scenario.mocap.rate_hz;
  sample.truth = m.truth(sample.stamp_s);
  m.sensors.observe([&m](double fraction) { return to_pose(m.rod.pose(fraction)); }, sample);
  ++m.frame;
  return sample;
}

std::optional<std::size_t> Simulator::frame_count() const {
  const Scenario& s = impl_->scenario;
  if (s.duration_s <= 0.0) return std::nullopt;
  return static_cast<std::size_t>(std::floor(s.duration_s * s.mocap.rate_hz + 1e-9)) + 1;
}

const std::vector<std::string>& Simulator::body_names() const {
  return impl_->names;
}
const Scenario& Simulator::scenario() const {
  return impl_->scenario;
}
std::size_t Simulator::dropouts() const {
  return impl_->sensors.dropouts();
}

}  // namespace softarm::rig
