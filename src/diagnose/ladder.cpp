#include "ladder.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "policy.h"
#include "ranges.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Number of a block's condition; equal ones are of one trial, payload and level of vacuum.
class ConditionNumbers {
 public:
  explicit ConditionNumbers(const arm::Arm& arm) : arm_(arm) {}
  std::size_t operator()(std::size_t trial, const model::Instant& now) {
    double vacuum_pa = 0.0;
    for (Eigen::Index k = 0; k < now.inputs.size(); ++k) {
      if (arm_.inputs.scalars[static_cast<std::size_t>(k)].kind == arm::InputKind::kVacuum)
        vacuum_pa = std::max(vacuum_pa, now.inputs[k]);
    }
    const auto key = std::make_tuple(trial, std::lround(now.payload_kg / kPolicy.instants.payload_step_kg),
                                     std::lround(vacuum_pa / kPolicy.instants.vacuum_step_pa));
    return known_.try_emplace(key, known_.size()).first->second;
  }
  std::size_t size() const { return known_.size(); }

 private:
  const arm::Arm& arm_;
  std::map<std::tuple<std::size_t, long, long>, std::size_t> known_;
};

/// By which a block's bodies move as the logarithm of EI grows, all along the arm; m.
VectorXd by_stiffness(const JointModel& model, const model::Predicted& predicted) {
  VectorXd sum = VectorXd::Zero(predicted.by_rod->seen.rows());
  const auto& parameters = model.rod().parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].kind != rod::ParameterKind::kBendingCompliance) continue;
    const auto column = static_cast<Eigen::Index>(p);
    sum -= predicted.values[column] * predicted.by_rod->seen.col(column).cast<double>();
  }
  return sum;
}

/// Sums over the bodies of chosen blocks.
struct Error {
  double square = 0.0, weight = 0.0;  ///< as InstantFit has them
  int rows = 0;

  Rung rung(const std::string& id, const std::string& description, int unknowns) const {
    Rung rung{id, description, unknowns, 0.0, 1.0};
    if (!(weight > 0.0) || rows <= unknowns) return rung;
    rung.chi2_per_dof = square / (rows - unknowns);
    rung.rms_m = std::sqrt(rung.chi2_per_dof * rows / weight);
    return rung;
  }
};

/// By which the bodies of one block move with the EI of its condition.
struct StiffnessColumn {
  std::size_t condition = 0, block = 0;
  Eigen::Index row = 0;
  VectorXd d;  ///< weighted as the residuals are
};

/// Of all blocks that are compared, by trial.
std::vector<std::vector<StiffnessColumn>> stiffness_columns(const JointModel& model, const Linearised& at,
                                                            ConditionNumbers& conditions) {
  std::vector<std::vector<StiffnessColumn>> columns(model.trials().size());
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const std::vector<model::Seen>& bodies = model.trials()[t].blocks[k].bodies;
      const model::Predicted& predicted = at.predicted[t][k];
      if (model.uses(t, k) && predicted.solved && !bodies.empty()) {
        VectorXd d = by_stiffness(model, predicted).head(3 * static_cast<Eigen::Index>(bodies.size()));
        for (std::size_t i = 0; i < bodies.size(); ++i) {
          const auto from = 3 * static_cast<Eigen::Index>(i);
          d.segment<3>(from) *= at.root_weight[t][row + from] / model.sd_m(t, k, bodies[i]);
        }
        columns[t].push_back({conditions(t, predicted.instant), k, row, std::move(d)});
      }
      row += 3 * static_cast<Eigen::Index>(bodies.size());
    }
  }
  return columns;
}

/// The step of the fit's unknowns, then of the logarithm of EI of each condition.
VectorXd step_with_conditions(const Linearised& at, const std::vector<std::vector<StiffnessColumn>>& columns,
                              Eigen::Index conditions) {
  const auto unknowns = static_cast<Eigen::Index>(at.columns.size());
  MatrixXd information = MatrixXd::Zero(unknowns + conditions, unknowns + conditions);
  VectorXd gradient = VectorXd::Zero(unknowns + conditions);
  information.topLeftCorner(unknowns, unknowns) = at.information;
  information.bottomRightCorner(conditions, conditions)
      .diagonal()
      .setConstant(1.0 / (kPolicy.instants.stiffness_sd * kPolicy.instants.stiffness_sd));
  gradient.head(unknowns) = at.gradient;
  for (std::size_t t = 0; t < columns.size(); ++t) {
    for (const StiffnessColumn& column : columns[t]) {
      const Eigen::Index c = unknowns + static_cast<Eigen::Index>(column.condition), n = column.d.size();
      const VectorXd mixed = at.derivative[t].middleRows(column.row, n).transpose() * column.d;
      information.col(c).head(unknowns) += mixed;
      information.row(c).head(unknowns) += mixed.transpose();
      information(c, c) += column.d.squaredNorm();
      gradient[c] += column.d.dot(at.residual[t].segment(column.row, n));
    }
  }
  std::vector<Room> rooms = rooms_of(at);
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  rooms.resize(static_cast<std::size_t>(unknowns + conditions), {-kAnywhere, kAnywhere});
  VectorXd step;
  least_within(information, gradient, 0.0, rooms, step);
  return step;
}

