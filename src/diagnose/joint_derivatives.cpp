// Derivatives of the joint model: by everything that is fitted, and by effects that are not in it yet.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/wall_memory.h"
#include "joint_model.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::VectorXd;
using model::Block;
using model::Predicted;
using model::Present;
using model::Seen;
using model::TrialData;

constexpr double kStep = 1e-3;              // of derivatives, in scales
constexpr double kWholeStep = 1e-2;         // of differences of whole predictions
constexpr std::size_t kChangesAtOnce = 16;  // so many of a trial are in memory

/// The parameters with one unknown each changed by a step; steps point away from a limit that is near.
std::vector<JointParameters> one_step_each(const Linearised& lin, std::vector<double>& steps) {
  std::vector<JointParameters> changed(lin.columns.size(), lin.at);
  const VectorXd x = lin.unknowns();
  for (std::size_t c = 0; c < lin.columns.size(); ++c) {
    const double at = x[static_cast<Eigen::Index>(c)];
    if ((at + steps[c]) * lin.columns[c].scale > lin.columns[c].high) steps[c] = -steps[c];
    set_unknown(changed[c], lin.columns[c], at + steps[c]);
  }
  return changed;
}

std::vector<Present> driving(std::vector<Present> effects) {
  effects.erase(std::remove_if(effects.begin(), effects.end(),
                               [](const Present& present) { return !present.effect->drives(); }),
                effects.end());
  return effects;
}

}  // namespace

void set_unknown(JointParameters& p, const JointUnknown& c, double x) {
  const double value = std::clamp(x * c.scale, c.low, c.high);
  switch (c.kind) {
    case JointUnknown::Kind::kConstant:
      p.constants[c.index] = value;
      break;
    case JointUnknown::Kind::kViscoelasticLag:
      p.viscoelastic_lag_s = value;
      break;
    case JointUnknown::Kind::kMount:
      p.mounts(c.parameter, c.index) = value;
      break;
    case JointUnknown::Kind::kEffect:
      p.effects[static_cast<std::size_t>(c.index)].values[c.parameter] = value;
      break;
  }
}

bool JointModel::driven_alike(const JointParameters& a, const JointParameters& b) const {
  const std::vector<Present> of_a = driving(all(a.effects)), of_b = driving(all(b.effects));
  const auto same = [](const Present& x, const Present& y) {
    return x.effect == y.effect && x.values == y.values && x.start.size() == y.start.size() &&
           x.start == y.start;
  };
  if (!std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), same)) return false;
  // Constants change what an effect makes of the inputs, and how walls follow.
  return a.constants == b.constants || (of_a.empty() && arm::LawMemory(arm_).empty());
}

model::ExtendedModel::Varied JointModel::vary(std::size_t trial, const JointParameters& parameters,
                                              const JointParameters& at,
                                              const std::vector<Predicted>& predicted) {
  return models_[trial].vary(arm_with(parameters.constants), all(parameters.effects),
                             dynamics(parameters, trial), trials_[trial], predicted,
                             driven_alike(parameters, at));
}

void JointModel::differentiate(const JointParameters& at, std::size_t trial, const std::vector<bool>& wanted,
                               std::vector<Predicted>& predicted) {
  models_[trial].differentiate(arm_with(at.constants), all(at.effects), dynamics(at, trial), trials_[trial],
                               wanted, predicted);
}

void JointModel::complete(Linearised& at) {
  if (at.complete) return;
  const std::vector<bool> all(rod().parameters().size(), true);
  each_trial([&](std::size_t t) { differentiate(at.at, t, all, at.predicted[t]); });
  at.complete = true;
}

namespace {

/// As it was before the residuals were weighed; 0 where they are.
Eigen::MatrixXd unweighted_derivative(const Linearised& at, std::size_t trial) {
  const VectorXd& root = at.root_weight[trial];
  return (root.array() > 0.0).select(root.cwiseInverse(), 0.0).matrix().asDiagonal() * at.derivative[trial];
}

/// For each column the one of a linearisation nearby that will do for it; -1: none. Constants and mounts act
/// nearly the same with an effect more or less. A fit of the same unknowns, to other trials, goes by these
/// alone: its columns are its own.
std::vector<Eigen::Index> columns_alike(const Linearised& near, const std::vector<JointUnknown>& columns) {
  std::vector<Eigen::Index> alike(columns.size(), -1);
  if (near.columns.size() == columns.size()) return alike;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const JointUnknown& c = columns[j];
    const auto same = std::find_if(near.columns.begin(), near.columns.end(), [&](const JointUnknown& n) {
      return c.kind != JointUnknown::Kind::kEffect && n.kind == c.kind && n.index == c.index &&
             n.parameter == c.parameter;
    });
    if (same != near.columns.end()) alike[j] = same - near.columns.begin();
  }
  return alike;
}

