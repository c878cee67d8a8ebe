#include "posterior.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Effect;
using Effects = std::vector<const Effect*>;

constexpr int kKernels = 3, kTime = 2;  // two of what drives the arm; of time
// Shares of a direction's variance that a kernel may have: a grid as fine as evidence needs, geometric in
// what is left white.
constexpr double kShares[] = {0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.997, 0.999};
constexpr double kLeastEigenvalue = 1e-9;
constexpr int kNoiseIterations = 2;

/// Everything in the eigenvectors of one kernel: there its Gaussian process is independent.
struct Turned {
  VectorXd eigenvalues;
  std::vector<MatrixXd> signatures;  ///< by direction, n x p
  MatrixXd residual;                 ///< n x m
};

/// Sums over all instants and directions under one noise.
struct Normal {
  MatrixXd information;  ///< p x p
  VectorXd score;
  double square = 0.0, log_determinant = 0.0;
};

/// What fits to the same instants have in common.
struct Frame {
  MatrixXd axes;  ///< principal directions of the residuals, one per column
  std::vector<math::Eigensystem> kernels;
};

class Space {
 public:
  Space(const EvidenceData& data, const Frame& frame);

  Evidence evaluate(const Effects& present, double tau, std::vector<Evidence::Noise> noise) const;
  std::vector<Evidence::Noise> noise_of(const VectorXd& coefficients) const;
  Normal normal(const std::vector<Evidence::Noise>& noise) const;
  /// Log evidence under these sums.
  double integrate(const Normal& sums, const Effects& present, double tau, VectorXd& coefficients) const;
  Index coefficients() const { return mean_.size(); }
  const Effects& effects() const { return each_; }

 private:
  std::vector<Turned> turned_;
  VectorXd mean_, sd_;  ///< of the coefficients; of effects those of the slab
  Effects effect_;      ///< by coefficient, null for unknowns
  Effects each_;        ///< once each
};

Frame frame_of(const EvidenceData& data) {
  Frame frame;
  frame.axes = math::eigensystem_of(data.residual.transpose() * data.residual).vectors;
  for (int kernel = 0; kernel < kKernels; ++kernel) {
    frame.kernels.push_back(math::eigensystem_of(kernel_matrix(data, kernel)));
    frame.kernels.back().values = frame.kernels.back().values.cwiseMax(kLeastEigenvalue);
  }
  return frame;
}

Space::Space(const EvidenceData& data, const Frame& frame) {
  const auto p = static_cast<Index>(data.unknowns.size() + data.effects.size());
  const Index n = data.residual.rows(), m = data.residual.cols();
  mean_.resize(p);
  sd_.resize(p);
  std::vector<MatrixXd> by_direction(static_cast<std::size_t>(m), MatrixXd(n, p));
  Index column = 0;
  for (const std::vector<Signature>* list : {&data.unknowns, &data.effects}) {
    for (const Signature& signature : *list) {
      mean_[column] = signature.mean;
      sd_[column] = signature.prior_sd;
      effect_.push_back(signature.effect);
      if (signature.effect != nullptr && (each_.empty() || each_.back() != signature.effect))
        each_.push_back(signature.effect);
      const MatrixXd turned = signature.moves * frame.axes;
      for (Index d = 0; d < m; ++d) by_direction[static_cast<std::size_t>(d)].col(column) = turned.col(d);
      ++column;
    }
  }
  const MatrixXd residual = data.residual * frame.axes;
  for (const math::Eigensystem& eigen : frame.kernels) {
    Turned turned;
    turned.eigenvalues = eigen.values;
    for (const MatrixXd& signatures : by_direction)
      turned.signatures.push_back(eigen.vectors.transpose() * signatures);
    turned.residual = eigen.vectors.transpose() * residual;
    turned_.push_back(std::move(turned));
  }
}

