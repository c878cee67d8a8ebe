// Derivatives of the joint model: by everything that is fitted, and by effects that are not in it yet.
#include <Eigen/Dense>
#include <cmath>

#include "joint_model.h"
#include "softarm/math/parallel.h"

namespace softarm::diagnose {
namespace {

using effects::Block;
using effects::Dynamics;
using effects::Predicted;
using effects::Seen;
using effects::TrialData;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kChunk_s = 2.0;
constexpr double kStep = 1e-3;       // of derivatives, in scales
constexpr double kWholeStep = 1e-2;  // of differences of whole predictions

}  // namespace

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

}  // namespace softarm::diagnose
