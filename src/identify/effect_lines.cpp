#include "effect_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/parallel.h"
#include "math/so3.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Predicted;

constexpr double kStep = 1e-2;       // of differences of whole predictions, in scales
constexpr double kStartStep = 0.05;  // the same by how a trial found the effects, in standard deviations
const model::Dynamics kAtRest{false, 0.0};

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

model::Prepared prepare(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  try {
    return model::prepare(arm, trials);
  } catch (const model::UnusableTrials& e) {
    throw IdentifyError(e.what());
  }
}

/// The arm with one constant a step on.
arm::Arm stepped(const arm::Arm& arm, const FreeConstant& constant, double& step) {
  const double value = value_of(arm, constant.ref);
  step = kStep * constant.scale;
  if (value + step > constant.range.high) step = -step;
  arm::Arm there = arm;
  for (const int i : segments_of(constant.ref))
    arm::spec_of(constant.ref.kind)
        .set(there.segments[static_cast<std::size_t>(i)], constant.ref.index, value + step);
  return there;
}

/// How much more effects do there than here, 6 for each body; turns on what is turned back already.
VectorXd more_than(const VectorXd& here, VectorXd there) {
  for (Eigen::Index row = 0; row < here.size(); row += 6) {
    there.segment<3>(row) -= here.segment<3>(row);
    there.segment<3>(row + 3) = rotation_vector(math::exp_so3(here.segment<3>(row + 3)).conjugate() *
                                                math::exp_so3(there.segment<3>(row + 3)));
  }
  return there;
}

/// What effects do to the bodies of a block, 6 for each: by how much they move and, a rotation vector, turn
/// them.
VectorXd moved_and_turned(const arm::Arm& arm, const model::Block& block, const Predicted& with,
                          const Predicted& without) {
  VectorXd all(6 * with.p.cols());
  for (Eigen::Index i = 0; i < with.p.cols(); ++i) {
    const int body = block.bodies[static_cast<std::size_t>(i)].body;
    const double s_m = arm.bodies[static_cast<std::size_t>(body)].arclength_m;
    all.segment<3>(6 * i) = with.p.col(i) - without.p.col(i);
    all.segment<3>(6 * i + 3) =
        rotation_vector(section_at(with.shape, s_m) * section_at(without.shape, s_m).conjugate());
  }
  return all;
}

}  // namespace

EffectLines::EffectLines(const arm::Arm& arm, std::vector<model::Present> effects,
                         const std::vector<trial::Trial>& trials, unsigned jobs,
                         std::map<std::size_t, VectorXd> starts)
    : arm_(arm), effects_(std::move(effects)), jobs_(jobs), trials_(trials.size()), without_(trials.size()) {
  for (const model::Present& present : effects_) {
    const std::string& id = present.effect->info().id;
    for (const model::StartNumber& number : present.effect->starts(arm_, present.values))
      numbers_.push_back({"", id, number.name, number.unit, 0.0, number.sd});
  }
  const auto numbers = static_cast<Eigen::Index>(numbers_.size());
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const auto found = starts.find(t);
    trials_[t].start = found == starts.end() ? VectorXd(VectorXd::Zero(numbers)) : found->second;
  }
  const model::Prepared prepared = prepare(arm_, trials);
  math::in_parallel(trials.size(), jobs_, [&](std::size_t t) {
    without_[t].name = trials[t].name;
    const auto data = std::find_if(prepared.trials.begin(), prepared.trials.end(),
                                   [&](const model::TrialData& one) { return one.name == trials[t].name; });
    if (data == prepared.trials.end()) return;
    trials_[t].data = *data;
    predict(trials_[t]);
    without_[t] = corrected(trials_[t], trials[t]);
  });
}

EffectStart EffectLines::start(Eigen::Index number) const {
  return numbers_.at(static_cast<std::size_t>(number));
}

std::vector<model::Present> EffectLines::effects_with(const VectorXd& start) const {
  std::vector<model::Present> effects = effects_;
  Eigen::Index first = 0;
  for (model::Present& present : effects) {
    const auto count = static_cast<Eigen::Index>(present.effect->starts(arm_, present.values).size());
    present.start = start.segment(first, count);
    first += count;
  }
  return effects;
}

