#include "joint_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "arm/constant_spec.h"
#include "math/parallel.h"
#include "policy.h"
#include "sequences.h"
#include "unseen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Block;
using model::Dynamics;
using model::Predicted;
using model::Present;
using model::Seen;
using model::SeenTangent;
using model::TrialData;

/// For scales that do not depend on what was recorded.
struct NothingRecorded : arm::RecordedInputs {
  std::vector<double> values(const std::string&) const override { return {}; }
  std::string load_advice() const override { return {}; }
};

std::vector<std::vector<bool>> unseen_without(const std::vector<std::size_t>& sequences,
                                              const std::vector<TrialData>& trials) {
  std::vector<double> session_s;
  for (const TrialData& trial : trials) session_s.push_back(trial.series.session_s);
  return predicted_without(sequences, session_s);
}

/// Size at which a constant matters: its own, or what makes the same difference as its fellows.
double scale_of(const arm::Arm& arm, const identify::ConstantRef& ref) {
  using identify::ConstantKind;
  const double value = std::abs(identify::value_of(arm, ref));
  const arm::Segment& segment = arm.segments[static_cast<std::size_t>(ref.segment)];
  using arm::kUsualPressure_pa;
  double least = 0.0;
  switch (ref.kind) {
    case ConstantKind::kMomentGain:
      least = segment.bending_stiffness.base_nm2 * 1.0 / segment.length_m / kUsualPressure_pa;
      break;
    case ConstantKind::kElongation:
      least = 0.03 * segment.length_m / kUsualPressure_pa;
      break;
    case ConstantKind::kPerMinPressure:
    case ConstantKind::kPerJammingPressure:
      least = 0.3 * segment.bending_stiffness.base_nm2 / kUsualPressure_pa;
      break;
    case ConstantKind::kChamberSaturation:
    case ConstantKind::kChambersSaturation:
    case ConstantKind::kTendonSaturation:
    case ConstantKind::kTendonsSaturation:
    case ConstantKind::kCableSaturation:
    case ConstantKind::kCablesSaturation:
    case ConstantKind::kPerMeanPressure:
    case ConstantKind::kPerChamber:
    case ConstantKind::kPerTension:
    case ConstantKind::kPerMinTension:
    case ConstantKind::kPerTendon:
    case ConstantKind::kPerAngle:
    case ConstantKind::kPerMinAngle:
    case ConstantKind::kPerCable:
    case ConstantKind::kJointCompliance:
    case ConstantKind::kCableGain:
    case ConstantKind::kTendonOffset:
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      least = arm::spec_of(ref.kind).scale(segment, ref.index, NothingRecorded());
      break;
    default:
      break;
  }
  return ref.kind == ConstantKind::kLength ? 0.05 * value : std::max(value, least);
}

}  // namespace

double value_of(const JointParameters& p, const JointUnknown& c) {
  switch (c.kind) {
    case JointUnknown::Kind::kConstant:
      return p.constants[c.index];
    case JointUnknown::Kind::kViscoelasticLag:
      return p.viscoelastic_lag_s;
    case JointUnknown::Kind::kMount:
      return p.mounts(c.parameter, c.index);
    case JointUnknown::Kind::kEffect:
      break;
  }
  return p.effects[static_cast<std::size_t>(c.index)].values[c.parameter];
}

VectorXd Linearised::unknowns() const {
  VectorXd x(static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const JointUnknown& c = columns[static_cast<std::size_t>(j)];
    x[j] = value_of(at, c) / c.scale;
  }
  return x;
}

JointModel::JointModel(const arm::Arm& arm, const std::vector<TrialData>& trials, unsigned jobs,
                       const std::vector<std::string>& held, const std::vector<std::string>& tied,
                       const std::vector<Present>& known)
    : arm_(arm),
      known_(known),
      trials_(trials),
      jobs_(jobs),
      sequences_(sequences_of(trials)),
      predicted_without_(unseen_without(sequences_, trials)),
      unknown_{kPolicy.motion.share, kPolicy.motion.stiffness_share} {
  constants_ = identify::default_free(arm);
  for (const identify::ConstantRef& ref : identify::constants_of(arm)) {
    if (ref.kind == identify::ConstantKind::kLength) constants_.push_back(ref);
  }
  for (const identify::ConstantRef& kept : identify::matching(arm, held)) {
    const auto same = [&](const identify::ConstantRef& c) {
      return c.kind == kept.kind && c.segment == kept.segment && c.index == kept.index;
    };
    constants_.erase(std::remove_if(constants_.begin(), constants_.end(), same), constants_.end());
  }
  constants_ = identify::tie_constants(arm, constants_, tied);
  models_.reserve(trials.size());
  for (const TrialData& trial : trials) {
    models_.emplace_back(arm);
    std::vector<bool> used;
    turned_.resize(arm.bodies.size(), false);
    for (const Block& block : trial.blocks) {
      used.push_back(!block.set_aside && !block.bodies.empty());
      for (const SeenTangent& seen : block.tangents) turned_[static_cast<std::size_t>(seen.body)] = true;
    }
    motion_sd_m_.emplace_back(used.size(), 0.0);
    used_.push_back(std::move(used));
  }
}

