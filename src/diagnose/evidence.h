// The marginal likelihood of a set of effects: all sizes and constants integrated out.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

#include "evidence_data.h"
#include "math/linear_algebra.h"

namespace softarm::diagnose {

using EffectList = std::vector<const model::Effect*>;

/// Noise of one principal direction of what is seen: white, and a Gaussian process of one kernel.
struct DirectionNoise {
  std::size_t kernel = 0;
  double share = 0.0, variance = 1.0;  ///< of the variance, the process; all of it
};

/// Of one set of effects.
struct Marginal {
  double log = 0.0;              ///< likelihood, but for the 2 pi
  Eigen::VectorXd coefficients;  ///< most probable, of unknowns, then effects, then forms
  std::vector<DirectionNoise> noise;
};

/// Covariances of n instants that processes may have: over time, and over what drives the arm at the reaches
/// of the flexible model. n x n; over time first, nothing but zeros between trials.
std::vector<Eigen::MatrixXd> kernels_of(const EvidenceData& data);

/// In what fits to the same instants are looked at: there all noise is independent.
struct Bases {
  Eigen::MatrixXd directions;  ///< principal ones of the residuals, m x m, one per column
  std::vector<math::BlockEigensystem> kernels;
  Eigen::MatrixXd courses;  ///< n x c, along which effects of the fit may act otherwise than their laws
};
Bases bases_of(const EvidenceData& data, unsigned jobs = 1);

/// Sums over all instants and directions under one noise.
struct NormalEquations {
  Eigen::MatrixXd information;  ///< p x p
  Eigen::VectorXd score;
  double square = 0.0, log_determinant = 0.0;
};

/// Mean and covariance.
struct Gaussian {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// Standard deviation of a size of an effect that is not there, in usual sizes: it moves the bodies by the
/// background beyond what the arm's constants absorb, and is a small share of a usual size; and what is not
/// known of it in any arm.
/// @param background share of the arm's length
double background_sd(const Signature& effect, double background);

/// Residuals as unknowns of the fit and sizes of effects move them, and noise. An effect that is there has
/// sizes of N(0, prior_sd^2); one that is not has a background's, N(0, background_sd^2). What an effect of
/// the fit does may go otherwise than its law says: along each of the courses by a share of N(0, form^2).
/// Coefficients are those of unknowns, then of effects, then of what each effect of the fit does by course.
class LinearGaussianModel {
 public:
  /// @param others a model made with the same bases, the effects of which it is to have, without those of
  /// `data`; nullptr: those of `data`
  /// @param but without this one
  LinearGaussianModel(const EvidenceData& data, const Bases& bases, unsigned jobs = 1,
                      const LinearGaussianModel* others = nullptr, const model::Effect* but = nullptr);

  /// With the noise of greatest likelihood, begun from `noise`; empty: from that of the residuals.
  Marginal evaluate(const EffectList& present, double background,
                    const std::vector<DirectionNoise>& noise = {}) const;
  NormalEquations normal_equations(const std::vector<DirectionNoise>& noise) const;
  /// Log marginal likelihood under these sums.
  double integrate(const NormalEquations& sums, const EffectList& present, double background,
                   Eigen::VectorXd& coefficients) const;
  /// Such sums for the coefficients of effects alone: the others, whose priors no set changes, are integrated
  /// out.
  NormalEquations over_effects(const NormalEquations& sums) const;
  /// integrate(), for many sets under one noise.
  /// @param sums over_effects()
  double integrate_effects(const NormalEquations& sums, const EffectList& present, double background) const;
  /// Of all coefficients, under these sums.
  Gaussian estimate(const NormalEquations& sums, const EffectList& present, double background) const;
  /// Such an estimate as if an effect of the fit had no other form: its coefficients of the forms are 0.
  /// @param effect by its place in EvidenceData::done
  Gaussian on_its_law(const Gaussian& estimate, std::size_t effect) const;
  /// Log likelihood of each instant at the most probable coefficients, but for the 2 pi; with correlated
  /// noise what it has of the whole.
  /// @param bases that the model was made with
  Eigen::VectorXd log_by_instant(const Marginal& marginal, const Bases& bases) const;
  const EffectList& effects() const { return each_; }
  /// Noise of greatest likelihood of one direction, by columns of coefficients, p x s; their unit_sums() are
  /// known then.
  std::vector<DirectionNoise> noise_of(std::size_t direction, const Eigen::MatrixXd& coefficients) const;
  std::size_t directions() const { return turned_.front().signatures.size(); }
  Eigen::Index coefficients() const { return mean().size(); }

 private:
  /// Places of the coefficients of effects, or of all others.
  std::vector<Eigen::Index> rows(bool of_effects) const;
  /// Of the coefficients, before the data.
  Eigen::VectorXd precision(const EffectList& present, double background) const;

  /// Everything in the eigenvectors of one kernel.
  struct InBasis {
    Eigen::VectorXd eigenvalues;
    Eigen::MatrixXd inverse_spectra;          ///< of noise by the share that the kernel has; one per column
    Eigen::VectorXd log_spectra;              ///< sums of their logarithms
    std::vector<Eigen::MatrixXd> signatures;  ///< by direction, n x p
    Eigen::MatrixXd residual;                 ///< n x m
  };
  /// Of one direction with noise of this kernel and share, its variance 1: worked out once, as searches come
  /// back to the same few. Thread-safe.
  const NormalEquations& unit_sums(std::size_t direction, std::size_t kernel, double share) const;

  static InBasis spectra_of(const Eigen::VectorXd& eigenvalues);
  /// A coefficient with its prior.
  void add(const Signature& signature);
  Eigen::Map<const Eigen::VectorXd> mean() const {
    return {mean_.data(), static_cast<Eigen::Index>(mean_.size())};
  }

  std::vector<InBasis> turned_;
  mutable std::mutex known_mutex_;
  mutable std::map<std::tuple<std::size_t, std::size_t, double>, NormalEquations> known_;
  std::vector<double> mean_, sd_;          ///< of the coefficients; of effects those of the slab
  std::vector<double> left_, unknown_sd_;  ///< of the Signature, by coefficient
  double log_weight_ = 0.0;                ///< Signature::log_weight of all unknowns
  EffectList effect_;                      ///< by coefficient, null for unknowns
  std::size_t forms_of_ = 0;               ///< effects of the fit; the last coefficients are of these ...
  Eigen::Index courses_ = 0;               ///< ... by course
  EffectList each_;                        ///< once each
};

/// A set of effects under a background, about one fit.
struct Evaluated {
  const LinearGaussianModel* about = nullptr;
  EffectList present;
  double background = 0.0;
  Marginal marginal = {};
};
/// Fills the marginals, as LinearGaussianModel::evaluate() does, all from one noise. Signatures are more than
/// caches hold: those about one fit are read once for all its sets.
/// @param list about models made with the same bases
void evaluate(std::vector<Evaluated>& list, const std::vector<DirectionNoise>& noise, unsigned jobs);

}  // namespace softarm::diagnose