/// Of the rod's parameters, those that any of these changes moves in any block.
std::vector<bool> changed_by(const std::vector<model::ExtendedModel::Varied>& varied,
                             const model::ExtendedModel::Varied& reference) {
  Eigen::ArrayXd most = Eigen::ArrayXd::Zero(reference.values.rows());
  for (const model::ExtendedModel::Varied& one : varied)
    most = most.max((one.values - reference.values).cwiseAbs().rowwise().maxCoeff().array());
  return std::vector<bool>(most.data(), most.data() + most.size());
}

/// What a change of the rod does to a trial: of all bodies' places and, below, tangents, and, where the arm
/// swings, of its equilibria in the modes; one column per block.
struct Move {
  Eigen::MatrixXd bodies, in_modes, in_next;
};

/// Sum of derivatives by parameters, each times its change; most changes are those of a few. As exact as the
/// derivatives are.
void sum_by(const Eigen::MatrixXf& derivative, const VectorXd& change, const std::vector<Eigen::Index>& which,
            Eigen::VectorXf& sum) {
  sum.setZero(derivative.rows());
  for (const Eigen::Index j : which) sum += static_cast<float>(change[j]) * derivative.col(j);
}

/// Adds what is seen of a block, its bodies and below its tangents, to that of all bodies.
void add_seen(const Block& block, const Eigen::VectorXf& seen, Eigen::Ref<VectorXd> all) {
  const Eigen::Index bodies = all.size() / 6;
  Eigen::Index row = 0;
  for (const Seen& one : block.bodies)
    all.segment<3>(3 * one.body) += seen.segment<3>(3 * row++).cast<double>();
  for (const model::SeenTangent& one : block.tangents)
    all.segment<3>(3 * (bodies + one.body)) += seen.segment<3>(3 * row++).cast<double>();
}

/// What a change of the equilibria does beside moving the arm with them: it swings, and where it is held
/// there it swings less.
void add_swing(const TrialData& trial, const std::vector<Predicted>& predicted,
               const model::TrialModes& modes, const Eigen::MatrixXd& beyond, Eigen::MatrixXd& bodies) {
  for (Eigen::Index k = 0; k < beyond.cols(); ++k) {
    const auto block = static_cast<std::size_t>(k);
    if (modes[block] == nullptr) continue;
    bodies.col(k) += modes[block]->bodies * beyond.col(k);
    if (predicted[block].by_rod == nullptr) continue;
    const Eigen::MatrixXf& held_back = predicted[block].by_rod->held_back;
    if (held_back.cols() == beyond.rows())
      add_seen(trial.blocks[block], held_back * beyond.col(k).cast<float>(), bodies.col(k));
  }
}

}  // namespace

/// Of all bodies' places and, below, tangents, by each of several changes of the rod that swings as it does;
/// one column per block.
std::vector<Eigen::MatrixXd> JointModel::moved(
    const Linearised& at, std::size_t trial, const std::vector<model::ExtendedModel::Varied>& varied) const {
  const TrialData& data = trials_[trial];
  const std::vector<Predicted>& predicted = at.predicted[trial];
  const auto bodies = static_cast<Eigen::Index>(arm_.bodies.size());
  const Eigen::Index blocks = at.reference[trial].values.cols();
  std::vector<Move> moves(varied.size());
  for (Move& one : moves) one.bodies.setZero(6 * bodies, blocks);
  VectorXd change;
  Eigen::VectorXf move;
  std::vector<Eigen::Index> which;
  // Block by block: its derivatives are read once for all changes.
  for (Eigen::Index k = 0; k < blocks; ++k) {
    const Predicted& now = predicted[static_cast<std::size_t>(k)];
    const Block& block = data.blocks[static_cast<std::size_t>(k)];
    if (!now.solved) continue;
    const model::ByRod& by_rod = *now.by_rod;
    for (std::size_t c = 0; c < varied.size(); ++c) {
      change = varied[c].values.col(k) - at.reference[trial].values.col(k);
      which.clear();
      for (Eigen::Index j = 0; j < change.size(); ++j)
        if (change[j] != 0.0) which.push_back(j);
      if (which.empty()) continue;
      Move& of = moves[c];
      sum_by(by_rod.seen, change, which, move);
      add_seen(block, move, of.bodies.col(k));
      if (varied[c].swings || by_rod.modes_now.size() == 0) continue;
      if (of.in_modes.size() == 0) {
        of.in_modes.setZero(by_rod.modes_now.rows(), blocks);
        of.in_next = of.in_modes;
      }
      sum_by(by_rod.modes_now, change, which, move);
      of.in_modes.col(k) = move.cast<double>();
      if (by_rod.modes_next.size() == 0) continue;
      sum_by(by_rod.modes_next, change, which, move);
      of.in_next.col(k) = move.cast<double>();
    }
  }
  std::vector<Eigen::MatrixXd> all;
  for (Move& of : moves) {
    if (of.in_modes.size() > 0) {
      const Eigen::MatrixXd beyond = at.swing[trial]->beyond(of.in_modes, of.in_next);
      add_swing(data, predicted, modes_[trial], beyond, of.bodies);
    }
    all.push_back(std::move(of.bodies));
  }
  return all;
}

