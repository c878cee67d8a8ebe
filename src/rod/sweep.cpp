#include "sweep.h"

#include <algorithm>

#include "math/so3.h"

namespace softarm::rod {
namespace {

using Eigen::Vector3d;
using kernel::LaneSource;
using kernel::LaneState;

void add(double v[3], const Vector3d& w) {
  for (int r = 0; r < 3; ++r) v[r] += w[r];
}

Eigen::Quaterniond quaternion(const kernel::State& y) {
  return {y.q[0], y.q[1], y.q[2], y.q[3]};
}

/// Of the stiffnesses of bending in the two principal planes, the product over the square of their mean.
double isotropy(const Segment& segment) {
  return 1.0 - segment.anisotropy.squaredNorm();
}

/// Of what bends a segment: its moment, and how it answers moments.
void set_bending_source(const Parameter& parameter, int k, const Segment& segment,
                        const kernel::Section& section, LaneSource& source) {
  const int c = parameter.component;
  if (parameter.kind == ParameterKind::kBendingCompliance) {
    source.bend.value[k] = 1.0 / isotropy(segment);
  } else if (parameter.kind == ParameterKind::kBendingAnisotropy) {
    source.anisotropy[c].value[k] = -section.bend;
    source.bend.value[k] = 2.0 * segment.anisotropy[c] * section.bend / isotropy(segment);
  } else if (c == 2) {
    source.moment[c].value[k] = section.twist;
  } else {
    const double own = c == 0 ? section.anisotropy[0] : -section.anisotropy[0];
    source.moment[c].value[k] = section.bend * (1.0 + own);
    source.moment[1 - c].value[k] = section.bend * section.anisotropy[1];
  }
}

void add(kernel::Lanes v[3], int k, const Vector3d& w) {
  for (int r = 0; r < 3; ++r) v[r].value[k] += w[r];
}

/// Force and moment that a load applies to a section with orientation q.
struct Wrench {
  Vector3d follower_force, force, follower_moment, moment, arm;
};

Wrench wrench(const PointLoad& load, const Vector3d& gravity, const Eigen::Quaterniond& q) {
  Wrench w;
  const Vector3d weight = load.mass_kg * gravity;
  w.follower_force = load.follower ? Vector3d(q * load.force_n) : Vector3d::Zero().eval();
  w.follower_moment = load.follower ? Vector3d(q * load.moment_nm) : Vector3d::Zero().eval();
  w.force = load.follower ? Vector3d(w.follower_force + weight) : Vector3d(load.force_n + weight);
  w.moment = load.follower ? w.follower_moment : load.moment_nm;
  w.arm = q * load.offset_m;
  return w;
}

}  // namespace

Sweep::Sweep(const Rod& layout, const std::vector<double>& stations_m,
             const std::vector<Parameter>& parameters, int max_refinement)
    : grid_(layout, stations_m, max_refinement),
      parameters_(parameters),
      kernel_(kernel::pick_kernel()),
      sections_(layout.segments.size()),
      nodes_(static_cast<std::size_t>(grid_.breakpoints())),
      distal_(nodes_.size()),
      beyond_joint_(grid_.intervals.size(), Eigen::Quaterniond::Identity()),
      stages_(grid_.steps.size() * kernel::kMostStages) {
  const int count = static_cast<int>(parameters.size());
  const std::size_t blocks = count == 0 ? 1 : static_cast<std::size_t>(block_of(count - 1)) + 1;
  lanes_.assign(blocks, std::vector<LaneState>(nodes_.size()));
  sources_.assign(blocks, std::vector<LaneSource>(sections_.size()));
  for (int block = 0; block < this->blocks(); ++block) first_.push_back(first_interval(block));
}

int Sweep::block_of(int parameter) {
  return parameter < kFirstBlockParameters ? 0 : 1 + (parameter - kFirstBlockParameters) / kernel::kLanes;
}

int Sweep::lane_of(int parameter) {
  return parameter < kFirstBlockParameters ? kUnknownLanes + parameter
                                           : (parameter - kFirstBlockParameters) % kernel::kLanes;
}

std::size_t Sweep::first_interval(int block) const {
  std::size_t first = grid_.intervals.size();
  if (block == 0) return 0;  // the unknowns
  for (int i = first_parameter(block); i < first_parameter(block + 1); ++i) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
    std::size_t own = 0;
    switch (parameter.kind) {
      case ParameterKind::kGravity:
      case ParameterKind::kLoadScale:
        break;
      case ParameterKind::kBaseRotation:
        own = first;
        break;
      case ParameterKind::kLoadForce:
      case ParameterKind::kLoadMoment:
      case ParameterKind::kLoadMass:
      case ParameterKind::kLoadOffset:
        while (own < first) {
          const std::vector<int>& loads = grid_.loads_at[own];
          if (std::find(loads.begin(), loads.end(), parameter.index) != loads.end()) break;
          ++own;
        }
        break;
      default:
        while (own < first && grid_.intervals[own].segment != parameter.index) ++own;
    }
    first = std::min(first, own);
  }
  return first;
}

