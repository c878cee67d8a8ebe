#include "signal.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose/policy.h"
#include "diagnose/screen.h"
#include "math/linear_algebra.h"
#include "softarm/identify/identify.h"

namespace softarm::prove {
namespace {

using diagnose::JointUnknown;
using diagnose::Linearised;
using diagnose::TimeStretch;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSameRank = 1e-6;  // of the derivatives in one mean, as a share of the largest

/// By the middle of a mean: two recordings may have means of other lengths there.
std::pair<std::int64_t, int> key_of(const model::TrialData& trial, const model::Block& block, int body) {
  const Eigen::VectorXd& t_s = trial.series.t_s;
  const double twice_s =
      t_s[static_cast<Eigen::Index>(block.first)] + t_s[static_cast<Eigen::Index>(block.last - 1)];
  return {std::llround(0.5 * twice_s / kTick_s), body};
}

std::pair<std::int64_t, int> key_of_tangent(const model::TrialData& trial, const model::Block& block,
                                            int body) {
  return key_of(trial, block, -1 - body);
}

}  // namespace

std::vector<std::string> not_told_apart(const std::vector<Ideal>& list, const std::string& own,
                                        double leftover_snr) {
  const diagnose::Policy::Selection& rule = diagnose::kPolicy.selection;
  const auto hidden =
      std::find_if(list.begin(), list.end(), [&](const Ideal& ideal) { return ideal.effect == own; });
  std::vector<std::string> others;
  // Of one that explains nothing there is no signature to compare.
  if (hidden == list.end() || !(hidden->explains > 0.0)) return others;
  for (const Ideal& other : list) {
    const double sine2 = std::max(0.0, 1.0 - other.own_cosine * other.own_cosine);
    const double apart2 = std::pow(leftover_snr, 2) * std::max(sine2, hidden->explains - other.explains);
    if (other.effect != own && other.own_cosine > rule.rival_cosine && apart2 < std::pow(rule.rival_z, 2))
      others.push_back(other.effect);
  }
  return others;
}

Residuals residuals_of(const std::vector<model::TrialData>& trials,
                       const std::vector<std::vector<model::Predicted>>& predicted) {
  Residuals residuals(trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const model::TrialData& trial = trials[t];
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      if (!predicted[t][k].solved) continue;
      for (std::size_t i = 0; i < trial.blocks[k].bodies.size(); ++i) {
        const model::Seen& seen = trial.blocks[k].bodies[i];
        residuals[t][key_of(trial, trial.blocks[k], seen.body)] =
            seen.p_base - predicted[t][k].p.col(static_cast<Eigen::Index>(i));
      }
      for (std::size_t i = 0; i < trial.blocks[k].tangents.size(); ++i) {
        const model::SeenTangent& seen = trial.blocks[k].tangents[i];
        residuals[t][key_of_tangent(trial, trial.blocks[k], seen.body)] =
            seen.tangent_base - predicted[t][k].tangents.col(static_cast<Eigen::Index>(i));
      }
    }
  }
  return residuals;
}

VectorXd per_frame_part(const diagnose::JointModel& model, const Linearised& at, const VectorXd& rows,
                        double* freedom) {
  VectorXd left = rows;
  Eigen::Index begin = 0;
  if (freedom != nullptr) *freedom = 0.0;
  Eigen::Index constants = 0;
  for (const JointUnknown& column : at.columns) constants += column.kind == JointUnknown::Kind::kConstant;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0, below = 0;  // of bodies; of tangents, which are below those of all blocks
    for (const model::Block& block : model.trials()[t].blocks)
      below += 3 * static_cast<Eigen::Index>(block.bodies.size());
    for (const model::Block& block : model.trials()[t].blocks) {
      const auto bodies = 3 * static_cast<Eigen::Index>(block.bodies.size());
      const auto tangents = 3 * static_cast<Eigen::Index>(block.tangents.size());
      VectorXd part(bodies + tangents), weight(bodies + tangents);
      MatrixXd derivative(bodies + tangents, constants);
      part << left.segment(begin + row, bodies), left.segment(begin + below, tangents);
      weight << at.root_weight[t].segment(row, bodies), at.root_weight[t].segment(below, tangents);
      derivative << at.derivative[t].block(row, 0, bodies, constants),
          at.derivative[t].block(below, 0, tangents, constants);
      // A tangent has three numbers, two of them free.
      const Eigen::Index used =
          (weight.head(bodies).array() > 0.0).count() + 2 * (weight.tail(tangents).array() > 0.0).count() / 3;
      if (used > 0) {
        Eigen::ColPivHouseholderQR<MatrixXd> qr(derivative);
        qr.setThreshold(kSameRank);
        const MatrixXd q = MatrixXd(qr.householderQ()).leftCols(qr.rank());
        part -= q * (q.transpose() * part).eval();
        left.segment(begin + row, bodies) = part.head(bodies);
        left.segment(begin + below, tangents) = part.tail(tangents);
        if (freedom != nullptr) *freedom += static_cast<double>(std::max<Eigen::Index>(0, used - qr.rank()));
      }
      row += bodies;
      below += tangents;
    }
    begin += at.residual[t].size();
  }
  return left;
}

