#include "flexible.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Block;
using model::Seen;

MatrixXd pick(const MatrixXd& from, const std::vector<Eigen::Index>& rows,
              const std::vector<Eigen::Index>* columns) {
  const auto count = columns != nullptr ? static_cast<Eigen::Index>(columns->size()) : from.cols();
  MatrixXd out(static_cast<Eigen::Index>(rows.size()), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const Eigen::Index column = columns != nullptr ? (*columns)[static_cast<std::size_t>(j)] : j;
    for (std::size_t i = 0; i < rows.size(); ++i)
      out(static_cast<Eigen::Index>(i), j) = from(rows[i], column);
  }
  return out;
}

/// Instants that show all bodies, every n-th of them: features as multiples of their spread, residuals of the
/// bodies.
struct Instants {
  MatrixXd x, y;           ///< y: of several fits beside each other
  Eigen::Index width = 0;  ///< columns of y that are one fit's
  VectorXd weight;         ///< by precision, 1 on average over means of the usual length
  std::vector<std::size_t> trial;
  /// Columns of x by which it may go: what drives the arm now, with its past, with plays narrow or wide,
  /// plays alone, all there is.
  std::vector<std::vector<Eigen::Index>> views;
  Eigen::Index inputs = 0;  ///< columns of x that are they, the first
};

/// Plays of the inputs (where each last turned): one column per input and width, at the rows of `all`.
MatrixXd plays(const Linearised& at, const Features& all, Eigen::Index inputs) {
  VectorXd low = VectorXd::Constant(inputs, 1e300), high = -low;
  for (const auto& trial : at.predicted) {
    for (const model::Predicted& one : trial) {
      low = low.cwiseMin(one.instant.inputs);
      high = high.cwiseMax(one.instant.inputs);
    }
  }
  constexpr auto kWidths = static_cast<Eigen::Index>(std::size(kPolicy.flexible.play));
  MatrixXd out(all.values.rows(), kWidths * inputs);
  std::size_t row = 0;
  for (std::size_t t = 0; t < at.predicted.size(); ++t) {
    MatrixXd held(inputs, kWidths);
    for (std::size_t k = 0; k < at.predicted[t].size(); ++k) {
      const model::Instant& now = at.predicted[t][k].instant;
      for (Eigen::Index w = 0; w < kWidths; ++w) {
        const VectorXd half = 0.5 * kPolicy.flexible.play[w] * (high - low);
        held.col(w) = now.dt_s <= 0.0 || k == 0
                          ? now.inputs
                          : held.col(w).cwiseMax(now.inputs - half).cwiseMin(now.inputs + half).eval();
      }
      if (row >= all.trial.size() || all.trial[row] != t || all.block[row] != k) continue;
      for (Eigen::Index w = 0; w < kWidths; ++w)
        out.row(static_cast<Eigen::Index>(row)).segment(w * inputs, inputs) =
            (now.inputs - held.col(w)).transpose();
      ++row;
    }
  }
  return out;
}

/// Columns of the features, then of the plays, that views are made of.
std::vector<std::vector<Eigen::Index>> views_of(Eigen::Index inputs) {
  const auto with = [](std::vector<Eigen::Index> list, Eigen::Index first, Eigen::Index count) {
    for (Eigen::Index c = first; c < first + count; ++c) list.push_back(c);
    return list;
  };
  const Eigen::Index past = 2 * inputs, loads = 4 * inputs, time = loads + 4, played = time + 1;
  constexpr auto kWidths = static_cast<Eigen::Index>(std::size(kPolicy.flexible.play));
  constexpr auto kNarrow = static_cast<Eigen::Index>(kPolicy.flexible.narrow);
  const auto now = with(with({}, 0, inputs), loads, 4);
  return {now,
          with(now, past, 2 * inputs),
          with(now, played, kNarrow * inputs),
          with(now, played + kNarrow * inputs, (kWidths - kNarrow) * inputs),
          with({}, played, kWidths * inputs),
          with({}, 0, played + kWidths * inputs)};
}