void Sweep::set_rod(const Rod& rod, const Rod& load_direction) {
  rod_ = &rod;
  load_direction_ = &load_direction;
  // A rigid section has derivatives by its compliances all the same.
  const bool strains_wanted =
      std::any_of(parameters_.begin(), parameters_.end(), [](const Parameter& parameter) {
        return parameter.kind == ParameterKind::kAxialCompliance ||
               parameter.kind == ParameterKind::kShearCompliance;
      });
  const bool anisotropy_wanted = std::any_of(
      parameters_.begin(), parameters_.end(),
      [](const Parameter& parameter) { return parameter.kind == ParameterKind::kBendingAnisotropy; });
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const Segment& from = rod.segments[i];
    kernel::Section& to = sections_[i];
    to.stretch = from.length_m / from.rest_length_m;
    to.bend = from.bending_compliance / isotropy(from);
    for (int r = 0; r < 2; ++r) to.anisotropy[r] = -from.anisotropy[r];
    to.is_anisotropic = anisotropy_wanted || !from.anisotropy.isZero(0.0);
    to.twist = from.torsional_compliance;
    to.axial = from.axial_compliance;
    to.shear = from.shear_compliance;
    to.shearable = to.axial != 0.0 || to.shear != 0.0 || strains_wanted;
    for (int r = 0; r < 3; ++r) {
      to.rest[r] = from.rest_curvature_per_m[r];
      to.moment[r] = from.moment_nm[r];
      to.weight[r] = from.mass_kg / from.rest_length_m * rod.gravity_m_s2[r];
    }
  }
  for (int block = 0; block < blocks(); ++block) set_sources(block);
}

void Sweep::refine(int refinement) {
  if (refinement == refinement_) return;
  refinement_ = refinement;
  grid_.refine(*rod_, refinement, sections_);
}

void Sweep::set_sources(int block) {
  std::vector<LaneSource>& sources = sources_[static_cast<std::size_t>(block)];
  std::fill(sources.begin(), sources.end(), LaneSource{});
  const auto weight_per_s = [](const Segment& segment) { return segment.mass_kg / segment.rest_length_m; };
  for (int i = first_parameter(block); i < first_parameter(block + 1); ++i) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
    const int k = lane_of(i);
    const int c = parameter.component;
    const auto index = static_cast<std::size_t>(parameter.index);
    switch (parameter.kind) {
      case ParameterKind::kRestCurvature:
        sources[index].rest[c].value[k] = 1.0;
        break;
      case ParameterKind::kMoment:
      case ParameterKind::kBendingCompliance:
      case ParameterKind::kBendingAnisotropy:
        set_bending_source(parameter, k, rod_->segments[index], sections_[index], sources[index]);
        break;
      case ParameterKind::kTorsionalCompliance:
        sources[index].twist.value[k] = 1.0;
        break;
      case ParameterKind::kAxialCompliance:
        sources[index].axial.value[k] = 1.0;
        break;
      case ParameterKind::kShearCompliance:
        sources[index].shear.value[k] = 1.0;
        break;
      case ParameterKind::kLength:
        sources[index].stretch.value[k] = 1.0 / rod_->segments[index].length_m;
        break;
      case ParameterKind::kSegmentMass:
        for (int r = 0; r < 3; ++r) {
          sources[index].weight[r].value[k] = rod_->gravity_m_s2[r] / rod_->segments[index].rest_length_m;
        }
        break;
      case ParameterKind::kGravity:
        for (std::size_t j = 0; j < sources.size(); ++j) {
          sources[j].weight[c].value[k] = weight_per_s(rod_->segments[j]);
        }
        break;
      case ParameterKind::kLoadScale:
        for (std::size_t j = 0; j < sources.size(); ++j) {
          for (int r = 0; r < 3; ++r) sources[j].weight[r].value[k] = sections_[j].weight[r];
        }
        break;
      case ParameterKind::kJointCompliance:
      case ParameterKind::kLoadForce:
      case ParameterKind::kLoadMoment:
      case ParameterKind::kLoadMass:
      case ParameterKind::kLoadOffset:
      case ParameterKind::kBaseRotation:
        break;
    }
  }
  if (block == 0) {
    for (std::size_t j = 0; j < sources.size(); ++j) {
      for (int r = 0; r < 3; ++r) {
        sources[j].weight[r].value[kLoadScaleLane] =
            weight_per_s(load_direction_->segments[j]) * load_direction_->gravity_m_s2[r];
      }
    }
  }
}