Reference::Reference(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
                     const std::vector<std::string>& held, const std::vector<std::string>& tied)
    : arm_(arm),
      jobs_(jobs),
      held_(held),
      tied_(tied),
      prepared_(model::prepare(arm, trials)),
      model_(arm_, prepared_.trials, jobs, held, tied) {
  at_ = model_.fit(model_.start(), {});
  model_.allow_for_motion(at_.at, at_.predicted);
  at_ = model_.fit(at_.at, {}, &at_.predicted);
  for (const model::TrialData& trial : prepared_.trials) {
    own_.emplace_back();
    for (const model::Block& block : trial.blocks) {
      for (const model::Seen& seen : block.bodies) own_.back()[key_of(trial, block, seen.body)].setZero();
      for (const model::SeenTangent& seen : block.tangents)
        own_.back()[key_of_tangent(trial, block, seen.body)].setZero();
    }
  }
}

Left Reference::residuals(const arm::Arm& arm, const std::vector<trial::Trial>& trials) const {
  const model::Prepared prepared = model::prepare(arm, trials);
  diagnose::JointModel model(arm, prepared.trials, jobs_, held_, tied_);
  const auto names = [](const diagnose::JointModel& of) {
    std::vector<std::string> list;
    for (const identify::ConstantRef& one : of.constants()) list.push_back(identify::name_of(of.arm(), one));
    return list;
  };
  if (names(model) != names(model_))
    throw std::invalid_argument("other constants are free with the other arm file");
  std::vector<std::vector<model::Predicted>> predicted;
  model.predict(at_.at, nullptr, predicted);
  Left left;
  left.held = residuals_of(prepared.trials, predicted);
  model.allow_for_motion(at_.at, predicted);
  left.refitted = residuals_of(prepared.trials, model.fit(at_.at, {}, &predicted).predicted);
  return left;
}

Linearised Reference::at_rows(const VectorXd& root_weight) const {
  Linearised at = at_;
  Eigen::Index begin = 0;
  std::size_t c = 0;
  for (std::size_t t = 0; t < at.residual.size(); ++t) {
    const auto own = root_weight.segment(begin, at.residual[t].size());
    begin += at.residual[t].size();
    at.root_weight[t].array() *= own.array();
    at.derivative[t].array().colwise() *= own.array();
    Eigen::Index row = 0;
    const auto less = [&](Eigen::Index count, TimeStretch& stretch) {
      const VectorXd gone = (1.0 - own.segment(row, count).array().square()).max(0.0).sqrt();
      const MatrixXd j = gone.asDiagonal() * at_.derivative[t].middleRows(row, count);
      stretch.information -= j.transpose() * j;
      row += count;
    };
    const std::size_t first = c;
    for (; c < at.stretches.size() && at.stretches[c].trial == t; ++c)
      less(at.stretches[c].all_rows, at.stretches[c]);
    for (std::size_t i = first; i < c; ++i) less(at.stretches[i].tangent_rows, at.stretches[i]);
  }
  at.information = at_.information;
  for (std::size_t i = 0; i < at.stretches.size(); ++i)
    at.information += at.stretches[i].information - at_.stretches[i].information;
  return at;
}