Instants instants_of(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual) {
  const Features all = features(model, at);
  const auto inputs = static_cast<Eigen::Index>(model.arm().inputs.scalars.size());
  MatrixXd played = plays(at, all, inputs);
  MatrixXd values(all.values.rows(), all.values.cols() + played.cols());
  values << all.values, played;
  const std::size_t bodies = model.arm().bodies.size();
  std::vector<std::vector<Eigen::Index>> begin(model.trials().size());
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    for (const Block& block : model.trials()[t].blocks) {
      begin[t].push_back(row);
      row += 3 * static_cast<Eigen::Index>(block.bodies.size());
    }
  }
  std::vector<std::size_t> whole;
  for (std::size_t i = 0; i < all.trial.size(); ++i) {
    if (model.trials()[all.trial[i]].blocks[all.block[i]].bodies.size() == bodies) whole.push_back(i);
  }
  const std::size_t keep = std::min(whole.size(), kPolicy.flexible.most_blocks);
  Instants out;
  out.x.resize(static_cast<Eigen::Index>(keep), values.cols());
  out.y.resize(out.x.rows(), 3 * static_cast<Eigen::Index>(bodies));
  out.width = out.y.cols();
  out.weight.resize(out.x.rows());
  double means = 0.0;
  for (std::size_t i = 0; i < keep; ++i) {
    const std::size_t w = whole[i * whole.size() / keep];
    const auto row = static_cast<Eigen::Index>(i);
    out.x.row(row) = values.row(static_cast<Eigen::Index>(w));
    out.y.row(row) =
        residual[all.trial[w]].segment(begin[all.trial[w]][all.block[w]], out.y.cols()).transpose();
    out.trial.push_back(all.trial[w]);
    double variance = 0.0;
    for (const Seen& seen : model.trials()[all.trial[w]].blocks[all.block[w]].bodies)
      variance += std::pow(model.sd_m(all.trial[w], all.block[w], seen), 2);
    out.weight[row] = 1.0 / variance;
    means += model.trials()[all.trial[w]].blocks[all.block[w]].means;
  }
  out.weight *= means / out.weight.sum();
  out.x = in_spreads(std::move(out.x));
  out.views = views_of(inputs);
  out.inputs = inputs;
  return out;
}

/// Whether kernels and weights of these are the same.
bool is_driven_alike(const Instants& one, const Instants& other) {
  return one.x.rows() == other.x.rows() && one.x.cols() == other.x.cols() && one.x == other.x &&
         one.weight == other.weight && one.trial == other.trial;
}

MatrixXd columns_of(const MatrixXd& x, const std::vector<Eigen::Index>& columns) {
  MatrixXd out(x.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) out.col(static_cast<Eigen::Index>(j)) = x.col(columns[j]);
  return out;
}

/// What the process goes by: the kernel of some of the features, and how much of what it sees is noise.
struct Setting {
  std::size_t kernel = 0;
  double noise = 1.0;
};

/// Kernel regression of instants by others.
class Regression {
 public:
  Regression(const Instants& instants, unsigned jobs) : instants_(instants) {
    const std::size_t reaches = std::size(kPolicy.flexible.reach),
                      alone = std::size(kPolicy.flexible.reach_alone);
    const std::size_t of_views = reaches * instants.views.size();
    kernels_.resize(of_views + alone);
    math::in_parallel(instants.views.size(), jobs, [&](std::size_t v) {
      const MatrixXd distance2 = mean_distances2(columns_of(instants.x, instants.views[v]));
      for (std::size_t r = 0; r < reaches; ++r)
        kernels_[v * reaches + r] = (-0.5 * distance2.array() / std::pow(kPolicy.flexible.reach[r], 2)).exp();
    });
    // Beside the first view, each input by itself, and what they make is added up: a kink of one is near to
    // all instants at it.
    math::in_parallel(alone, jobs, [&](std::size_t r) {
      MatrixXd sum = kernels_.front();
      for (Eigen::Index c = 0; c < instants.inputs; ++c)
        sum.array() +=
            (-0.5 * mean_distances2(instants.x.col(c)).array() / std::pow(kPolicy.flexible.reach_alone[r], 2))
                .exp();
      kernels_[of_views + r] = 1.0 + sum.array() / static_cast<double>(1 + instants.inputs);  // and a mean
    });
    for (std::size_t kernel = 0; kernel < kernels_.size(); ++kernel)
      for (const double noise : kPolicy.flexible.noise) settings_.push_back({kernel, noise});
  }