std::vector<Evidence::Noise> Space::noise_of(const VectorXd& coefficients) const {
  const Index n = turned_[0].residual.rows(), m = turned_[0].residual.cols();
  std::vector<Evidence::Noise> list(static_cast<std::size_t>(m));
  std::vector<double> best(static_cast<std::size_t>(m), -1e300);
  const auto count = static_cast<double>(n);
  for (int kernel = 0; kernel < kKernels; ++kernel) {
    const Turned& turned = turned_[static_cast<std::size_t>(kernel)];
    for (std::size_t d = 0; d < list.size(); ++d) {
      const VectorXd square =
          (turned.residual.col(static_cast<Index>(d)) - turned.signatures[d] * coefficients).cwiseAbs2();
      for (const double share : kShares) {
        const VectorXd spectrum = (1.0 - share) + share * turned.eigenvalues.array();
        const double mean = square.cwiseQuotient(spectrum).sum() / count;
        const double variance = std::max(mean, kPolicy.posterior.least_white / (1.0 - share));
        const double log =
            -0.5 * (count * std::log(variance) + spectrum.array().log().sum() + count * mean / variance);
        if (log <= best[d]) continue;
        best[d] = log;
        list[d] = {kernel, share, variance};
      }
    }
  }
  return list;
}

Normal Space::normal(const std::vector<Evidence::Noise>& noise) const {
  const Index p = coefficients();
  Normal sums{MatrixXd::Zero(p, p), VectorXd::Zero(p), 0.0, 0.0};
  for (std::size_t d = 0; d < noise.size(); ++d) {
    const Turned& turned = turned_[static_cast<std::size_t>(noise[d].kernel)];
    const VectorXd variance =
        noise[d].variance * ((1.0 - noise[d].share) + noise[d].share * turned.eigenvalues.array());
    const VectorXd root = variance.cwiseSqrt().cwiseInverse();
    const MatrixXd x = root.asDiagonal() * turned.signatures[d];
    const VectorXd y = root.cwiseProduct(turned.residual.col(static_cast<Index>(d)));
    sums.information.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
    sums.score.noalias() += x.transpose() * y;
    sums.square += y.squaredNorm();
    sums.log_determinant += variance.array().log().sum();
  }
  sums.information.triangularView<Eigen::StrictlyUpper>() = sums.information.transpose();
  return sums;
}

double Space::integrate(const Normal& sums, const Effects& present, double tau,
                        VectorXd& coefficients) const {
  VectorXd precision = sd_;
  for (Index j = 0; j < precision.size(); ++j) {
    const Effect* effect = effect_[static_cast<std::size_t>(j)];
    const bool spike =
        effect != nullptr && std::find(present.begin(), present.end(), effect) == present.end();
    precision[j] = 1.0 / std::pow(spike ? tau : sd_[j], 2);
  }
  MatrixXd information = sums.information;
  information.diagonal() += precision;
  const VectorXd score = sums.score + precision.cwiseProduct(mean_);
  const Eigen::LLT<MatrixXd> factor(information);
  coefficients = factor.solve(score);
  const double least = sums.square + precision.dot(mean_.cwiseAbs2()) - score.dot(coefficients);
  const double log_posterior = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return -0.5 * (sums.log_determinant + least + log_posterior - precision.array().log().sum());
}

Evidence Space::evaluate(const Effects& present, double tau, std::vector<Evidence::Noise> noise) const {
  Evidence evidence;
  if (noise.empty()) noise = noise_of(VectorXd::Zero(coefficients()));
  for (int i = 0; i < kNoiseIterations; ++i) {
    integrate(normal(noise), present, tau, evidence.coefficients);
    noise = noise_of(evidence.coefficients);
  }
  evidence.noise = std::move(noise);
  evidence.log = integrate(normal(evidence.noise), present, tau, evidence.coefficients);
  return evidence;
}

/// Sets that were evaluated, each under the backgrounds that suit it.
class Search {
 public:
  using Corrections = std::map<const Effect*, double>;
  /// @param corrections of the log evidence, by effect
  Search(const Space& space, Corrections corrections, unsigned jobs)
      : space_(space),
        corrections_(std::move(corrections)),
        jobs_(jobs),
        log_odds_(std::log(kPolicy.posterior.expected / static_cast<double>(space.effects().size()))) {}

