#include "screen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "effects/catalogue.h"
#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Effect;
using model::Present;
using model::Values;

constexpr double kStep = 0.05;            // of a usual size: effects are linear in their sizes there
constexpr std::size_t kMadeAnew = 2;      // values of one grid: which of the best two is better may change
constexpr double kLeastVariance = 1e-12;  // of an orthogonal signature, as a share of the whole one

/// One set of grid values of one effect, and its sums over the stretches.
struct Variant {
  const Effect* effect = nullptr;
  Values values;                ///< sizes 0
  VectorXd usual;               ///< of the sizes
  std::vector<MatrixXd> moves;  ///< D by trial, not weighted
  bool of_before = false;       ///< those are of another model
  std::vector<MatrixXd> own;    ///< D^T D by stretch, D by usual sizes
  std::vector<MatrixXd> mixed;  ///< J^T D
  std::vector<VectorXd> score;  ///< D^T r
};

std::vector<Variant> variants(const JointModel& model, const Linearised& at) {
  std::vector<Variant> list;
  for (const std::unique_ptr<Effect>& effect : effects::catalogue()) {
    if (!effect->applies_to(model.arm())) continue;
    if (std::any_of(at.at.effects.begin(), at.at.effects.end(),
                    [&](const Present& present) { return present.effect == effect.get(); }))
      continue;
    const model::Info& info = effect->info();
    for (const Values& values : effect->grid(model.arm(), model.rod())) {
      Variant variant;
      variant.effect = effect.get();
      variant.values = values;
      variant.usual.resize(info.sizes);
      for (int k = 0; k < info.sizes; ++k)
        variant.usual[k] = info.parameters[static_cast<std::size_t>(k)].usual;
      variant.own.resize(at.stretches.size());
      variant.mixed.resize(at.stretches.size());
      variant.score.resize(at.stretches.size());
      variant.moves.resize(model.trials().size());
      list.push_back(std::move(variant));
    }
  }
  return list;
}

/// Signatures by usual sizes, whitened.
MatrixXd signature_of(JointModel& model, const Linearised& at, std::size_t trial, const Variant& variant) {
  std::vector<JointParameters> changed;
  std::vector<double> steps;
  for (Eigen::Index k = 0; k < variant.usual.size(); ++k) {
    JointParameters p = at.at;
    Values values = variant.values;
    const model::Parameter& size = variant.effect->info().parameters[static_cast<std::size_t>(k)];
    const double sign = size.high > 0.0 ? 1.0 : -1.0;
    values[k] = sign * kStep * variant.usual[k];
    p.effects.push_back({variant.effect, values});
    changed.push_back(std::move(p));
    steps.push_back(sign * kStep);
  }
  return model.signatures(at, trial, changed, steps);
}

/// Rows of a stretch in its trial's vectors: first one and number, of its bodies and of its tangents.
using StretchRows = std::array<std::pair<Eigen::Index, Eigen::Index>, 2>;

/// Of the trial's stretches, in the order of Linearised::stretches.
std::vector<StretchRows> rows_of_stretches(const Linearised& at, std::size_t trial) {
  std::vector<StretchRows> rows;
  Eigen::Index begin = 0, tangents = 0;
  for (const TimeStretch& stretch : at.stretches) {
    if (stretch.trial == trial) tangents += stretch.all_rows;
  }
  for (const TimeStretch& stretch : at.stretches) {
    if (stretch.trial != trial) continue;
    rows.push_back({{{begin, stretch.all_rows}, {tangents, stretch.tangent_rows}}});
    begin += stretch.all_rows;
    tangents += stretch.tangent_rows;
  }
  return rows;
}

struct Sums {
  MatrixXd own, mixed;
  VectorXd score;

  Sums& operator+=(const Sums& other) {
    own += other.own;
    mixed += other.mixed;
    score += other.score;
    return *this;
  }
  Sums without(const Sums& part) const { return {own - part.own, mixed - part.mixed, score - part.score}; }
};

