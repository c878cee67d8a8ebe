#include "joint_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "softarm/math/parallel.h"

namespace softarm::diagnose {
namespace {

using effects::Block;
using effects::Dynamics;
using effects::Predicted;
using effects::Present;
using effects::Seen;
using effects::TrialData;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kChunk_s = 2.0;
constexpr double kRetardation_s = 0.02;  // usual delay of a wall, and how well that is known
constexpr double kMostRetardation_s = 0.2;
constexpr double kStep = 1e-3;            // of derivatives, in scales
constexpr double kWholeStep = 1e-2;       // of differences of whole predictions
constexpr double kEffectPriorSd = 5.0;    // in usual sizes
constexpr double kHuber = 4.0;            // times the typical distance
constexpr double kMedianOfChi3 = 1.5382;  // of the length of a normal vector in three dimensions
constexpr double kSwingDecay_s = 0.8;     // of what a sudden motion leaves
constexpr double kMotionShare = 0.3;      // of what inertia and delay do that is not known
constexpr double kSwing_m = 0.0015;

/// Size at which a constant matters: its own, or what makes the same difference as its fellows.
double scale_of(const Arm& arm, const identify::ConstantRef& ref) {
  using identify::ConstantKind;
  const double value = std::abs(identify::value_of(arm, ref));
  const Segment& segment = arm.segments[static_cast<std::size_t>(ref.segment)];
  constexpr double kUsualPressure_pa = 5e4;
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
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      least = 0.1 / segment.length_m;
      break;
    default:
      break;
  }
  return ref.kind == ConstantKind::kLength ? 0.05 * value : std::max(value, least);
}

}  // namespace

double huber_weight(double distance, double threshold) {
  return distance <= threshold ? 1.0 : threshold / distance;
}

VectorXd Linearised::unknowns() const {
  VectorXd x(static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Column& c = columns[static_cast<std::size_t>(j)];
    const double value = c.kind == Column::Kind::kConstant ? at.constants[c.index]
                         : c.kind == Column::Kind::kRetardation
                             ? at.retardation_s
                             : at.effects[static_cast<std::size_t>(c.index)].values[c.parameter];
    x[j] = value / c.scale;
  }
  return x;
}

JointModel::JointModel(const Arm& arm, const std::vector<TrialData>& trials, unsigned jobs,
                       const std::vector<std::string>& held, const std::vector<std::string>& tied,
                       const std::vector<Present>& known)
    : arm_(arm),
      known_(known),
      trials_(trials),
      jobs_(jobs),
      slow_sd_m_(VectorXd::Zero(static_cast<Eigen::Index>(arm.bodies.size()))) {
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
    for (const Block& block : trial.blocks) used.push_back(!block.set_aside);
    motion_sd_m_.emplace_back(used.size(), 0.0);
    used_.push_back(std::move(used));
  }
}

std::vector<Present> JointModel::all(const std::vector<Present>& fitted) const {
  std::vector<Present> list = known_;
  list.insert(list.end(), fitted.begin(), fitted.end());
  return list;
}

Arm JointModel::arm_with(const VectorXd& constants) const {
  Arm arm = arm_;
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

Parameters JointModel::start() const {
  Parameters p;
  p.constants.resize(static_cast<Eigen::Index>(constants_.size()));
  for (std::size_t j = 0; j < constants_.size(); ++j)
    p.constants[static_cast<Eigen::Index>(j)] = identify::value_of(arm_, constants_[j]);
  p.retardation_s = kRetardation_s;
  return p;
}

std::vector<Column> JointModel::columns(const Parameters& parameters) const {
  std::vector<Column> list;
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const Range range = identify::allowed_range(arm_, constants_[j]);
    Column c;
    c.index = static_cast<int>(j);
    c.scale = scale_of(arm_, constants_[j]);
    c.low = range.low;
    c.high = range.high;
    c.start = identify::value_of(arm_, constants_[j]) / c.scale;
    c.prior_sd = 3.0;
    list.push_back(c);
  }
  Column delay;
  delay.kind = Column::Kind::kRetardation;
  delay.scale = kRetardation_s;
  delay.high = kMostRetardation_s;
  delay.start = 1.0;
  delay.prior_sd = 1.0;
  list.push_back(delay);
  for (std::size_t e = 0; e < parameters.effects.size(); ++e) {
    const effects::Info& info = parameters.effects[e].effect->info();
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
      const effects::Parameter& parameter = info.parameters[k];
      if (parameter.counts) continue;
      const bool size = k < static_cast<std::size_t>(info.sizes);
      const double value = parameters.effects[e].values[static_cast<Eigen::Index>(k)];
      Column c;
      c.kind = Column::Kind::kEffect;
      c.index = static_cast<int>(e);
      c.parameter = static_cast<int>(k);
      c.scale = parameter.usual != 0.0 ? std::abs(parameter.usual) : 0.1 * (parameter.high - parameter.low);
      c.low = parameter.low;
      c.high = parameter.high;
      c.start = size ? 0.0 : value / c.scale;
      c.prior_sd = size ? kEffectPriorSd : 1.0;
      list.push_back(c);
    }
  }
  return list;
}