void Sweep::apply_loads(int breakpoint, Node& node) const {
  for (const int i : grid_.loads_at[static_cast<std::size_t>(breakpoint)]) {
    const Wrench w = wrench(rod_->loads[static_cast<std::size_t>(i)], rod_->gravity_m_s2, quaternion(node.y));
    add(node.n, w.force);
    add(node.y.m, w.moment + w.arm.cross(w.force));
  }
}

void Sweep::apply_loads(int block, int breakpoint, const Node& before, LaneState& y) const {
  for (const int i : grid_.loads_at[static_cast<std::size_t>(breakpoint)]) {
    const PointLoad& load = rod_->loads[static_cast<std::size_t>(i)];
    const Eigen::Quaterniond q = quaternion(before.y);
    const Wrench w = wrench(load, rod_->gravity_m_s2, q);
    const Eigen::Matrix3d rotation = q.toRotationMatrix();
    const bool turns = load.follower || w.arm.squaredNorm() > 0.0;
    if (turns) {
      for (int k = 0; k < kernel::kLanes; ++k) {
        const Vector3d psi = lane(y.psi, k);
        const Vector3d dforce = psi.cross(w.follower_force);
        add(y.nu, k, dforce);
        add(y.mu, k, psi.cross(w.follower_moment) + psi.cross(w.arm).cross(w.force) + w.arm.cross(dforce));
      }
    }
    const auto source = [&](int k, const Vector3d& dforce, const Vector3d& dmoment) {
      add(y.nu, k, dforce);
      add(y.mu, k, dmoment + w.arm.cross(dforce));
    };
    const auto axis = [&](int c) {
      return load.follower ? Vector3d(rotation.col(c)) : Vector3d(Vector3d::Unit(c));
    };
    for (int p = first_parameter(block); p < first_parameter(block + 1); ++p) {
      const Parameter& parameter = parameters_[static_cast<std::size_t>(p)];
      const int k = lane_of(p);
      const int c = parameter.component;
      const bool mine = parameter.index == i;
      if (parameter.kind == ParameterKind::kLoadForce && mine) source(k, axis(c), Vector3d::Zero());
      if (parameter.kind == ParameterKind::kLoadMoment && mine) source(k, Vector3d::Zero(), axis(c));
      if (parameter.kind == ParameterKind::kLoadMass && mine) source(k, rod_->gravity_m_s2, Vector3d::Zero());
      if (parameter.kind == ParameterKind::kLoadOffset && mine) {
        source(k, Vector3d::Zero(), Vector3d(rotation.col(c)).cross(w.force));
      }
      if (parameter.kind == ParameterKind::kGravity)
        source(k, load.mass_kg * Vector3d::Unit(c), Vector3d::Zero());
      if (parameter.kind == ParameterKind::kLoadScale) source(k, w.force, w.moment);
    }
    if (block == 0) {
      const Wrench full =
          wrench(load_direction_->loads[static_cast<std::size_t>(i)], load_direction_->gravity_m_s2, q);
      source(kLoadScaleLane, full.force, full.moment);
    }
  }
}

namespace {

/// Turn of a joint in its section's frame: about the axes across the tangent, by the moment that it bears.
Vector3d joint_turn(double compliance, const Eigen::Quaterniond& q, const Vector3d& moment) {
  const Vector3d local = q.conjugate() * moment;
  return {compliance * local.x(), compliance * local.y(), 0.0};
}

}  // namespace