/// Adds the bodies of one block.
/// @param residual weighted, of those bodies
void add_bodies(const JointModel& model, const Linearised& at, std::size_t t, const StiffnessColumn& column,
                const VectorXd& residual, Error& sum) {
  const std::vector<model::Seen>& bodies = model.trials()[t].blocks[column.block].bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto from = 3 * static_cast<Eigen::Index>(i);
    const double root = at.root_weight[t][column.row + from];
    if (!(root > 0.0)) continue;
    sum.square += residual.segment<3>(from).squaredNorm() / (root * root);
    sum.weight += 1.0 / std::pow(model.sd_m(t, column.block, bodies[i]), 2);
    sum.rows += 3;
  }
}

}  // namespace

std::vector<Rung> pooling_ladder(const JointModel& model, const Linearised& at,
                                 const std::vector<InstantFit>& instants) {
  if (instants.empty()) return {};
  std::vector<std::vector<bool>> chosen;
  for (const model::TrialData& trial : model.trials()) chosen.emplace_back(trial.blocks.size(), false);
  Error single;
  for (const InstantFit& fit : instants) {
    chosen[fit.trial][fit.block] = true;
    single.square += fit.square;
    single.weight += fit.weight;
    single.rows += fit.rows;
  }

  ConditionNumbers conditions(model.arm());
  const std::vector<std::vector<StiffnessColumn>> columns = stiffness_columns(model, at, conditions);
  const auto unknowns = static_cast<Eigen::Index>(at.columns.size());
  const auto count = static_cast<Eigen::Index>(conditions.size());
  const VectorXd step = step_with_conditions(at, columns, count);
  Error by_condition, one;
  for (std::size_t t = 0; t < columns.size(); ++t) {
    for (const StiffnessColumn& column : columns[t]) {
      if (!chosen[t][column.block]) continue;
      const Eigen::Index n = column.d.size();
      const VectorXd before = at.residual[t].segment(column.row, n);
      add_bodies(model, at, t, column, before, one);
      add_bodies(model, at, t, column,
                 before - at.derivative[t].middleRows(column.row, n) * step.head(unknowns) -
                     column.d * step[unknowns + static_cast<Eigen::Index>(column.condition)],
                 by_condition);
    }
  }
  const int per_instant = unknowns_of_instant(model.arm()) * static_cast<int>(instants.size());
  const int constants = static_cast<int>(unknowns), free = static_cast<int>(unknowns + count) - 1;
  return {
      single.rung("instants", "every instant by itself: EI, M0, φ, L", per_instant),
      by_condition.rung("conditions", fmt::format("one arm, EI free in each of {} conditions", count), free),
      one.rung("one_arm", "one arm", constants)};
}

std::string where_it_hides(const std::vector<Rung>& ladder, double noise_floor_m,
                           const std::vector<ParameterVariation>& variation) {
  if (ladder.size() < 3) return "";
  const Rung &single = ladder[0], &by_condition = ladder[1], &one = ladder[2];
  if (one.chi2_per_dof <= kPolicy.instants.as_noise_chi2)
    return fmt::format(
        "One set of constants explains all trials to the noise ({}; fits of single instants {}): nothing "
        "hides in the variation of parameters.",
        millimetres(one.rms_m), millimetres(single.rms_m));
  const auto beyond = [](const Rung& rung) { return std::max(0.0, rung.chi2_per_dof - 1.0); };
  const double in_shape = beyond(single) / beyond(one),
               in_conditions = 1.0 - beyond(by_condition) / beyond(one);
  std::string text = fmt::format(
      "Fits of single instants leave {}, with EI free per condition {}, with one set of constants {} (noise "
      "{}). ",
      millimetres(single.rms_m), millimetres(by_condition.rms_m), millimetres(one.rms_m),
      millimetres(noise_floor_m));
  if (in_shape > kPolicy.instants.mostly) {
    text += "The mismatch is in the arm's shape itself: even fits of single instants show it.";
  } else if (in_shape < kPolicy.instants.little) {
    text +=
        "Fits of single instants explain the mismatch, one set of constants does not: it hides in the "
        "variation of the parameters";
    text += in_conditions > kPolicy.instants.mostly ? ", in an EI that differs from condition to condition."
                                                    : ".";
  } else {
    text += fmt::format(
        "Fits of single instants explain {} of what is beyond the noise; that part hides in the variation of "
        "the parameters, the rest shows in the shape.",
        percent(1.0 - in_shape));
  }
  std::size_t named = 0;
  for (const ParameterVariation& one_variation : variation) {
    if (one_variation.p >= kPolicy.instants.p || one_variation.sentence.empty() || named == 2) continue;
    text += " " + one_variation.sentence;
    ++named;
  }
  return text;
}

}  // namespace softarm::diagnose