double JointModel::sd_m(std::size_t trial, std::size_t block, const Seen& seen) const {
  return std::sqrt(seen.white_sd_m * seen.white_sd_m + std::pow(slow_sd_m_[seen.body], 2) +
                   std::pow(motion_sd_m_[trial][block], 2));
}

void JointModel::predict(const Parameters& parameters, const std::vector<std::vector<Predicted>>* start,
                         std::vector<std::vector<Predicted>>& out) {
  const Arm arm = arm_with(parameters.constants);
  std::vector<std::vector<Predicted>> made(trials_.size());
  in_parallel(trials_.size(), jobs_, [&](std::size_t t) {
    models_[t].predict(arm, all(parameters.effects), Dynamics{true, parameters.retardation_s}, trials_[t],
                       start != nullptr ? &(*start)[t] : nullptr, made[t]);
  });
  out = std::move(made);
}

VectorXd JointModel::residual(std::size_t trial, const std::vector<Predicted>& predicted) const {
  const TrialData& data = trials_[trial];
  Eigen::Index rows = 0;
  for (const Block& block : data.blocks) rows += 3 * static_cast<Eigen::Index>(block.bodies.size());
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
  return r;
}

void JointModel::set_threshold(const std::vector<std::vector<Predicted>>& predicted) {
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd r = residual(t, predicted[t]);
    for (Eigen::Index i = 0; i < r.size(); i += 3) {
      const double d = r.segment<3>(i).norm();
      if (d > 0.0) distances.push_back(d);
    }
  }
  if (distances.empty()) return;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  threshold_ = kHuber * std::max(1.0, *middle / kMedianOfChi3) * kMedianOfChi3;
}

double JointModel::cost(const Parameters& parameters, const std::vector<std::vector<Predicted>>& predicted,
                        const std::vector<Column>& columns) const {
  double sum = 0.0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd r = residual(t, predicted[t]);
    for (Eigen::Index i = 0; i < r.size(); i += 3) {
      const double d = r.segment<3>(i).norm();
      sum += d <= threshold_ ? d * d : threshold_ * (2.0 * d - threshold_);
    }
    // A block without an equilibrium is as bad as one that is far off.
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      if (used_[t][k] && !predicted[t][k].solved)
        sum += 10.0 * threshold_ * threshold_ * static_cast<double>(trials_[t].blocks[k].bodies.size());
    }
  }
  Linearised dummy;
  dummy.at = parameters;
  dummy.columns = columns;
  const VectorXd x = dummy.unknowns();
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Column& c = columns[static_cast<std::size_t>(j)];
    sum += misfit_ * std::pow((x[j] - c.start) / c.prior_sd, 2);
  }
  return sum;
}

void set_unknown(Parameters& p, const Column& c, double x) {
  const double value = std::clamp(x * c.scale, c.low, c.high);
  switch (c.kind) {
    case Column::Kind::kConstant:
      p.constants[c.index] = value;
      break;
    case Column::Kind::kRetardation:
      p.retardation_s = value;
      break;
    case Column::Kind::kEffect:
      p.effects[static_cast<std::size_t>(c.index)].values[c.parameter] = value;
      break;
  }
}

effects::ExtendedModel::Varied JointModel::vary(std::size_t trial, const Parameters& parameters,
                                                const std::vector<Predicted>& predicted) {
  return models_[trial].vary(arm_with(parameters.constants), all(parameters.effects),
                             Dynamics{true, parameters.retardation_s}, trials_[trial], predicted);
}