/// A variant's over all stretches of each trial.
std::vector<Sums> sums_of_trials(const Variant& variant, const Linearised& at) {
  const auto k = variant.usual.size();
  std::vector<Sums> list(
      variant.moves.size(),
      Sums{MatrixXd::Zero(k, k), MatrixXd::Zero(at.information.rows(), k), VectorXd::Zero(k)});
  for (std::size_t c = 0; c < at.stretches.size(); ++c) {
    Sums& trial = list[at.stretches[c].trial];
    trial.own += variant.own[c];
    trial.mixed += variant.mixed[c];
    trial.score += variant.score[c];
  }
  return list;
}

Sums sum_of(const std::vector<Sums>& trials) {
  Sums sum = trials.front();
  for (std::size_t t = 1; t < trials.size(); ++t) sum += trials[t];
  return sum;
}

VectorXd into_range(const Variant& variant, VectorXd sizes) {
  for (Eigen::Index k = 0; k < sizes.size(); ++k) {
    const model::Parameter& p = variant.effect->info().parameters[static_cast<std::size_t>(k)];
    sizes[k] = std::clamp(sizes[k] * variant.usual[k], p.low, p.high) / variant.usual[k];
  }
  return sizes;
}

/// The fit without one trial.
struct Others {
  math::SymmetricSolver information;
  VectorXd gradient;
  VectorXd step;  ///< of the unknowns
};

/// What all variants are judged by, factored once.
struct Fits {
  math::SymmetricSolver information;
  std::vector<Others> without_each;  ///< of the trials
};

Fits fits_of(const JointModel& model, const Linearised& at) {
  const MatrixXd all = information_within_ranges(at);
  std::vector<MatrixXd> information(model.trials().size(), all);
  std::vector<VectorXd> gradient(information.size(), at.gradient);
  for (const TimeStretch& stretch : at.stretches) {
    information[stretch.trial] -= stretch.information;
    gradient[stretch.trial] -= stretch.gradient;
  }
  Fits fits{math::SymmetricSolver(all), {}};
  for (std::size_t t = 0; t < information.size(); ++t) {
    math::SymmetricSolver solver(information[t]);
    VectorXd step = solver.solve(gradient[t]);
    fits.without_each.push_back({std::move(solver), std::move(gradient[t]), std::move(step)});
  }
  return fits;
}

/// By which chi^2 of one trial falls with the variant's sizes, both as the others have them.
/// @param rest the variant's sums over the others
double unseen_gain(const Linearised& at, const Variant& variant, const Others& others, const Sums& rest,
                   std::size_t trial, double misfit) {
  const VectorXd& alone = others.step;
  const MatrixXd m = others.information.solve_columns(rest.mixed);
  MatrixXd h = rest.own - rest.mixed.transpose() * m;
  for (Eigen::Index i = 0; i < h.rows(); ++i)
    h(i, i) += misfit / (kPolicy.fit.size_sd * kPolicy.fit.size_sd) + kLeastVariance * rest.own(i, i);
  const VectorXd a =
      into_range(variant, math::solve_symmetric(h, rest.score - m.transpose() * others.gradient));
  const VectorXd with = alone - m * a;
  double gain = 0.0;
  for (std::size_t c = 0; c < at.stretches.size(); ++c) {
    const TimeStretch& stretch = at.stretches[c];
    if (stretch.trial != trial) continue;
    const auto fall = [&](const VectorXd& x) {
      return 2.0 * x.dot(stretch.gradient) - x.dot(stretch.information * x);
    };
    gain += fall(with) - fall(alone) + 2.0 * a.dot(variant.score[c]) - a.dot(variant.own[c] * a) -
            2.0 * with.dot(variant.mixed[c] * a);
  }
  return gain;
}