VectorXd JointModel::signature(const Linearised& at, std::size_t trial, const JointParameters& changed,
                               const model::ExtendedModel::Varied& varied, const Eigen::MatrixXd& moves,
                               double step) const {
  const TrialData& data = trials_[trial];
  const std::vector<Predicted>& predicted = at.predicted[trial];
  const model::ExtendedModel::Varied& reference = at.reference[trial];
  const auto bodies = static_cast<Eigen::Index>(arm_.bodies.size());
  VectorXd out = VectorXd::Zero(at.residual[trial].size());
  Eigen::Index body = 0, row = 3 * reference.seen.cols();
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    const Block& block = data.blocks[k];
    const auto count = static_cast<Eigen::Index>(block.bodies.size());
    const auto tangents = static_cast<Eigen::Index>(block.tangents.size());
    if (used_[trial][k] && predicted[k].solved && count > 0) {
      const auto move = moves.col(static_cast<Eigen::Index>(k));
      for (Eigen::Index i = 0; i < count; ++i) {
        const double sd = sd_m(trial, k, block.bodies[static_cast<std::size_t>(i)]);
        out.segment<3>(3 * (body + i)) =
            (move.segment<3>(3 * block.bodies[static_cast<std::size_t>(i)].body) + varied.seen.col(body + i) -
             reference.seen.col(body + i)) /
            (step * sd);
      }
      for (Eigen::Index i = 0; i < tangents; ++i) {
        const model::SeenTangent& seen = block.tangents[static_cast<std::size_t>(i)];
        const Eigen::Quaterniond& q = predicted[k].q_tangents[static_cast<std::size_t>(i)];
        out.segment<3>(row + 3 * i) = (move.segment<3>(3 * (bodies + seen.body)) +
                                       by_mount(changed, q, seen.body) - by_mount(at.at, q, seen.body)) /
                                      (step * sd_rad(trial, k, seen));
      }
    }
    body += count;
    row += 3 * tangents;
  }
  return out;
}

Eigen::MatrixXd JointModel::signatures(const Linearised& at, std::size_t trial,
                                       const std::vector<JointParameters>& changed,
                                       const std::vector<double>& steps) {
  Eigen::MatrixXd out(at.residual[trial].size(), static_cast<Eigen::Index>(changed.size()));
  std::vector<model::ExtendedModel::Varied> varied;
  for (std::size_t first = 0; first < changed.size(); first += varied.size()) {
    varied.clear();
    for (std::size_t j = first; j < std::min(changed.size(), first + kChangesAtOnce); ++j)
      varied.push_back(vary(trial, changed[j], at.at, at.predicted[trial]));
    const std::vector<Eigen::MatrixXd> moves = moved(at, trial, varied);
    for (std::size_t c = 0; c < varied.size(); ++c)
      out.col(static_cast<Eigen::Index>(first + c)) =
          signature(at, trial, changed[first + c], varied[c], moves[c], steps[first + c]);
  }
  return out;
}

bool JointModel::share_derivatives(const Linearised& near, std::size_t trial,
                                   std::vector<Predicted>& predicted) const {
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    predicted[k].by_rod = near.predicted[trial][k].by_rod;
    if (predicted[k].solved && predicted[k].by_rod == nullptr) return false;
  }
  return true;
}