void JointModel::differentiate(const Parameters& at, std::size_t trial, const std::vector<bool>& wanted,
                               std::vector<Predicted>& predicted) {
  models_[trial].differentiate(arm_with(at.constants), all(at.effects), Dynamics{true, at.retardation_s},
                               trials_[trial], wanted, predicted);
}

void JointModel::complete(Linearised& at) {
  if (at.complete) return;
  const std::vector<bool> all(rod().parameters().size(), true);
  in_parallel(trials_.size(), jobs_, [&](std::size_t t) { differentiate(at.at, t, all, at.predicted[t]); });
  at.complete = true;
}

VectorXd JointModel::signature(const Linearised& at, std::size_t trial,
                               const effects::ExtendedModel::Varied& varied, double step) const {
  const TrialData& data = trials_[trial];
  const std::vector<Predicted>& predicted = at.predicted[trial];
  const effects::ExtendedModel::Varied& reference = at.reference[trial];
  VectorXd out = VectorXd::Zero(3 * reference.seen.cols());
  Eigen::Index body = 0;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    const Block& block = data.blocks[k];
    const auto count = static_cast<Eigen::Index>(block.bodies.size());
    if (used_[trial][k] && predicted[k].solved && count > 0) {
      const auto column = static_cast<Eigen::Index>(k);
      const VectorXd moved = predicted[k].by_rod * (varied.values.col(column) - reference.values.col(column));
      for (Eigen::Index i = 0; i < count; ++i) {
        const double sd = sd_m(trial, k, block.bodies[static_cast<std::size_t>(i)]);
        out.segment<3>(3 * (body + i)) =
            (moved.segment<3>(3 * i) + varied.seen.col(body + i) - reference.seen.col(body + i)) /
            (step * sd);
      }
    }
    body += count;
  }
  return out;
}

Eigen::MatrixXd JointModel::signatures(const Linearised& at, std::size_t trial,
                                       const std::vector<Parameters>& changed,
                                       const std::vector<double>& steps) {
  Eigen::MatrixXd out(3 * at.reference[trial].seen.cols(), static_cast<Eigen::Index>(changed.size()));
  for (std::size_t j = 0; j < changed.size(); ++j)
    out.col(static_cast<Eigen::Index>(j)) =
        signature(at, trial, vary(trial, changed[j], at.predicted[trial]), steps[j]);
  return out;
}

Eigen::MatrixXd JointModel::differences(const Linearised& at, std::size_t trial,
                                        const std::vector<Parameters>& changed,
                                        const std::vector<double>& steps) {
  const TrialData& data = trials_[trial];
  const std::vector<Predicted>& predicted = at.predicted[trial];
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(3 * at.reference[trial].seen.cols(), static_cast<Eigen::Index>(changed.size()));
  std::vector<Predicted> there;
  for (std::size_t j = 0; j < changed.size(); ++j) {
    models_[trial].predict(arm_with(changed[j].constants), all(changed[j].effects),
                           Dynamics{true, changed[j].retardation_s}, data, &predicted, there);
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < data.blocks.size(); ++k) {
      for (std::size_t i = 0; i < data.blocks[k].bodies.size(); ++i, row += 3) {
        if (!used_[trial][k] || !predicted[k].solved || !there[k].solved) continue;
        const auto body = static_cast<Eigen::Index>(i);
        out.col(static_cast<Eigen::Index>(j)).segment<3>(row) =
            (there[k].p.col(body) - predicted[k].p.col(body)) /
            (steps[j] * sd_m(trial, k, data.blocks[k].bodies[i]));
      }
    }
  }
  return out;
}