Screened judge(const Linearised& at, const Variant& variant, const Fits& fits) {
  const double misfit = std::max(1.0, at.square / std::max(1, at.rows));
  Screened out;
  out.effect = variant.effect;
  const auto k = variant.usual.size();
  const std::vector<Sums> trials = sums_of_trials(variant, at);
  const Sums all = sum_of(trials);
  const MatrixXd m = fits.information.solve_columns(all.mixed);
  const MatrixXd orthogonal = all.own - all.mixed.transpose() * m;
  const VectorXd score = all.score - m.transpose() * at.gradient;
  MatrixXd information = orthogonal;
  for (Eigen::Index i = 0; i < k; ++i)
    information(i, i) +=
        misfit / (kPolicy.fit.size_sd * kPolicy.fit.size_sd) + kLeastVariance * all.own(i, i);
  const math::SymmetricSolver own_solver(information);
  const VectorXd sizes = own_solver.solve(score);
  const VectorXd possible = into_range(variant, sizes);
  out.sizes = sizes.cwiseProduct(variant.usual);
  out.values = variant.values;
  out.values.head(k) = possible.cwiseProduct(variant.usual);
  out.gain = std::max(0.0, 2.0 * possible.dot(score) - possible.dot(orthogonal * possible));

  // The spread of the stretches' own scores at the estimate.
  MatrixXd spread = MatrixXd::Zero(k, k);
  for (std::size_t c = 0; c < at.stretches.size(); ++c) {
    const TimeStretch& stretch = at.stretches[c];
    const MatrixXd part = variant.own[c] - variant.mixed[c].transpose() * m -
                          m.transpose() * variant.mixed[c] + m.transpose() * stretch.information * m;
    const VectorXd g = variant.score[c] - m.transpose() * stretch.gradient - part * possible;
    spread += g * g.transpose();
  }
  const MatrixXd inverse = own_solver.inverse();
  const MatrixXd covariance = inverse + inverse * spread * inverse;
  const math::SymmetricSolver precision(covariance);
  out.sd = covariance.diagonal().cwiseSqrt().cwiseProduct(variant.usual);
  out.z = std::sqrt(std::max(0.0, possible.dot(precision.solve(possible))));
  const VectorXd one = VectorXd::Ones(k) / std::sqrt(static_cast<double>(k));
  out.usual_z = std::sqrt(std::max(0.0, one.dot(precision.solve(one))));
  const VectorXd which = possible.isZero() ? one : possible;
  const double whole = which.dot(all.own * which);
  out.collinearity = whole > 0.0 ? std::clamp(1.0 - which.dot(orthogonal * which) / whole, 0.0, 1.0) : 1.0;

  for (std::size_t t = 0; t < trials.size(); ++t)
    out.unseen_gain += unseen_gain(at, variant, fits.without_each[t], all.without(trials[t]), t, misfit);
  return out;
}

/// The signatures that variants do not have yet, and the sums of all these variants over all stretches.
void fill_sums(JointModel& model, const Linearised& at, const std::vector<Variant*>& list,
               const std::function<void(double)>& progress) {
  std::vector<std::vector<std::size_t>> stretches_of(model.trials().size());
  for (std::size_t c = 0; c < at.stretches.size(); ++c) stretches_of[at.stretches[c].trial].push_back(c);
  std::atomic<std::size_t> done{0};
  model.each_trial([&](std::size_t t) {
    const auto rows = rows_of_stretches(at, t);
    for (Variant* one : list) {
      Variant& variant = *one;
      if (variant.moves[t].size() == 0) variant.moves[t] = signature_of(model, at, t, variant);
      const MatrixXd d = at.root_weight[t].asDiagonal() * variant.moves[t];
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::size_t c = stretches_of[t][i];
        variant.own[c] = MatrixXd::Zero(d.cols(), d.cols());
        variant.mixed[c] = MatrixXd::Zero(at.derivative[t].cols(), d.cols());
        variant.score[c] = VectorXd::Zero(d.cols());
        for (const auto& [first, count] : rows[i]) {
          const auto part = d.middleRows(first, count);
          variant.own[c].noalias() += part.transpose() * part;
          variant.mixed[c].noalias() += at.derivative[t].middleRows(first, count).transpose() * part;
          variant.score[c].noalias() += part.transpose() * at.residual[t].segment(first, count);
        }
      }
    }
    progress(static_cast<double>(++done) / static_cast<double>(model.trials().size()));
  });
}