void EffectLines::predict(OfTrial& trial) const {
  const model::TrialData& data = trial.data;
  model::ExtendedModel model(arm_);
  model.predict(arm_, {}, kAtRest, data, nullptr, trial.without);
  model.predict(arm_, effects_with(trial.start), kAtRest, data, &trial.without, trial.with);
  trial.moved.resize(arm_.bodies.size());
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    if (!trial.with[k].solved || !trial.without[k].solved) continue;
    const VectorXd all = moved_and_turned(arm_, data.blocks[k], trial.with[k], trial.without[k]);
    for (std::size_t i = 0; i < data.blocks[k].bodies.size(); ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(i);
      trial.moved[static_cast<std::size_t>(data.blocks[k].bodies[i].body)].push_back(
          {data.begin_s + trial.with[k].instant.t_s, k, all.segment<3>(row), all.segment<3>(row + 3)});
    }
  }
}

EffectLines::Between EffectLines::between(const std::vector<Moved>& list, double stamp_s) {
  const auto after = std::lower_bound(list.begin(), list.end(), stamp_s,
                                      [](const Moved& moved, double s) { return moved.stamp_s < s; });
  const bool has_after = after != list.end() && after->stamp_s - stamp_s < model::kLongestPause_s;
  const bool has_before =
      after != list.begin() && stamp_s - std::prev(after)->stamp_s < model::kLongestPause_s;
  if (!has_after && !has_before) return {};
  if (!has_before) return {&*after, &*after, 0.0};
  const Moved& before = *std::prev(after);
  if (!has_after) return {&before, &before, 0.0};
  return {&before, &*after, (stamp_s - before.stamp_s) / (after->stamp_s - before.stamp_s)};
}

trial::Trial EffectLines::corrected(const OfTrial& of, const trial::Trial& trial) const {
  trial::Trial out;
  out.name = trial.name;
  out.inputs = trial.inputs;
  Eigen::Matrix3d base = arm_.base.fixed_pose.linear();
  bool placed = !arm_.base.body;
  for (const trial::Frame& frame : trial.frames) {
    if (arm_.base.body && frame.base_body && frame.base_body->matrix().allFinite()) {
      base = (*frame.base_body * arm_.base.rod_in_body).linear();
      placed = true;
    }
    if (!placed) continue;
    trial::Frame changed = frame;
    changed.bodies.clear();
    for (trial::BodyObservation seen : frame.bodies) {
      if (seen.body < 0 || seen.body >= static_cast<int>(of.moved.size())) continue;
      const Between at = between(of.moved[static_cast<std::size_t>(seen.body)], frame.stamp_s());
      if (at.before == nullptr) continue;
      if (seen.q_mocap) {
        // About the section's place, which may be off the body's origin.
        const Eigen::Vector3d turn = base * at.mean(&Moved::turn);
        const double angle = turn.norm();
        const Eigen::Quaterniond back(Eigen::AngleAxisd(
            -angle, angle > 0.0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitZ()));
        const arm::MeasuredBody& body = arm_.bodies[static_cast<std::size_t>(seen.body)];
        const Eigen::Vector3d lever = *seen.q_mocap * body.section_in_body.translation();
        seen.q_mocap = back * *seen.q_mocap;
        seen.p_mocap += lever - back * lever;
      }
      seen.p_mocap -= base * at.mean(&Moved::p);
      changed.bodies.push_back(seen);
    }
    if (!changed.bodies.empty()) out.frames.push_back(std::move(changed));
  }
  return out;
}

std::vector<MatrixXd> EffectLines::slopes_of_blocks(const OfTrial& of,
                                                    const std::vector<FreeConstant>& constants) const {
  model::ExtendedModel model(arm_);
  std::vector<MatrixXd> slopes(of.with.size());
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    if (of.with[k].solved && of.without[k].solved)
      slopes[k] = MatrixXd::Zero(6 * of.with[k].p.cols(), static_cast<Eigen::Index>(constants.size()));
  }
  std::vector<Predicted> with, without;
  for (std::size_t j = 0; j < constants.size(); ++j) {
    double step = 0.0;
    const arm::Arm there = stepped(arm_, constants[j], step);
    model.predict(there, {}, kAtRest, of.data, &of.without, without);
    model.predict(there, effects_with(of.start), kAtRest, of.data, &of.with, with);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      if (slopes[k].size() == 0 || !with[k].solved || !without[k].solved) continue;
      const model::Block& block = of.data.blocks[k];
      slopes[k].col(static_cast<Eigen::Index>(j)) =
          more_than(moved_and_turned(arm_, block, of.with[k], of.without[k]),
                    moved_and_turned(arm_, block, with[k], without[k])) /
          step;
    }
  }
  return slopes;
}