Linearised JointModel::linearise(const Parameters& parameters,
                                 const std::vector<std::vector<Predicted>>* start, Derivatives how,
                                 bool known) {
  const bool whole = how == Derivatives::kWhole;
  const double size = whole ? kWholeStep : kStep;
  Linearised lin;
  lin.at = parameters;
  lin.columns = columns(parameters);
  if (known)
    lin.predicted = *start;
  else
    predict(parameters, start, lin.predicted);
  const auto count = static_cast<Eigen::Index>(lin.columns.size());
  std::vector<Parameters> changed(lin.columns.size(), parameters);
  std::vector<double> steps(lin.columns.size(), size);
  const VectorXd x = lin.unknowns();
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto c = static_cast<std::size_t>(j);
    // Away from a limit that is near.
    if ((x[j] + size) * lin.columns[c].scale > lin.columns[c].high) steps[c] = -size;
    set_unknown(changed[c], lin.columns[c], x[j] + steps[c]);
  }
  lin.residual.resize(trials_.size());
  lin.derivative.resize(trials_.size());
  lin.root_weight.resize(trials_.size());
  lin.reference.resize(trials_.size());
  std::vector<std::vector<Chunk>> chunks(trials_.size());
  in_parallel(trials_.size(), jobs_, [&](std::size_t t) {
    lin.reference[t] = vary(t, parameters, lin.predicted[t]);
    std::vector<effects::ExtendedModel::Varied> varied;
    std::vector<bool> touched(rod().parameters().size(), false);
    for (const Parameters& other : changed) {
      varied.push_back(vary(t, other, lin.predicted[t]));
      for (std::size_t p = 0; p < touched.size(); ++p) {
        const auto row = static_cast<Eigen::Index>(p);
        touched[p] = touched[p] || varied.back().values.row(row) != lin.reference[t].values.row(row);
      }
    }
    differentiate(parameters, t, touched, lin.predicted[t]);
    lin.residual[t] = residual(t, lin.predicted[t]);
    lin.derivative[t].resize(3 * lin.reference[t].seen.cols(), count);
    for (std::size_t c = 0; c < varied.size(); ++c)
      lin.derivative[t].col(static_cast<Eigen::Index>(c)) = signature(lin, t, varied[c], steps[c]);
    if (whole) lin.derivative[t] = differences(lin, t, changed, steps);
    lin.root_weight[t] = VectorXd::Zero(lin.residual[t].size());
    Eigen::Index row = 0;
    double from_s = -1e9;
    for (std::size_t k = 0; k < trials_[t].blocks.size(); ++k) {
      const Block& block = trials_[t].blocks[k];
      const double t_s = trials_[t].series.t_s[static_cast<Eigen::Index>(block.first)];
      if (t_s >= from_s + kChunk_s) {
        Chunk chunk;
        chunk.trial = t;
        chunk.information.setZero(count, count);
        chunk.gradient.setZero(count);
        chunks[t].push_back(std::move(chunk));
        from_s = t_s;
      }
      Chunk& chunk = chunks[t].back();
      chunk.all_rows += 3 * static_cast<Eigen::Index>(block.bodies.size());
      for (std::size_t i = 0; i < block.bodies.size(); ++i, row += 3) {
        const Vector3d r = lin.residual[t].segment<3>(row);
        if (r.isZero()) continue;
        const double w = std::sqrt(huber_weight(r.norm(), threshold_));
        lin.root_weight[t].segment<3>(row).setConstant(w);
        lin.residual[t].segment<3>(row) *= w;
        lin.derivative[t].middleRows<3>(row) *= w;
        const auto j = lin.derivative[t].middleRows<3>(row);
        chunk.information.noalias() += j.transpose() * j;
        chunk.gradient.noalias() += j.transpose() * (w * r);
        chunk.square += w * w * r.squaredNorm();
        chunk.rows += 3;
      }
    }
  });
  lin.information.setZero(count, count);
  lin.gradient.setZero(count);
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    for (Chunk& chunk : chunks[t]) {
      lin.information += chunk.information;
      lin.gradient += chunk.gradient;
      lin.square += chunk.square;
      lin.rows += chunk.rows;
      lin.chunks.push_back(std::move(chunk));
    }
  }
  for (Eigen::Index j = 0; j < count; ++j) {
    const Column& c = lin.columns[static_cast<std::size_t>(j)];
    const double weight = misfit_ / (c.prior_sd * c.prior_sd);
    lin.information(j, j) += weight;
    lin.gradient[j] += weight * (c.start - x[j]);
  }
  return lin;
}