Eigen::MatrixXd JointModel::differences(const Linearised& at, std::size_t trial,
                                        const std::vector<JointParameters>& changed,
                                        const std::vector<double>& steps) {
  const TrialData& data = trials_[trial];
  const std::vector<Predicted>& predicted = at.predicted[trial];
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(at.residual[trial].size(), static_cast<Eigen::Index>(changed.size()));
  std::vector<Predicted> there;
  for (std::size_t j = 0; j < changed.size(); ++j) {
    models_[trial].predict(arm_with(changed[j].constants), all(changed[j].effects),
                           dynamics(changed[j], trial), data, &predicted, there, true);
    mount(changed[j], trial, there);
    add_swings(trial, there);
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
    for (std::size_t k = 0; k < data.blocks.size(); ++k) {
      for (std::size_t i = 0; i < data.blocks[k].tangents.size(); ++i, row += 3) {
        if (!used_[trial][k] || !predicted[k].solved || !there[k].solved) continue;
        const auto column = static_cast<Eigen::Index>(i);
        out.col(static_cast<Eigen::Index>(j)).segment<3>(row) =
            (there[k].tangents.col(column) - predicted[k].tangents.col(column)) /
            (steps[j] * sd_rad(trial, k, data.blocks[k].tangents[i]));
      }
    }
  }
  return out;
}

model::SwingOfChange JointModel::swing_of_change(std::size_t trial,
                                                 const std::vector<Predicted>& predicted) const {
  std::vector<model::Rest> rest;
  model::Sluggishness sluggish;
  for (const Predicted& block : predicted) {
    rest.push_back(block.solved ? block.rest : model::Rest());
    if (block.solved) sluggish = block.sluggish;
  }
  return {modes_[trial], trials_[trial], rest, sluggish};
}

Linearised JointModel::linearise(const JointParameters& parameters,
                                 const std::vector<std::vector<Predicted>>* start, Derivatives how,
                                 bool known, const Linearised* near) {
  if (known) return linearise_at(parameters, *start, how, near);
  std::vector<std::vector<Predicted>> predicted;
  predict(parameters, start, predicted);
  return linearise_at(parameters, std::move(predicted), how, near);
}

Linearised JointModel::linearise_at(const JointParameters& parameters,
                                    std::vector<std::vector<Predicted>> predicted, Derivatives how,
                                    const Linearised* near, bool by_all) {
  const bool whole = how == Derivatives::kWhole;
  const double size = whole ? kWholeStep : kStep;
  Linearised lin;
  lin.at = parameters;
  lin.columns = columns(parameters);
  lin.predicted = std::move(predicted);
  std::vector<double> steps(lin.columns.size(), size);
  const std::vector<JointParameters> changed = one_step_each(lin, steps);
  const std::vector<bool> all(rod().parameters().size(), true);
  lin.complete = by_all;
  lin.residual.resize(trials_.size());
  lin.derivative.resize(trials_.size());
  lin.root_weight.resize(trials_.size());
  lin.reference.resize(trials_.size());
  lin.swing.resize(trials_.size());
  each_trial([&](std::size_t t) {
    const auto compare = [&] {
      lin.residual[t] = residual(t, lin.predicted[t]);
      lin.root_weight[t] = (lin.residual[t].array() != 0.0).cast<double>();
    };
    if (!looks_at(t)) {
      compare();
      lin.derivative[t].setZero(lin.residual[t].size(), static_cast<Eigen::Index>(lin.columns.size()));
      return;
    }
    lin.reference[t] = vary(t, parameters, parameters, lin.predicted[t]);
    if (!modes_.empty()) lin.swing[t] = swing_of_change(t, lin.predicted[t]);
    const bool shared = near != nullptr && share_derivatives(*near, t, lin.predicted[t]);
    const std::vector<Eigen::Index> alike =
        shared && !whole ? columns_alike(*near, lin.columns) : std::vector<Eigen::Index>(changed.size(), -1);
    std::vector<model::ExtendedModel::Varied> varied;
    for (std::size_t c = 0; c < changed.size() && !(whole && (shared || by_all)); ++c) {
      if (alike[c] >= 0) continue;
      // How a body is mounted changes nothing of the arm.
      const bool mount = lin.columns[c].kind == JointUnknown::Kind::kMount;
      varied.push_back(mount ? lin.reference[t] : vary(t, changed[c], parameters, lin.predicted[t]));
    }
    if (!shared)
      differentiate(parameters, t, by_all ? all : changed_by(varied, lin.reference[t]), lin.predicted[t]);
    compare();
    if (whole) {
      lin.derivative[t] =
          near != nullptr ? unweighted_derivative(*near, t) : differences(lin, t, changed, steps);
      return;
    }
    const std::vector<Eigen::MatrixXd> moves = moved(lin, t, varied);
    const Eigen::MatrixXd nearby = shared ? unweighted_derivative(*near, t) : Eigen::MatrixXd();
    lin.derivative[t].resize(lin.residual[t].size(), static_cast<Eigen::Index>(changed.size()));
    for (std::size_t c = 0, v = 0; c < changed.size(); ++c) {
      const bool own = alike[c] < 0;
      lin.derivative[t].col(static_cast<Eigen::Index>(c)) =
          own ? signature(lin, t, changed[c], varied[v], moves[v], steps[c]) : nearby.col(alike[c]);
      v += own;
    }
  });
  weigh(lin);
  return lin;
}

