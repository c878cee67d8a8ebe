#include "softarm/rig/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "backbone_kinematics.h"
#include "random_stream.h"
#include "softarm/rig/protocol.h"
#include "softarm/rig/ritz_rod.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kMocapPurpose = 0x6d6f6361;
constexpr int kBackbonePoints = 21;

RitzRodParams rod_params(const Scenario& scenario) {
  RitzRodParams params;
  params.elements = scenario.numerics.elements;
  params.mass_kg = scenario.arm.mass_kg;
  params.tip_mass_kg = scenario.arm.tip_mass_kg;
  params.diameter_m = scenario.arm.diameter_m;
  params.retardation_s = scenario.arm.retardation_s;
  params.air_damping_n_s_m2 = scenario.arm.air_damping_n_s_m2;
  params.gravity_base_m_s2 =
      scenario.mount.q_mocap_base.conjugate() * Eigen::Vector3d(0.0, 0.0, -scenario.gravity_m_s2);
  return params;
}

Pose to_pose(const Eigen::Isometry3d& transform) {
  return {transform.translation(), Eigen::Quaterniond(transform.linear()).normalized()};
}

}  // namespace

struct Simulator::Impl {
  explicit Impl(const Scenario& spec)
      : scenario(spec), protocol(spec), rod(rod_params(spec)), noise(spec.seed, kMocapPurpose) {
    if (scenario.mocap.base_measured) names.emplace_back("base");
    for (std::size_t i = 1; i <= scenario.mocap.ring_fractions.size(); ++i)
      names.push_back(fmt::format("ring_{}", i));
    const double frame_s = 1.0 / scenario.mocap.rate_hz;
    substeps = std::max(1, static_cast<int>(std::ceil(frame_s / scenario.numerics.max_step_s - 1e-9)));
    if (!rod.settle(inputs_at(0.0)))
      throw SimulationError(
          fmt::format("scenario {}: no static equilibrium found to start from", scenario.name));
  }

  RitzRodInputs inputs_at(double t_s) {
    commands = protocol.at(t_s);
    actuation = apply_laws(scenario.arm, commands);
    // Pressure laws with negative coefficients can be driven out of their range.
    if (!(actuation.bending_stiffness_nm2 > 0.0) || !(actuation.length_m > 0.0))
      throw SimulationError(
          fmt::format("scenario {}: at t = {:.3f} s the pressure laws give EI = {:.4g} N m^2 and L = {:.4g} "
                      "m, must be > 0",
                      scenario.name, t_s, actuation.bending_stiffness_nm2, actuation.length_m));
    RitzRodInputs inputs;
    inputs.length_m = actuation.length_m;
    inputs.bending_stiffness_nm2 = actuation.bending_stiffness_nm2;
    inputs.torsional_stiffness_nm2 = scenario.arm.torsional_stiffness_nm2;
    // Bending towards phi is a turn about the axis at phi + 90 degrees.
    inputs.moment_section_nm = {-actuation.moment_nm.y(), actuation.moment_nm.x(), 0.0};
    inputs.payload_kg = commands.payload_kg;
    inputs.tip_damping_n_s_m = commands.hand_damping_n_s_m;
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
    }
  }

  std::optional<Pose> measure(const Pose& base_pose, const PoseNoise& sd) {
    // All numbers are drawn even for a lost body: dropouts do not change the noise of the others.
    const bool lost = noise.uniform() < scenario.mocap.dropout_probability;
    const Eigen::Vector3d position_noise = sd.position_sd_m * noise.normal3();
    const Eigen::Vector3d turn = sd.orientation_sd_rad * noise.normal3();
    if (lost) {
      ++dropouts;
      return std::nullopt;
    }
    const MountSpec& mount = scenario.mount;
    Pose measured;
    measured.p = mount.p_mocap_base + mount.q_mocap_base * base_pose.p + position_noise;
    measured.q = (mount.q_mocap_base * base_pose.q * Eigen::Quaterniond(rotation_of(turn))).normalized();
    return measured;
  }

  void add_messages(double until_s, Sample& sample) {
    const PressureSpec& spec = scenario.pressures;
    for (;; ++pressure_message) {
      const double stamp = static_cast<double>(pressure_message) / spec.rate_hz;
      if (stamp > until_s) break;
      const Commands sent = protocol.at(stamp);
      for (std::size_t i = 0; i < sent.pressures_pa.size(); ++i)
        sample.pressures.push_back({stamp, static_cast<int>(i), spec.ambient_pa + sent.pressures_pa[i]});
      if (!scenario.vacuum.schedule.empty())
        sample.pressures.push_back({stamp, PressureSample::kVacuum, spec.ambient_pa - sent.vacuum_pa});
    }
    if (scenario.payload.publish) {
      const PayloadChange change = protocol.payload_known_at(until_s);
      if (!published || change.kg != *published) {
        sample.payload = PayloadSample{change.t_s, change.kg};
        published = change.kg;
      }
    }
  }

  Truth truth(double stamp_s) const {
    Truth t;
    t.stamp_s = stamp_s;
    t.moment_nm = actuation.moment_nm;
    t.bending_stiffness_nm2 = actuation.bending_stiffness_nm2;
    t.length_m = actuation.length_m;
    t.payload_kg = commands.payload_kg;
    t.payload_steadied = commands.hand_damping_n_s_m > 0.0;
    t.pressures_pa = commands.pressures_pa;
    t.vacuum_pa = commands.vacuum_pa;
    for (double fraction : scenario.mocap.ring_fractions) t.rings_base.push_back(to_pose(rod.pose(fraction)));
    for (int i = 0; i < kBackbonePoints; ++i)
      t.backbone_base.emplace_back(rod.pose(static_cast<double>(i) / (kBackbonePoints - 1)).translation());
    const Eigen::Isometry3d tip = rod.pose(1.0);
    t.tip_base = to_pose(tip);
    t.tip_angle_rad = std::atan2(tip.linear().col(2).head<2>().norm(), tip.linear()(2, 2));
    t.energy_j = rod.energy_j();
    return t;
  }

  Scenario scenario;
  Protocol protocol;
  RitzRod rod;
  RandomStream noise;
  std::vector<std::string> names;
  int substeps = 1;
  Commands commands;
  Actuation actuation;
  std::size_t frame = 0;
  std::size_t pressure_message = 0;
  std::size_t dropouts = 0;
  std::optional<double> published;
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
  if (m.scenario.mocap.base_measured) sample.bodies.push_back(m.measure(Pose{}, m.scenario.mocap.base_noise));
  for (const Pose& ring : sample.truth.rings_base)
    sample.bodies.push_back(m.measure(ring, m.scenario.mocap.ring_noise));
  m.add_messages(sample.stamp_s, sample);
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
  return impl_->dropouts;
}

}  // namespace softarm::rig