  const std::vector<Setting>& settings() const { return settings_; }

  /// Weighted squares that are left of each instant once what some say of it is taken off: one column per
  /// fit.
  MatrixXd left(const Setting& setting, const std::vector<Eigen::Index>& learnt) const {
    return left_of(instants_.y, setting, learnt);
  }
  /// The same of one fit alone.
  VectorXd left(const Setting& setting, const std::vector<Eigen::Index>& learnt, Eigen::Index fit) const {
    return left_of(instants_.y.middleCols(fit * instants_.width, instants_.width), setting, learnt);
  }
  /// The same with nothing taken off.
  MatrixXd square() const { return squares_of(instants_.y); }

 private:
  MatrixXd left_of(const MatrixXd& y, const Setting& setting, const std::vector<Eigen::Index>& learnt) const {
    const MatrixXd& kernel = kernels_[setting.kernel];
    MatrixXd k = pick(kernel, learnt, &learnt);
    for (std::size_t i = 0; i < learnt.size(); ++i)
      k.diagonal()[static_cast<Eigen::Index>(i)] += setting.noise / instants_.weight[learnt[i]];
    math::CholeskyFactor factor;
    factor.compute(k);
    const MatrixXd weights = factor.solve_columns(pick(y, learnt, nullptr));
    return squares_of(y - columns_of(kernel, learnt) * weights);
  }

  MatrixXd squares_of(const MatrixXd& y) const {
    MatrixXd squares(y.rows(), y.cols() / instants_.width);
    for (Eigen::Index fit = 0; fit < squares.cols(); ++fit)
      squares.col(fit) = instants_.weight.cwiseProduct(
          y.middleCols(fit * instants_.width, instants_.width).rowwise().squaredNorm());
    return squares;
  }

  const Instants& instants_;
  std::vector<MatrixXd> kernels_;  ///< by view and reach, then of inputs alone
  std::vector<Setting> settings_;
};

using FoldRows = std::vector<std::vector<Eigen::Index>>;  ///< instants of each

/// Instants by the fold of their trial's input sequence; of one sequence alone, by trial.
FoldRows folds_of(const Instants& instants, const std::vector<std::size_t>& sequence) {
  const std::size_t sequences = 1 + *std::max_element(sequence.begin(), sequence.end());
  const std::size_t count = std::min(kPolicy.flexible.folds, sequences > 1 ? sequences : sequence.size());
  FoldRows folds(count);
  for (std::size_t i = 0; i < instants.trial.size(); ++i) {
    // Campaigns go round attitudes and speeds: a turn that is not theirs.
    const std::size_t q = sequences > 1 ? sequence[instants.trial[i]] : instants.trial[i];
    folds[(q + q / count) % count].push_back(static_cast<Eigen::Index>(i));
  }
  folds.erase(std::remove_if(folds.begin(), folds.end(), [](const auto& fold) { return fold.empty(); }),
              folds.end());
  return folds;
}

std::vector<Eigen::Index> all_but(const FoldRows& folds, std::size_t but) {
  std::vector<Eigen::Index> rows;
  for (std::size_t f = 0; f < folds.size(); ++f)
    if (f != but) rows.insert(rows.end(), folds[f].begin(), folds[f].end());
  return rows;
}