  struct Model {
    Effects effects;
    double tau = 0.0, log = 0.0;  ///< log: with the odds of its effects
    Evidence evidence;
  };

  /// Evaluates these sets in parallel, from a noise near theirs.
  void evaluate(std::vector<Model> list, const std::vector<Evidence::Noise>& noise) {
    math::in_parallel(list.size(), jobs_, [&](std::size_t i) {
      list[i].evidence = space_.evaluate(list[i].effects, list[i].tau, noise);
      list[i].log = list[i].evidence.log + before_data(list[i].effects);
    });
    for (Model& model : list) models_.push_back(std::move(model));
  }

  /// What one effect more would bring to a model, under its own noise.
  std::vector<Model> one_more(const Model& from) const {
    const Normal sums = space_.normal(from.evidence.noise);
    std::vector<Model> list;
    VectorXd unused;
    for (const Effect* effect : space_.effects()) {
      if (std::find(from.effects.begin(), from.effects.end(), effect) != from.effects.end()) continue;
      Effects effects = from.effects;
      effects.push_back(effect);
      std::sort(effects.begin(), effects.end(),
                [this](const Effect* a, const Effect* b) { return place(a) < place(b); });
      for (const double tau : kPolicy.posterior.background)
        list.push_back(
            {effects, tau, space_.integrate(sums, effects, tau, unused) + before_data(effects), {}});
    }
    return list;
  }

  const std::vector<Model>& models() const { return models_; }
  bool has(const Model& m) const {
    return std::any_of(models_.begin(), models_.end(),
                       [&](const Model& o) { return o.effects == m.effects && o.tau == m.tau; });
  }
  /// The best models of so many effects, each set once.
  std::vector<Model> best(std::size_t effects, std::size_t count) const {
    std::vector<Model> list;
    for (const Model& m : models_)
      if (m.effects.size() == effects) list.push_back(m);
    return each_once(std::move(list), count);
  }
  static std::vector<Model> each_once(std::vector<Model> list, std::size_t count) {
    std::stable_sort(list.begin(), list.end(), [](const Model& a, const Model& b) { return a.log > b.log; });
    std::vector<Model> out;
    for (Model& m : list) {
      const auto same = [&](const Model& o) { return o.effects == m.effects; };
      if (out.size() < count && std::none_of(out.begin(), out.end(), same)) out.push_back(std::move(m));
    }
    return out;
  }

 private:
  /// What the integral does not know: the odds of the effects, and what refits showed of them.
  double before_data(const Effects& effects) const {
    double sum = log_odds_ * static_cast<double>(effects.size());
    for (const Effect* effect : effects) {
      const auto found = corrections_.find(effect);
      if (found != corrections_.end()) sum += found->second;
    }
    return sum;
  }
  std::ptrdiff_t place(const Effect* effect) const {
    return std::find(space_.effects().begin(), space_.effects().end(), effect) - space_.effects().begin();
  }

  const Space& space_;
  const Corrections corrections_;
  const unsigned jobs_;
  const double log_odds_;
  std::vector<Model> models_;
};

Posterior summed(const std::vector<Search::Model>& models) {
  double best = -1e300;
  for (const Search::Model& m : models) best = std::max(best, m.log);
  Posterior result;
  double sum = 0.0;
  for (const Search::Model& m : models) {
    const double weight = std::exp(m.log - best);
    sum += weight;
    const auto same = std::find_if(result.sets.begin(), result.sets.end(),
                                   [&](const EffectSet& s) { return s.effects == m.effects; });
    if (same == result.sets.end())
      result.sets.push_back({m.effects, weight});
    else
      same->probability += weight;
  }
  for (EffectSet& set : result.sets) set.probability /= sum;
  std::stable_sort(result.sets.begin(), result.sets.end(),
                   [](const EffectSet& a, const EffectSet& b) { return a.probability > b.probability; });
  return result;
}

bool holds(const EffectSet& set, const Effect* effect) {
  return std::find(set.effects.begin(), set.effects.end(), effect) != set.effects.end();
}

}  // namespace