std::vector<MatrixXd> EffectLines::slopes_by_start(const OfTrial& of) const {
  const auto numbers = static_cast<Eigen::Index>(numbers_.size());
  std::vector<MatrixXd> slopes(of.with.size());
  if (numbers == 0) return slopes;
  model::ExtendedModel model(arm_);
  std::vector<Predicted> with;
  for (Eigen::Index j = 0; j < numbers; ++j) {
    VectorXd start = of.start;
    start[j] += kStartStep;
    model.predict(arm_, effects_with(start), kAtRest, of.data, &of.with, with);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      if (!of.with[k].solved || !of.without[k].solved || !with[k].solved) continue;
      if (slopes[k].size() == 0) slopes[k] = MatrixXd::Zero(6 * of.with[k].p.cols(), numbers);
      const model::Block& block = of.data.blocks[k];
      slopes[k].col(j) = more_than(moved_and_turned(arm_, block, of.with[k], of.without[k]),
                                   moved_and_turned(arm_, block, with[k], of.without[k])) /
                         kStartStep;
    }
  }
  return slopes;
}

Slopes EffectLines::slopes_of_frame(const OfTrial& of, const std::vector<MatrixXd>& by_block,
                                    const trial::StaticFrame& frame, Eigen::Index constants) const {
  const auto count = 3 * static_cast<Eigen::Index>(frame.bodies.size());
  const auto numbers = static_cast<Eigen::Index>(numbers_.size());
  Slopes slopes{MatrixXd::Zero(count, constants), MatrixXd::Zero(count, constants),
                MatrixXd::Zero(count, numbers), MatrixXd::Zero(count, numbers)};
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const int body = frame.bodies[k].body;
    const Between at = between(of.moved[static_cast<std::size_t>(body)], frame.stamp_s);
    if (at.before == nullptr) continue;
    const auto add = [&](const Moved& moved, double share, const std::vector<MatrixXd>& by_block_of,
                         MatrixXd& p, MatrixXd& tangent) {
      const MatrixXd& rows = by_block_of[moved.block];
      if (rows.size() == 0) return;
      const model::Block& block = of.data.blocks[moved.block];
      const auto place = std::find_if(block.bodies.begin(), block.bodies.end(),
                                      [&](const model::Seen& seen) { return seen.body == body; }) -
                         block.bodies.begin();
      const auto to = 3 * static_cast<Eigen::Index>(k);
      p.middleRows<3>(to) += share * rows.middleRows<3>(6 * place);
      if (!frame.bodies[k].tangent_base) return;
      const Eigen::Matrix3Xd turn = rows.middleRows<3>(6 * place + 3);
      tangent.middleRows<3>(to) -= share * math::skew(*frame.bodies[k].tangent_base) * turn;
    };
    for (const auto& [moved, share] : {std::pair(at.before, 1.0 - at.share), std::pair(at.after, at.share)}) {
      add(*moved, share, by_block, slopes.p, slopes.tangent);
      if (numbers > 0) add(*moved, share, of.by_start, slopes.p_by_start, slopes.tangent_by_start);
    }
  }
  return slopes;
}

Line EffectLines::line(const std::vector<FreeConstant>& constants,
                       const std::vector<trial::StaticFrame>& frames) {
  const auto count = static_cast<Eigen::Index>(constants.size());
  Line line;
  line.about.resize(count);
  std::vector<std::string> names;
  for (Eigen::Index j = 0; j < count; ++j) {
    const ConstantRef& ref = constants[static_cast<std::size_t>(j)].ref;
    line.about[j] = value_of(arm_, ref);
    names.push_back(name_of(arm_, ref));
  }
  if (names != names_) {
    by_block_.resize(trials_.size());
    math::in_parallel(trials_.size(), jobs_, [&](std::size_t t) {
      by_block_[t] = slopes_of_blocks(trials_[t], constants);
      if (trials_[t].by_start.empty()) trials_[t].by_start = slopes_by_start(trials_[t]);
    });
    names_ = names;
  }
  for (const trial::StaticFrame& frame : frames) line.starts[frame.trial] = trials_[frame.trial].start;
  for (const trial::StaticFrame& frame : frames)
    line.frames.push_back(slopes_of_frame(trials_[frame.trial], by_block_[frame.trial], frame, count));
  return line;
}

}  // namespace softarm::identify