void JointModel::weigh(Linearised& lin) const {
  const auto count = static_cast<Eigen::Index>(lin.columns.size());
  std::vector<std::vector<TimeStretch>> stretches(trials_.size());
  each_trial([&](std::size_t t) {
    VectorXd& root = lin.root_weight[t];
    for (Eigen::Index row = 0; row < root.size(); row += 3) {
      const double before = root.segment<3>(row).maxCoeff();
      if (!(before > 0.0)) {
        // It may be of a linearisation nearby, which had an equilibrium there.
        lin.derivative[t].middleRows<3>(row).setZero();
        continue;
      }
      const double distance = lin.residual[t].segment<3>(row).norm() / before;
      const double now = std::sqrt(huber_weight(distance, threshold_));
      root.segment<3>(row).setConstant(now);
      if (now == before) continue;  // most are no outliers, and were none
      lin.residual[t].segment<3>(row) *= now / before;
      lin.derivative[t].middleRows<3>(row) *= now / before;
    }
    stretches[t] = stretches_of(lin, t);
  });
  lin.information.setZero(count, count);
  lin.gradient.setZero(count);
  lin.square = 0.0;
  lin.rows = 0;
  lin.stretches.clear();
  for (std::vector<TimeStretch>& of_trial : stretches) {
    for (TimeStretch& stretch : of_trial) {
      lin.information += stretch.information;
      lin.gradient += stretch.gradient;
      lin.square += stretch.square;
      lin.rows += stretch.rows;
      lin.stretches.push_back(std::move(stretch));
    }
  }
  const VectorXd x = lin.unknowns();
  for (Eigen::Index j = 0; j < count; ++j) {
    const JointUnknown& c = lin.columns[static_cast<std::size_t>(j)];
    const double weight = misfit_ / (c.prior_sd * c.prior_sd);
    lin.information(j, j) += weight;
    lin.gradient[j] += weight * (c.start - x[j]);
  }
}

std::vector<TimeStretch> JointModel::stretches_of(const Linearised& lin, std::size_t t) const {
  const auto count = static_cast<Eigen::Index>(lin.columns.size());
  std::vector<TimeStretch> list;
  double from_s = -1e9;
  for (const Block& block : trials_[t].blocks) {
    const double t_s = trials_[t].series.t_s[static_cast<Eigen::Index>(block.first)];
    if (t_s >= from_s + kPolicy.fit.stretch_s) {
      TimeStretch stretch;
      stretch.trial = t;
      stretch.information.setZero(count, count);
      stretch.gradient.setZero(count);
      list.push_back(std::move(stretch));
      from_s = t_s;
    }
    list.back().all_rows += 3 * static_cast<Eigen::Index>(block.bodies.size());
    list.back().tangent_rows += 3 * static_cast<Eigen::Index>(block.tangents.size());
  }
  Eigen::Index row = 0;
  for (TimeStretch& stretch : list) {
    add_to(stretch, lin, row, stretch.all_rows, 3);
    row += stretch.all_rows;
  }
  for (TimeStretch& stretch : list) {
    add_to(stretch, lin, row, stretch.tangent_rows, 2);
    row += stretch.tangent_rows;
  }
  return list;
}

/// @param rows of one stretch, one after the other: what is not used is 0 there
void JointModel::add_to(TimeStretch& stretch, const Linearised& lin, Eigen::Index first, Eigen::Index rows,
                        int degrees_of_freedom) const {
  const auto j = lin.derivative[stretch.trial].middleRows(first, rows);
  const auto r = lin.residual[stretch.trial].segment(first, rows);
  stretch.information.noalias() += j.transpose() * j;
  stretch.gradient.noalias() += j.transpose() * r;
  stretch.square += r.squaredNorm();
  for (Eigen::Index row = first; row < first + rows; row += 3)
    if (lin.root_weight[stretch.trial][row] > 0.0) stretch.rows += degrees_of_freedom;
}

}  // namespace softarm::diagnose