/// Sums by fold of what is left of each instant.
Eigen::RowVectorXd by_fold(const FoldRows& folds, const VectorXd& left) {
  Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(folds.size()));
  for (std::size_t f = 0; f < folds.size(); ++f)
    for (const Eigen::Index i : folds[f]) sums[static_cast<Eigen::Index>(f)] += left[i];
  return sums;
}

/// The setting that does best among the folds but one, each of these by each other alone; -1: none does any
/// good there.
/// @param one_fold by setting: squares that are left of folds (columns) by one fold (rows)
int best_without(const std::vector<MatrixXd>& one_fold, const Eigen::RowVectorXd& square, Eigen::Index but) {
  double least = 0.0;
  for (Eigen::Index learnt = 0; learnt < square.size(); ++learnt)
    for (Eigen::Index tried = 0; tried < square.size(); ++tried)
      if (learnt != but && tried != but && learnt != tried) least += square[tried];
  int best = -1;
  for (std::size_t s = 0; s < one_fold.size(); ++s) {
    double left = 0.0;
    for (Eigen::Index learnt = 0; learnt < square.size(); ++learnt)
      for (Eigen::Index tried = 0; tried < square.size(); ++tried)
        if (learnt != but && tried != but && learnt != tried) left += one_fold[s](learnt, tried);
    if (left >= least) continue;
    least = left;
    best = static_cast<int>(s);
  }
  return best;
}

/// Weighted squares that are left of all instants, each fold by the others; of each fit.
Eigen::RowVectorXd left_by_regression(const Regression& regression, const FoldRows& folds, unsigned jobs) {
  const auto n = static_cast<Eigen::Index>(folds.size());
  const std::vector<Setting>& settings = regression.settings();
  const MatrixXd square = regression.square();
  const auto fits = static_cast<std::size_t>(square.cols());
  std::vector<std::vector<MatrixXd>> one_fold(fits, std::vector<MatrixXd>(settings.size(), MatrixXd(n, n)));
  math::in_parallel(settings.size(), jobs, [&](std::size_t s) {
    for (Eigen::Index f = 0; f < n; ++f) {
      const MatrixXd by_one = regression.left(settings[s], folds[static_cast<std::size_t>(f)]);
      for (std::size_t fit = 0; fit < fits; ++fit)
        one_fold[fit][s].row(f) = by_fold(folds, by_one.col(static_cast<Eigen::Index>(fit)));
    }
  });
  MatrixXd left(n, square.cols());
  math::in_parallel(folds.size() * fits, jobs, [&](std::size_t i) {
    const auto fold = static_cast<Eigen::Index>(i / fits), fit = static_cast<Eigen::Index>(i % fits);
    const VectorXd own = square.col(fit);
    // Of two folds there is nothing within the other one to choose by.
    const int best = best_without(one_fold[i % fits], by_fold(folds, own), n > 2 ? fold : -1);
    const VectorXd by_others =
        best < 0 ? own
                 : regression.left(settings[static_cast<std::size_t>(best)], all_but(folds, i / fits), fit);
    left(fold, fit) = by_fold(folds, by_others)[fold];
  });
  return left.colwise().sum();
}

}  // namespace

MatrixXd in_spreads(MatrixXd values) {
  for (Eigen::Index c = 0; c < values.cols() && values.rows() > 0; ++c) {
    const double mean = values.col(c).mean();
    const double sd = std::sqrt((values.col(c).array() - mean).square().mean());
    values.col(c) = (values.col(c).array() - mean) / (sd > 1e-12 * (1.0 + std::abs(mean)) ? sd : 1e300);
  }
  return values;
}

MatrixXd mean_distances2(const MatrixXd& x) {
  const VectorXd square = x.rowwise().squaredNorm();
  return (square.replicate(1, x.rows()) + square.transpose().replicate(x.rows(), 1) - 2.0 * x * x.transpose())
             .cwiseMax(0.0) /
         static_cast<double>(x.cols());
}