/// An effect with that of its variants that explains most.
struct Best {
  Screened screened;
  const Variant* variant = nullptr;
  VectorXd sizes;     ///< that its signature is taken at, in usual sizes
  VectorXd absorbed;  ///< by the unknowns of the fit
};

std::vector<Best> best_of_each(const std::vector<Variant>& list, const std::vector<Screened>& judged) {
  std::vector<Best> best;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto same = std::find_if(best.begin(), best.end(),
                                   [&](const Best& b) { return b.variant->effect == list[i].effect; });
    if (same == best.end()) {
      best.push_back({judged[i], &list[i], {}, {}});
      continue;
    }
    // A detectable size anywhere on the grid is one of the effect.
    const double usual_z = std::max(same->screened.usual_z, judged[i].usual_z);
    const bool better = same->variant->of_before != list[i].of_before ? same->variant->of_before
                                                                      : judged[i].gain > same->screened.gain;
    if (better) *same = {judged[i], &list[i], {}, {}};
    same->screened.usual_z = usual_z;
  }
  return best;
}

/// Gives variants the signatures that are known of another model.
void begin_with(std::vector<KnownSignatures::Of>& known, std::vector<Variant>& list) {
  for (Variant& variant : list) {
    const auto same = std::find_if(known.begin(), known.end(), [&](const KnownSignatures::Of& of) {
      return of.effect == variant.effect && of.values == variant.values;
    });
    if (same == known.end()) continue;
    variant.moves = std::move(same->moves);
    variant.of_before = true;
    known.erase(same);
  }
}

/// Whether the model holds places that it did not hold when these were made: all effects then do something
/// else.
bool holds_more_places(const JointParameters& at, const std::vector<KnownSignatures::Of>& known) {
  return std::any_of(at.effects.begin(), at.effects.end(), [&](const model::Present& present) {
    return present.effect->holds_places() &&
           std::any_of(known.begin(), known.end(),
                       [&](const KnownSignatures::Of& of) { return of.effect == present.effect; });
  });
}

/// Of each effect the variants that explain most by signatures of another model, without those.
std::vector<std::size_t> made_anew(std::vector<Variant>& list, const std::vector<Screened>& judged) {
  std::vector<std::size_t> order(list.size()), chosen;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return judged[a].gain > judged[b].gain; });
  for (const std::size_t i : order) {
    const auto same = std::count_if(chosen.begin(), chosen.end(),
                                    [&](std::size_t c) { return list[c].effect == list[i].effect; });
    if (list[i].of_before && static_cast<std::size_t>(same) < kMadeAnew) chosen.push_back(i);
  }
  for (const std::size_t i : chosen) {
    for (MatrixXd& moves : list[i].moves) moves.resize(0, 0);
    list[i].of_before = false;
  }
  return chosen;
}

/// Sums of squares over the bodies, m^2: of a signature, and of what of it the constants leave.
struct Squares {
  double whole = 0.0, left = 0.0, bodies = 0.0;
};

/// @param d, left one trial's signature, and what of it the constants leave; weighted as the residuals are
Squares squares_of(const JointModel& model, const Linearised& at, std::size_t trial, const VectorXd& d,
                   const VectorXd& left) {
  Squares sum;
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < model.trials()[trial].blocks.size(); ++k) {
    for (const model::Seen& seen : model.trials()[trial].blocks[k].bodies) {
      if (at.root_weight[trial][row] > 0.0) {
        const double scale = model.sd_m(trial, k, seen) / at.root_weight[trial][row];
        sum.whole += scale * scale * d.segment<3>(row).squaredNorm();
        sum.left += scale * scale * left.segment<3>(row).squaredNorm();
        sum.bodies += 1.0;
      }
      row += 3;
    }
  }
  return sum;
}