std::vector<Present> JointModel::all(const std::vector<Present>& fitted) const {
  std::vector<Present> list = known_;
  list.insert(list.end(), fitted.begin(), fitted.end());
  return list;
}

arm::Arm JointModel::arm_with(const VectorXd& constants) const {
  arm::Arm arm = arm_;
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const double value = constants[static_cast<Eigen::Index>(j)];
    if (constants_[j].kind == identify::ConstantKind::kLength) {
      // What the laws say of it; bodies keep their place at rest, and the arm its weight.
      for (const int i : identify::segments_of(constants_[j]))
        arm.segments[static_cast<std::size_t>(i)].length_m = value;
    } else {
      identify::set_value(arm, constants_[j], value);
    }
  }
  return arm;
}

/// One for the arm: its segments' by their lengths.
double JointModel::viscoelastic_lag_s() const {
  double sum_s = 0.0, length_m = 0.0;
  for (const arm::Segment& segment : arm_.segments) {
    sum_s += segment.length_m * segment.wall.lag_s.value_or(arm::Wall::kUsualLag_s);
    length_m += segment.length_m;
  }
  return sum_s / length_m;
}

JointParameters JointModel::start() const {
  JointParameters p;
  p.constants.resize(static_cast<Eigen::Index>(constants_.size()));
  for (std::size_t j = 0; j < constants_.size(); ++j)
    p.constants[static_cast<Eigen::Index>(j)] = identify::value_of(arm_, constants_[j]);
  p.viscoelastic_lag_s = std::min(viscoelastic_lag_s(), kPolicy.fit.most_viscoelastic_lag_s);
  p.mounts = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(arm_.bodies.size()));
  return p;
}

std::vector<JointUnknown> JointModel::columns(const JointParameters& parameters) const {
  std::vector<JointUnknown> list;
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const arm::Range range = identify::allowed_range(arm_, constants_[j]);
    JointUnknown c;
    c.index = static_cast<int>(j);
    c.scale = scale_of(arm_, constants_[j]);
    c.low = range.low;
    c.high = range.high;
    c.start = identify::value_of(arm_, constants_[j]) / c.scale;
    c.prior_sd = kPolicy.fit.constant_sd;
    list.push_back(c);
  }
  JointUnknown lag;
  lag.kind = JointUnknown::Kind::kViscoelasticLag;
  lag.scale = std::max(viscoelastic_lag_s(), arm::Wall::kUsualLag_s);
  lag.high = kPolicy.fit.most_viscoelastic_lag_s;
  lag.start = start().viscoelastic_lag_s / lag.scale;
  lag.prior_sd = 1.0;
  list.push_back(lag);
  for (int b = 0; b < static_cast<int>(turned_.size()); ++b) {
    if (!turned_[static_cast<std::size_t>(b)]) continue;
    for (int axis = 0; axis < 2; ++axis) {
      JointUnknown c;
      c.kind = JointUnknown::Kind::kMount;
      c.index = b;
      c.parameter = axis;
      c.scale = kPolicy.fit.mount_sd_rad;
      c.low = -kPolicy.fit.most_mount_rad;
      c.high = kPolicy.fit.most_mount_rad;
      c.prior_sd = 1.0;
      list.push_back(c);
    }
  }
  for (std::size_t e = 0; e < parameters.effects.size(); ++e) {
    const model::Info& info = parameters.effects[e].effect->info();
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
      const model::Parameter& parameter = info.parameters[k];
      // What has no end is no number of the physics, but says where a law was learnt.
      if (parameter.counts || parameter.held || !std::isfinite(parameter.high) ||
          !parameters.effects[e].effect->has_parameter(arm_, static_cast<int>(k)))
        continue;
      const bool size = k < static_cast<std::size_t>(info.sizes);
      const double value = parameters.effects[e].values[static_cast<Eigen::Index>(k)];
      JointUnknown c;
      c.kind = JointUnknown::Kind::kEffect;
      c.index = static_cast<int>(e);
      c.parameter = static_cast<int>(k);
      c.scale = parameter.usual != 0.0 ? std::abs(parameter.usual) : 0.1 * (parameter.high - parameter.low);
      c.low = parameter.low;
      c.high = parameter.along ? std::min(parameter.high, arm_.total_length_m()) : parameter.high;
      c.start = size ? 0.0 : value / c.scale;
      c.prior_sd = size ? kPolicy.fit.size_sd : kPolicy.fit.shape_sd;
      list.push_back(c);
    }
  }
  return list;
}

double JointModel::sd_m(std::size_t trial, std::size_t block, const Seen& seen) const {
  return std::hypot(seen.white_sd_m, motion_sd_m_[trial][block]);
}