void Sweep::turn_joint(std::size_t interval, Node& node) {
  const int segment = grid_.intervals[interval].segment;
  const Eigen::Quaterniond q = quaternion(node.y).normalized();
  beyond_joint_[interval] = q;
  const double compliance = rod_->segments[static_cast<std::size_t>(segment)].joint_compliance;
  if (compliance == 0.0) return;
  const Vector3d moment(node.y.m[0], node.y.m[1], node.y.m[2]);
  const Eigen::Quaterniond before = q * math::exp_so3(-joint_turn(compliance, q, moment));
  node.y.q[0] = before.w(), node.y.q[1] = before.x(), node.y.q[2] = before.y(), node.y.q[3] = before.z();
}

void Sweep::turn_joint(int block, std::size_t interval, LaneState& y) const {
  const int segment = grid_.intervals[interval].segment;
  const double compliance = rod_->segments[static_cast<std::size_t>(segment)].joint_compliance;
  const bool wanted = std::any_of(parameters_.begin(), parameters_.end(), [&](const Parameter& parameter) {
    return parameter.kind == ParameterKind::kJointCompliance && parameter.index == segment;
  });
  if (compliance == 0.0 && !wanted) return;
  const Eigen::Quaterniond q = beyond_joint_[interval];
  const kernel::State& at = distal_[interval + 1].y;
  const Vector3d moment(at.m[0], at.m[1], at.m[2]);
  // R_before = R exp(-w): the turn of the proximal side is that of the distal one less R J_r(w) dw.
  const Eigen::Matrix3d by_turn =
      q.toRotationMatrix() * math::left_jacobian_inverse(-joint_turn(compliance, q, moment)).inverse();
  const auto source = [&](int k, const Vector3d& dmoment, double dcompliance) {
    const Vector3d dw = joint_turn(compliance, q, dmoment) + joint_turn(dcompliance, q, moment);
    add(y.psi, k, -by_turn * dw);
  };
  for (int k = 0; k < kernel::kLanes; ++k) {
    const Vector3d psi = lane(y.psi, k);
    source(k, lane(y.mu, k) - psi.cross(moment), 0.0);
  }
  for (int p = first_parameter(block); p < first_parameter(block + 1); ++p) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == ParameterKind::kJointCompliance && parameter.index == segment)
      source(lane_of(p), Vector3d::Zero(), 1.0);
  }
}

double Sweep::integrate(const Eigen::Quaterniond& q_tip) {
  Node node{};
  node.y.q[0] = q_tip.w();
  node.y.q[1] = q_tip.x();
  node.y.q[2] = q_tip.y();
  node.y.q[3] = q_tip.z();
  kernel::StepError error{};
  double lever = 0.0;
  for (std::size_t k = 0; k < grid_.intervals.size(); ++k) {
    distal_[k] = node;
    apply_loads(static_cast<int>(k), node);
    nodes_[k] = node;
    const Interval& interval = grid_.intervals[k];
    const int count = interval.coarse_steps * refinement_;
    for (int i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(interval.first_step + i);
      const kernel::Step& step = grid_.steps[s];
      kernel_.nominal_step(step, node.n, node.y, &stages_[s * kernel::kMostStages], &error);
      for (int r = 0; r < 3; ++r) node.n[r] -= step.h * step.section->weight[r];
    }
    if (interval.from_joint) turn_joint(k, node);
    lever += sections_[static_cast<std::size_t>(interval.segment)].stretch *
             (interval.s_distal - interval.s_proximal);
  }
  distal_.back() = node;
  apply_loads(grid_.breakpoints() - 1, node);
  nodes_.back() = node;
  return error.p + lever * error.q;
}

void Sweep::differentiate(int block) {
  LaneState y{};
  if (block == 0) {
    for (int r = 0; r < kUnknownLanes; ++r) y.psi[r].value[r] = 1.0;
  }
  std::vector<LaneState>& lanes = lanes_[static_cast<std::size_t>(block)];
  const std::vector<LaneSource>& sources = sources_[static_cast<std::size_t>(block)];
  for (std::size_t k = first_[static_cast<std::size_t>(block)]; k < grid_.intervals.size(); ++k) {
    apply_loads(block, static_cast<int>(k), distal_[k], y);
    lanes[k] = y;
    const Interval& interval = grid_.intervals[k];
    const int count = interval.coarse_steps * refinement_;
    for (int i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(interval.first_step + i);
      kernel_.tangent_step(grid_.steps[s], &stages_[s * kernel::kMostStages],
                           sources[static_cast<std::size_t>(interval.segment)], y);
    }
    if (interval.from_joint) turn_joint(block, k, y);
  }
  apply_loads(block, grid_.breakpoints() - 1, distal_.back(), y);
  lanes.back() = y;
}

}  // namespace softarm::rod