Features features(const JointModel& model, const Linearised& at) {
  Features out;
  const auto inputs = static_cast<Eigen::Index>(model.arm().inputs.scalars.size());
  for (const arm::ScalarInput& input : model.arm().inputs.scalars) out.names.push_back(input.name);
  for (const arm::ScalarInput& input : model.arm().inputs.scalars)
    out.names.push_back("speed of " + input.name);
  for (int past = 0; past < 2; ++past) {
    for (const arm::ScalarInput& input : model.arm().inputs.scalars)
      out.names.push_back("past of " + input.name);
  }
  for (const char* name : {"payload", "attitude", "attitude", "attitude", "time in the trial"})
    out.names.push_back(name);
  std::vector<VectorXd> rows;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    VectorXd past[2];
    const auto& predicted = at.predicted[t];
    for (std::size_t k = 0; k < predicted.size(); ++k) {
      const model::Instant& now = predicted[k].instant;
      VectorXd speed = VectorXd::Zero(inputs);
      for (int p = 0; p < 2; ++p) {
        if (now.dt_s <= 0.0 || past[p].size() != inputs) past[p] = now.inputs;
        past[p] += (1.0 - std::exp(-now.dt_s / kPolicy.flexible.past_s[p])) * (now.inputs - past[p]);
      }
      if (now.dt_s > 0.0 && k > 0) speed = (now.inputs - predicted[k - 1].instant.inputs) / now.dt_s;
      if (!model.uses(t, k) || !predicted[k].solved) continue;
      VectorXd row(4 * inputs + 5);
      row << now.inputs, speed, now.inputs - past[0], now.inputs - past[1], now.payload_kg, now.gravity_base,
          now.t_s;
      rows.push_back(row);
      out.trial.push_back(t);
      out.block.push_back(k);
    }
  }
  out.values.resize(static_cast<Eigen::Index>(rows.size()), 4 * inputs + 5);
  for (std::size_t i = 0; i < rows.size(); ++i)
    out.values.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return out;
}

double ceiling(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual,
               unsigned jobs) {
  return ceilings(model, {{at, residual}}, jobs).front();
}

std::vector<double> ceilings(const JointModel& model, const std::vector<Unexplained>& list, unsigned jobs) {
  std::vector<double> shares(list.size(), 0.0);
  if (model.trials().size() < 2) return shares;
  std::vector<Instants> alike;
  std::vector<std::vector<std::size_t>> members;  // of the list, by those of `alike`
  for (std::size_t i = 0; i < list.size(); ++i) {
    Instants own = instants_of(model, list[i].at, list[i].residual);
    if (own.x.rows() < kPolicy.flexible.fewest_instants) continue;
    std::size_t a = 0;
    while (a < alike.size() && !is_driven_alike(alike[a], own)) ++a;
    if (a == alike.size()) {
      alike.push_back(std::move(own));
      members.push_back({i});
      continue;
    }
    MatrixXd y(own.y.rows(), alike[a].y.cols() + own.width);
    y << alike[a].y, own.y;
    alike[a].y = std::move(y);
    members[a].push_back(i);
  }
  for (std::size_t a = 0; a < alike.size(); ++a) {
    const Regression regression(alike[a], jobs);
    const Eigen::RowVectorXd before = regression.square().colwise().sum();
    const Eigen::RowVectorXd left =
        left_by_regression(regression, folds_of(alike[a], model.sequences()), jobs);
    for (std::size_t m = 0; m < members[a].size(); ++m) {
      const auto fit = static_cast<Eigen::Index>(m);
      if (before[fit] > 0.0) shares[members[a][m]] = std::max(0.0, 1.0 - left[fit] / before[fit]);
    }
  }
  return shares;
}

}  // namespace softarm::diagnose