double JointModel::sd_rad(std::size_t trial, std::size_t block, const SeenTangent& seen) const {
  // Where an arc of this length is off by so much at its end, it is turned by twice that over its length.
  return std::hypot(seen.white_sd_rad, 2.0 * motion_sd_m_[trial][block] / arm_.total_length_m());
}

std::size_t JointModel::leave_out_ends(const Delay& delay) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd& t_s = trials_[t].series.t_s;
    for (std::size_t k = 0; k < trials_[t].blocks.size(); ++k) {
      const model::Block& block = trials_[t].blocks[k];
      const double first_s = t_s[static_cast<Eigen::Index>(block.first)];
      const double last_s = t_s[static_cast<Eigen::Index>(block.last) - 1];
      if ((first_s - delay.at(trials_[t].series, first_s) >= t_s[0] &&
           last_s - delay.at(trials_[t].series, last_s) <= t_s[t_s.size() - 1]) ||
          !used_[t][k])
        continue;
      used_[t][k] = false;
      ++count;
    }
  }
  return count;
}

void JointModel::each_trial(unsigned jobs, const std::function<void(std::size_t)>& work) const {
  std::vector<std::size_t> order(trials_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return trials_[a].blocks.size() > trials_[b].blocks.size();
  });
  math::in_parallel(order.size(), jobs, [&](std::size_t i) { work(order[i]); });
}

void JointModel::look_at(const std::vector<std::size_t>& trials) {
  if (!all_used_.empty()) used_ = std::move(all_used_);
  all_used_.clear();
  looked_at_.clear();
  if (trials.empty()) return;
  all_used_ = used_;
  looked_at_.assign(trials_.size(), false);
  for (const std::size_t t : trials) looked_at_[t] = true;
  for (std::size_t t = 0; t < used_.size(); ++t)
    if (!looked_at_[t]) used_[t].assign(used_[t].size(), false);
}

Vector3d JointModel::by_mount(const JointParameters& parameters, const Eigen::Quaterniond& q_section,
                              int body) const {
  const auto askew = parameters.mounts.col(body);
  return q_section * Vector3d(askew.y(), -askew.x(), 0.0);
}

void JointModel::mount(const JointParameters& parameters, std::size_t trial,
                       std::vector<Predicted>& predicted) const {
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    const std::vector<SeenTangent>& tangents = trials_[trial].blocks[k].tangents;
    for (std::size_t i = 0; i < tangents.size() && predicted[k].solved; ++i)
      predicted[k].tangents.col(static_cast<Eigen::Index>(i)) +=
          by_mount(parameters, predicted[k].q_tangents[i], tangents[i].body);
  }
}

Dynamics JointModel::dynamics(const JointParameters& parameters, std::size_t trial) const {
  return {!quasi_static_, parameters.viscoelastic_lag_s, modes_.empty() ? nullptr : &modes_[trial]};
}

std::vector<Predicted> JointModel::predict_trial(const JointParameters& parameters, std::size_t trial,
                                                 const std::vector<Predicted>* start) {
  std::vector<Predicted> made;
  models_[trial].predict(arm_with(parameters.constants), all(parameters.effects), dynamics(parameters, trial),
                         trials_[trial], start, made);
  mount(parameters, trial, made);
  add_swings(trial, made);
  return made;
}

void JointModel::predict(const JointParameters& parameters, const std::vector<std::vector<Predicted>>* start,
                         std::vector<std::vector<Predicted>>& out) {
  std::vector<std::vector<Predicted>> made(trials_.size());
  each_trial([&](std::size_t t) {
    if (looks_at(t))
      made[t] = predict_trial(parameters, t, start != nullptr ? &(*start)[t] : nullptr);
    else
      made[t].resize(trials_[t].blocks.size());
  });
  out = std::move(made);
}

VectorXd JointModel::residual(std::size_t trial, const std::vector<Predicted>& predicted) const {
  const TrialData& data = trials_[trial];
  Eigen::Index rows = 0;
  for (const Block& block : data.blocks)
    rows += 3 * static_cast<Eigen::Index>(block.bodies.size() + block.tangents.size());
  VectorXd r = VectorXd::Zero(rows);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    for (std::size_t i = 0; i < data.blocks[k].bodies.size(); ++i, row += 3) {
      if (!used_[trial][k] || !predicted[k].solved) continue;
      const Seen& seen = data.blocks[k].bodies[i];
      const Vector3d e =
          (seen.p_base - predicted[k].p.col(static_cast<Eigen::Index>(i))) / sd_m(trial, k, seen);
      r.segment<3>(row) = e;
    }
  }
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    for (std::size_t i = 0; i < data.blocks[k].tangents.size(); ++i, row += 3) {
      if (!used_[trial][k] || !predicted[k].solved) continue;
      const SeenTangent& seen = data.blocks[k].tangents[i];
      r.segment<3>(row) = (seen.tangent_base - predicted[k].tangents.col(static_cast<Eigen::Index>(i))) /
                          sd_rad(trial, k, seen);
    }
  }
  return r;
}

}  // namespace softarm::diagnose