double Posterior::of(const Effect* effect) const {
  double sum = 0.0;
  for (const EffectSet& set : sets)
    if (holds(set, effect)) sum += set.probability;
  return sum;
}

double Posterior::instead(const Effect* other, const Effect* effect) const {
  double sum = 0.0;
  for (const EffectSet& set : sets)
    if (holds(set, other) && !holds(set, effect)) sum += set.probability;
  return sum;
}

MatrixXd kernel_matrix(const EvidenceData& data, int kernel) {
  const Index n = data.residual.rows();
  MatrixXd k(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j <= i; ++j) {
      double value = 0.0;
      if (kernel != kTime) {
        const double reach = kPolicy.flexible.reach[kernel];
        value = std::exp(-0.5 * (data.features.row(i) - data.features.row(j)).squaredNorm() /
                         (static_cast<double>(data.features.cols()) * reach * reach));
      } else if (data.trial[static_cast<std::size_t>(i)] == data.trial[static_cast<std::size_t>(j)]) {
        value = std::exp(-std::abs(data.t_s[i] - data.t_s[j]) / kPolicy.fit.stretch_s);
      }
      k(i, j) = k(j, i) = value;
    }
  }
  if (kernel == kTime) return k;
  // What is the same in all trials is where a body is, an effect: no error of laws that goes with what drives
  // the arm.
  const VectorXd mean = k.rowwise().mean();
  return k - mean.replicate(1, n) - mean.transpose().replicate(n, 1) + MatrixXd::Constant(n, n, mean.mean());
}

Evidence evidence_of(const EvidenceData& data, const Effects& present, double tau) {
  return Space(data, frame_of(data)).evaluate(present, tau, {});
}

namespace {

/// Log evidence of a model under the background that suits it best.
double best_evidence(const Space& space, const Effects& present) {
  double best = -1e300;
  for (const double tau : kPolicy.posterior.background)
    best = std::max(best, space.evaluate(present, tau, {}).log);
  return best;
}

/// By which the evidence of each refitted effect alone, about its own fit, is more than the linear one.
Search::Corrections corrections_of(const EvidenceData& data, const Space& space, const Frame& frame,
                                   const std::vector<RefitEvidence>& refits, unsigned jobs) {
  std::vector<double> more(refits.size(), 0.0);
  math::in_parallel(refits.size(), jobs, [&](std::size_t i) {
    EvidenceData own = refits[i].data;
    for (const Signature& s : data.effects)
      if (s.effect != refits[i].effect) own.effects.push_back(s);
    more[i] = best_evidence(Space(own, frame), {}) - best_evidence(space, {refits[i].effect});
  });
  Search::Corrections corrections;
  for (std::size_t i = 0; i < refits.size(); ++i) corrections[refits[i].effect] = more[i];
  return corrections;
}

}  // namespace

Posterior posterior(const EvidenceData& data, const std::vector<RefitEvidence>& refits, unsigned jobs) {
  if (data.residual.rows() < kPolicy.posterior.fewest_instants || data.effects.empty()) return {};
  const Frame frame = frame_of(data);
  const Space space(data, frame);
  Search search(space, corrections_of(data, space, frame, refits, jobs), jobs);
  std::vector<Search::Model> none;
  for (const double tau : kPolicy.posterior.background) none.push_back({{}, tau, 0.0, {}});
  search.evaluate(std::move(none), {});
  for (std::size_t size = 0; size < kPolicy.posterior.most_effects; ++size) {
    for (const Search::Model& from : search.best(size, size == 0 ? 1 : kPolicy.posterior.grown_from)) {
      std::vector<Search::Model> more = search.one_more(from);
      std::vector<Search::Model> leaders;
      for (const Search::Model& leader : Search::each_once(more, kPolicy.posterior.leaders)) {
        // Under the background that suits it, and those beside.
        for (const Search::Model& m : more) {
          if (m.effects == leader.effects && m.log > leader.log - kPolicy.posterior.beside && !search.has(m))
            leaders.push_back(m);
        }
      }
      search.evaluate(std::move(leaders), from.evidence.noise);
    }
  }
  return summed(search.models());
}

}  // namespace softarm::diagnose