Linearised JointModel::fit(Parameters parameters, const FitOptions& options,
                           const std::vector<std::vector<Predicted>>* start) {
  std::vector<std::vector<Predicted>> predicted;
  predict(parameters, start, predicted);
  set_threshold(predicted);
  Linearised lin;
  const bool feedback = answers_itself(parameters);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    lin = linearise(parameters, &predicted, Derivatives::kShapesHeld, !feedback);
    const double before = cost(parameters, lin.predicted, lin.columns);
    const VectorXd x = lin.unknowns();
    VectorXd step = lin.information.ldlt().solve(lin.gradient);
    // Unknowns that would leave their range stay at its end, and the others are solved for again.
    std::vector<bool> fixed(lin.columns.size(), false);
    for (int round = 0; round < 5; ++round) {
      bool more = false;
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        const Column& c = lin.columns[static_cast<std::size_t>(j)];
        if (fixed[static_cast<std::size_t>(j)]) continue;
        const double wanted = (x[j] + step[j]) * c.scale;
        if (wanted < c.low || wanted > c.high) {
          fixed[static_cast<std::size_t>(j)] = true;
          step[j] = (wanted < c.low ? c.low : c.high) / c.scale - x[j];
          more = true;
        }
      }
      if (!more) break;
      Eigen::MatrixXd h = lin.information;
      VectorXd g = lin.gradient;
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        if (!fixed[static_cast<std::size_t>(j)]) continue;
        g -= lin.information.col(j) * step[j];
      }
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        if (!fixed[static_cast<std::size_t>(j)]) continue;
        h.row(j).setZero();
        h.col(j).setZero();
        h(j, j) = 1.0;
        g[j] = step[j];
      }
      step = h.ldlt().solve(g);
    }
    double share = 1.0;
    bool better = false;
    Parameters next;
    std::vector<std::vector<Predicted>> there;
    for (int halving = 0; halving < 5 && !better; ++halving, share *= 0.4) {
      next = parameters;
      for (Eigen::Index j = 0; j < x.size(); ++j)
        set_unknown(next, lin.columns[static_cast<std::size_t>(j)], x[j] + share * step[j]);
      predict(next, &lin.predicted, there);
      better = cost(next, there, lin.columns) <= before;
    }
    if (!better) break;
    parameters = next;
    predicted = std::move(there);
    const VectorXd sd =
        lin.information.ldlt().solve(Eigen::MatrixXd::Identity(x.size(), x.size())).diagonal().cwiseSqrt();
    const double misfit = std::max(1.0, std::sqrt(lin.square / std::max(1, lin.rows)));
    set_threshold(predicted);
    if ((step.array() / sd.array()).abs().maxCoeff() < options.tolerance * misfit) break;
  }
  return linearise(parameters, &predicted,
                   feedback && options.whole ? Derivatives::kWhole : Derivatives::kShapesHeld, !feedback);
}

bool JointModel::answers_itself(const Parameters& parameters) const {
  const std::vector<Present> present = all(parameters.effects);
  return std::any_of(present.begin(), present.end(),
                     [](const Present& one) { return one.effect->needs_shape(); });
}

std::size_t JointModel::allow_for_motion(const std::vector<std::vector<Predicted>>& predicted) {
  // A swing spoils what is smaller than it is. Beside a model that is off by more, little would be won, and
  // of an arm that never rests nearly everything lost.
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const std::vector<Block>& blocks = trials_[t].blocks;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (!used_[t][k] || !predicted[t][k].solved) continue;
      for (std::size_t i = 0; i < blocks[k].bodies.size(); ++i)
        distances.push_back(
            (blocks[k].bodies[i].p_base - predicted[t][k].p.col(static_cast<Eigen::Index>(i))).norm());
    }
  }
  double swing_m = kSwing_m;
  if (!distances.empty()) {
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    swing_m = std::max(kSwing_m, *middle);
  }
  std::size_t aside = 0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    double envelope_m = 0.0;
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      const Predicted& now = predicted[t][k];
      envelope_m = now.instant.dt_s > 0.0 ? envelope_m * std::exp(-now.instant.dt_s / kSwingDecay_s) : 0.0;
      if (now.solved) envelope_m = std::max(envelope_m, now.inertial_m);
      motion_sd_m_[t][k] = kMotionShare * envelope_m;
      if (envelope_m > swing_m && used_[t][k]) {
        used_[t][k] = false;
        ++aside;
      }
    }
  }
  return aside;
}

}  // namespace softarm::diagnose