/// Sizes in metres, and what of the signatures the constants leave.
void set_sizes(JointModel& model, const Linearised& at, std::vector<Best>& best) {
  const math::SymmetricSolver solver(information_within_ranges(at));
  Eigen::Index rows = 0;
  std::vector<Eigen::Index> begins;
  for (const MatrixXd& j : at.derivative) {
    begins.push_back(rows);
    rows += j.rows();
  }
  for (Best& b : best) {
    b.sizes = b.screened.values.head(b.variant->usual.size()).cwiseQuotient(b.variant->usual);
    const bool none = b.sizes.isZero();
    if (none) b.sizes.setOnes();
    b.absorbed = solver.solve(sum_of(sums_of_trials(*b.variant, at)).mixed * b.sizes);
    b.screened.absorbed = none ? VectorXd::Zero(b.absorbed.size()) : b.absorbed;
    b.screened.direction.resize(rows);
  }
  // A trial's model serves one thread.
  std::vector<std::vector<Squares>> squares(model.trials().size(), std::vector<Squares>(best.size()));
  model.each_trial([&](std::size_t t) {
    for (std::size_t b = 0; b < best.size(); ++b) {
      const VectorXd d = at.root_weight[t].asDiagonal() * (best[b].variant->moves[t] * best[b].sizes);
      const VectorXd left = d - at.derivative[t] * best[b].absorbed;
      best[b].screened.direction.segment(begins[t], d.size()) = left;
      squares[t][b] = squares_of(model, at, t, d, left);
    }
  });
  for (std::size_t b = 0; b < best.size(); ++b) {
    Screened& s = best[b].screened;
    Squares sum;
    for (const std::vector<Squares>& trial : squares) {
      sum.whole += trial[b].whole;
      sum.left += trial[b].left;
      sum.bodies += trial[b].bodies;
    }
    if (!s.values.head(best[b].variant->usual.size()).isZero() && sum.bodies > 0.0) {
      s.size_m = std::sqrt(sum.whole / sum.bodies);
      s.leftover_m = std::sqrt(sum.left / sum.bodies);
    }
    const double norm = s.direction.norm();
    if (norm > 0.0) s.direction /= norm;
  }
}

}  // namespace

double inflation(const Linearised& at) {
  // Along each eigenvector of the information, stretches' gradients against what independence would give.
  const math::Eigensystem eigen = math::eigensystem_of(at.information);
  const double misfit = at.square / std::max(1, at.rows);
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index j = 0; j < at.information.rows(); ++j) {
    const VectorXd v = eigen.vectors.col(j);
    double spread = 0.0, expected = 0.0;
    for (const TimeStretch& stretch : at.stretches) {
      spread += std::pow(v.dot(stretch.gradient), 2);
      expected += v.dot(stretch.information * v);
    }
    if (!(expected > 1.0)) continue;
    sum += spread / expected;
    ++count;
  }
  return std::max({1.0, misfit, count > 0 ? sum / count : 1.0});
}

std::vector<Screened> screen(JointModel& model, Linearised& at, unsigned jobs,
                             const std::function<void(double)>& progress, KnownSignatures* known) {
  model.complete(at);
  std::vector<Variant> list = variants(model, at);
  if (known != nullptr && !holds_more_places(at.at, known->list)) begin_with(known->list, list);
  const Fits fits = fits_of(model, at);
  std::vector<Screened> judged(list.size());
  std::vector<std::size_t> which(list.size());
  std::iota(which.begin(), which.end(), std::size_t{0});
  while (!which.empty()) {
    std::vector<Variant*> these;
    for (const std::size_t i : which) these.push_back(&list[i]);
    fill_sums(model, at, these, progress);
    math::in_parallel(which.size(), jobs,
                      [&](std::size_t i) { judged[which[i]] = judge(at, *these[i], fits); });
    const bool first = which.size() == list.size();
    which = first ? made_anew(list, judged) : std::vector<std::size_t>();
  }
  std::vector<Best> best = best_of_each(list, judged);
  set_sizes(model, at, best);
  std::vector<Screened> screened;
  for (Best& b : best) screened.push_back(std::move(b.screened));
  std::stable_sort(screened.begin(), screened.end(),
                   [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
  if (known != nullptr) {
    known->list.clear();
    for (Variant& variant : list)
      known->list.push_back({variant.effect, std::move(variant.values), std::move(variant.moves)});
  }
  return screened;
}

}  // namespace softarm::diagnose
