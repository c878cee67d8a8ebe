#include "separation.h"

#include <Eigen/Dense>
#include <utility>

#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Predicted;

DifferenceSums& DifferenceSums::operator+=(const DifferenceSums& other) {
  information += other.information;
  gradient += other.gradient;
  square += other.square;
  return *this;
}

DifferenceSums sums_between(const JointModel& model, const Linearised& truth, const Linearised& fitted) {
  const auto of_truth = static_cast<Eigen::Index>(truth.columns.size());
  const auto count = of_truth + static_cast<Eigen::Index>(fitted.columns.size());
  DifferenceSums sums{MatrixXd::Zero(count, count), VectorXd::Zero(count), 0.0};
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    VectorXd difference = VectorXd::Zero(fitted.root_weight[t].size());
    MatrixXd derivative(difference.size(), count);
    derivative << truth.derivative[t], -fitted.derivative[t];
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const std::vector<model::Seen>& bodies = model.trials()[t].blocks[k].bodies;
      const Predicted &there = truth.predicted[t][k], &here = fitted.predicted[t][k];
      for (std::size_t i = 0; i < bodies.size(); ++i, row += 3) {
        const double weight = fitted.root_weight[t][row];
        if (!(weight > 0.0) || !(truth.root_weight[t][row] > 0.0) || !there.solved || !here.solved) {
          derivative.middleRows<3>(row).setZero();
          continue;
        }
        const auto body = static_cast<Eigen::Index>(i);
        difference.segment<3>(row) =
            weight * (there.p.col(body) - here.p.col(body)) / model.sd_m(t, k, bodies[i]);
      }
    }
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const std::vector<model::SeenTangent>& tangents = model.trials()[t].blocks[k].tangents;
      const Predicted &there = truth.predicted[t][k], &here = fitted.predicted[t][k];
      for (std::size_t i = 0; i < tangents.size(); ++i, row += 3) {
        const double weight = fitted.root_weight[t][row];
        if (!(weight > 0.0) || !(truth.root_weight[t][row] > 0.0) || !there.solved || !here.solved) {
          derivative.middleRows<3>(row).setZero();
          continue;
        }
        const auto column = static_cast<Eigen::Index>(i);
        difference.segment<3>(row) = weight * (there.tangents.col(column) - here.tangents.col(column)) /
                                     model.sd_rad(t, k, tangents[i]);
      }
    }
    sums.information.noalias() += derivative.transpose() * derivative;
    sums.gradient.noalias() -= derivative.transpose() * difference;
    sums.square += difference.squaredNorm();
  }
  return sums;
}

namespace {

/// What a fit's information holds beside its trials.
MatrixXd prior_of(const Linearised& at) {
  MatrixXd prior = at.information;
  for (const TimeStretch& stretch : at.stretches) prior -= stretch.information;
  return prior;
}

}  // namespace

double least_square(const DifferenceSums& sums, const Linearised& truth, const Linearised& fitted) {
  const Eigen::Index of_truth = truth.information.rows(), of_fitted = fitted.information.rows();
  MatrixXd information = sums.information;
  information.topLeftCorner(of_truth, of_truth) += truth.information;
  information.bottomRightCorner(of_fitted, of_fitted) += prior_of(fitted);
  std::vector<Room> rooms = rooms_of(truth);
  const std::vector<Room> others = rooms_of(fitted);
  rooms.insert(rooms.end(), others.begin(), others.end());
  VectorXd move;
  return least_within(information, sums.gradient, sums.square, rooms, move);
}

double least_square_held(const DifferenceSums& sums, const Linearised& fitted, VectorXd& step) {
  const Eigen::Index of_fitted = fitted.information.rows();
  MatrixXd information = sums.information.bottomRightCorner(of_fitted, of_fitted);
  information += prior_of(fitted);
  return least_within(information, sums.gradient.tail(of_fitted), sums.square, rooms_of(fitted), step);
}

std::size_t with_equilibrium(const Linearised& at) {
  std::size_t count = 0;
  for (const std::vector<Predicted>& trial : at.predicted)
    for (const Predicted& block : trial) count += block.solved;
  return count;
}

Linearised fitted_to(JointModel& model, const Linearised& truth, JointParameters start, int steps) {
  const auto at = [&](const JointParameters& parameters,
                      const std::vector<std::vector<model::Predicted>>& from) {
    return model.linearise(parameters, &from, JointModel::Derivatives::kShapesHeld, false,
                           truth.complete ? &truth : nullptr);
  };
  Linearised best = at(start, truth.predicted);
  DifferenceSums sums = sums_between(model, truth, best);
  for (int i = 0; i < steps; ++i) {
    VectorXd step;
    least_square_held(sums, best, step);
    const auto after = [&](double share) {
      JointParameters next = best.at;
      const VectorXd x = best.unknowns();
      for (Eigen::Index j = 0; j < x.size(); ++j)
        set_unknown(next, best.columns[static_cast<std::size_t>(j)], x[j] + share * step[j]);
      return at(next, best.predicted);
    };
    Linearised there = after(1.0);
    // Where the arm has no equilibrium nothing differs.
    const std::size_t borne = with_equilibrium(best);
    for (double share = 0.5; share > kPolicy.experiment.least_step && with_equilibrium(there) < borne;
         share *= 0.5)
      there = after(share);
    DifferenceSums sums_there = sums_between(model, truth, there);
    if (!(sums_there.square < sums.square) || with_equilibrium(there) < borne) break;
    best = std::move(there);
    sums = std::move(sums_there);
  }
  return best;
}

}  // namespace softarm::diagnose