VectorXd Reference::orthogonal(const Linearised& at, const VectorXd& difference) const {
  const auto n = static_cast<Eigen::Index>(at.columns.size());
  MatrixXd information = MatrixXd::Zero(n, n);
  for (const TimeStretch& stretch : at.stretches) information += stretch.information;
  VectorXd gradient = VectorXd::Zero(n);
  Eigen::Index begin = 0;
  for (const MatrixXd& j : at.derivative) {
    gradient += j.transpose() * difference.segment(begin, j.rows());
    begin += j.rows();
  }
  information.diagonal() *= 1.0 + 1e-12;
  const VectorXd absorbed = math::solve_symmetric(information, gradient);
  VectorXd left = difference;
  begin = 0;
  for (const MatrixXd& j : at.derivative) {
    left.segment(begin, j.rows()) -= j * absorbed;
    begin += j.rows();
  }
  return left;
}

double Reference::rms_m(const VectorXd& whitened, const VectorXd& there) const {
  double sum = 0.0, bodies = 0.0;
  Eigen::Index begin = 0;
  for (std::size_t t = 0; t < prepared_.trials.size(); ++t) {
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < prepared_.trials[t].blocks.size(); ++k) {
      for (const model::Seen& seen : prepared_.trials[t].blocks[k].bodies) {
        if (at_.root_weight[t][row] > 0.0 && there[begin + row] > 0.0) {
          const double scale = model_.sd_m(t, k, seen) / at_.root_weight[t][row];
          sum += scale * scale * whitened.segment<3>(begin + row).squaredNorm();
          bodies += 1.0;
        }
        row += 3;
      }
    }
    begin += at_.residual[t].size();
  }
  return bodies > 0.0 ? std::sqrt(sum / bodies) : 0.0;
}

Reference::Compared Reference::by_rows(const Residuals& residuals) const {
  Eigen::Index rows = 0;
  for (const VectorXd& r : at_.residual) rows += r.size();
  Compared compared{VectorXd::Zero(rows), VectorXd::Zero(rows)};
  Eigen::Index row = 0;
  for (std::size_t t = 0; t < prepared_.trials.size(); ++t) {
    const model::TrialData& trial = prepared_.trials[t];
    Eigen::Index local = 0;
    const auto put = [&](const std::pair<std::int64_t, int>& key, double sd) {
      const auto here = residuals[t].find(key);
      if (here != residuals[t].end()) {
        compared.whitened.segment<3>(row) = at_.root_weight[t][local] * here->second / sd;
        compared.there.segment<3>(row).setOnes();
      }
      row += 3;
      local += 3;
    };
    for (std::size_t k = 0; k < trial.blocks.size(); ++k)
      for (const model::Seen& seen : trial.blocks[k].bodies)
        put(key_of(trial, trial.blocks[k], seen.body), model_.sd_m(t, k, seen));
    for (std::size_t k = 0; k < trial.blocks.size(); ++k)
      for (const model::SeenTangent& seen : trial.blocks[k].tangents)
        put(key_of_tangent(trial, trial.blocks[k], seen.body), model_.sd_rad(t, k, seen));
  }
  return compared;
}

Reference::Compared Reference::difference(const Residuals& with, const Residuals& without) const {
  return by_rows(differences(at_times_of(own_, with), at_times_of(own_, without)));
}

/// The diagnosis sees the recording with everything in it: by that, not by the difference alone, which may be
/// nothing at most instants, it takes a distance for usual.
VectorXd Reference::root_weights(const VectorXd& difference, const Residuals& with) const {
  const VectorXd all = by_rows(at_times_of(own_, with)).whitened;
  std::vector<double> distances;
  for (Eigen::Index row = 0; row < all.size(); row += 3)
    if (const double distance = all.segment<3>(row).norm(); distance > 0.0) distances.push_back(distance);
  const double threshold = diagnose::huber_threshold(std::move(distances));
  VectorXd roots(difference.size());
  for (Eigen::Index row = 0; row < roots.size(); row += 3) {
    const double weight = diagnose::huber_weight(difference.segment<3>(row).norm(), threshold);
    roots.segment<3>(row).setConstant(std::sqrt(weight));
  }
  return roots;
}

Signal Reference::signal(const Left& with, const Left& without) const {
  Signal signal;
  const Compared held = difference(with.held, without.held);
  const Compared refitted = difference(with.refitted, without.refitted);
  signal.there = held.there.cwiseProduct(refitted.there);
  const VectorXd counts = signal.there.cwiseProduct(root_weights(held.whitened, with.held));
  signal.counts = signal.there.cwiseProduct(root_weights(refitted.whitened, with.refitted));
  signal.difference = held.whitened.cwiseProduct(counts);
  signal.left = orthogonal(at_rows(signal.counts), refitted.whitened.cwiseProduct(signal.counts));
  signal.moved = at_whole_seconds(differences(at_times_of(own_, with.held), at_times_of(own_, without.held)));
  signal.raw_snr = signal.difference.norm();
  signal.leftover_snr = signal.left.norm();
  signal.raw_m = rms_m(signal.difference, signal.there);
  signal.leftover_m = rms_m(signal.left, signal.there);
  double freedom = 0.0;
  signal.per_frame_snr = per_frame_part(model_, at_rows(counts), signal.difference, &freedom).norm();
  signal.per_frame_sd = signal.per_frame_snr * signal.per_frame_snr / std::sqrt(2.0 * std::max(1.0, freedom));
  return signal;
}

std::vector<Ideal> Reference::ideal(const Signal& signal, const std::string& own) {
  // The fit as if its residuals were what is left.
  Linearised at = at_rows(signal.counts);
  at.gradient.setZero();
  at.square = signal.left.squaredNorm();
  Eigen::Index begin = 0;
  std::size_t c = 0;
  for (std::size_t t = 0; t < at.residual.size(); ++t) {
    at.residual[t] = signal.left.segment(begin, at.residual[t].size());
    begin += at.residual[t].size();
    Eigen::Index row = 0;
    const auto take = [&](Eigen::Index count, TimeStretch& stretch) {
      const auto r = at.residual[t].segment(row, count);
      stretch.gradient += at.derivative[t].middleRows(row, count).transpose() * r;
      stretch.square += r.squaredNorm();
      row += count;
    };
    const std::size_t first = c;
    for (; c < at.stretches.size() && at.stretches[c].trial == t; ++c) {
      at.stretches[c].gradient.setZero();
      at.stretches[c].square = 0.0;
      take(at.stretches[c].all_rows, at.stretches[c]);
    }
    for (std::size_t i = first; i < c; ++i) {
      take(at.stretches[i].tangent_rows, at.stretches[i]);
      at.gradient += at.stretches[i].gradient;
    }
  }
  const std::vector<diagnose::Screened> screened = diagnose::screen(model_, at, jobs_, [](double) {});
  const double whole = std::max(1e-12, signal.leftover_snr * signal.leftover_snr);
  const auto hidden = std::find_if(screened.begin(), screened.end(),
                                   [&](const diagnose::Screened& s) { return s.effect->info().id == own; });
  std::vector<Ideal> list;
  for (const diagnose::Screened& s : screened)
    list.push_back({s.effect->info().id, s.gain / whole,
                    std::abs(s.direction.dot(screened.front().direction)),
                    hidden != screened.end() ? std::abs(s.direction.dot(hidden->direction)) : 0.0});
  return list;
}

double Reference::cosine(const Signal& a, const Signal& b) const {
  const VectorXd both = a.there.cwiseProduct(b.there);
  const VectorXd of_a = a.left.cwiseProduct(both), of_b = b.left.cwiseProduct(both);
  const double norm = of_a.norm() * of_b.norm();
  return norm > 0.0 ? of_a.dot(of_b) / norm : 0.0;
}

double Reference::unexplained_m() const {
  Eigen::Index rows = 0, begin = 0;
  for (const VectorXd& r : at_.residual) rows += r.size();
  VectorXd all(rows);
  for (std::size_t t = 0; t < at_.residual.size(); ++t) {
    // Once more: rms_m() takes out the weight that is in a residual.
    all.segment(begin, at_.residual[t].size()) = at_.residual[t].cwiseProduct(at_.root_weight[t]);
    begin += at_.residual[t].size();
  }
  return rms_m(all, VectorXd::Ones(rows));
}

std::map<std::string, double> Reference::constants() const {
  std::map<std::string, double> values;
  for (std::size_t j = 0; j < model_.constants().size(); ++j)
    values[identify::name_of(arm_, model_.constants()[j])] = at_.at.constants[static_cast<Eigen::Index>(j)];
  return values;
}

}  // namespace softarm::prove
