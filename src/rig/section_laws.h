// The section laws that can be hidden in an arm: private to the rig.
#pragma once

#include <memory>
#include <vector>

#include "section_law.h"

namespace softarm::rig {

using SectionLawPtr = std::shared_ptr<const SectionLaw>;

/// M = EI u (1 + beta |u|^2).
SectionLawPtr cubic_stiffening(double beta_m2);

/// M = EI u / (1 - beta |u|^2): chains that become taut at |u| = beta^-1/2 (A. N. Gent, Rubber Chem. Technol.
/// 69, 1996, for bending). Beyond 0.9 of that square it goes on along its tangent.
SectionLawPtr gent_stiffening(double beta_m2);

/// M = EI u (1 - share x^2 / (1 + x^2)), x = |u| / knee: the section turns oval (L. G. Brazier, Proc. R. Soc.
/// A 116, 1927, has the moment to third order; this is the same there and stays above 0). Grows with u for
/// shares up to 8/9.
SectionLawPtr oval_softening(double share, double knee_per_m);

/// Up to the knee EI u; beyond it the moment falls behind that by the share of what takes it towards twice
/// the knee's, EI knee (2 - exp(1 - |u| / knee)): R. L. Comer and S. Levy's (AIAA J. 1, 1963) inflated beam
/// collapses at twice the moment at which it wrinkles. The curve between is a form of its own.
SectionLawPtr wrinkling_softening(double share, double knee_per_m);

/// One Maxwell branch in parallel to a spring, of the same EI together.
struct MaxwellBranch {
  double share = 0.0;         ///< of EI
  double relaxation_s = 1.0;  ///< at a held curvature
};
/// EI is what is felt at once; under a held curvature the moment falls to (1 - sum of shares) of that. In
/// statics all branches are relaxed. Exact for curvatures that are linear in time within a step.
SectionLawPtr maxwell_branches(std::vector<MaxwellBranch> branches);

/// Adds EI h z, z the hysteretic variable of the isotropic Bouc-Wen model (Y. J. Park, Y. K. Wen,
/// A. H.-S. Ang, Earthq. Eng. Struct. Dyn. 14, 1986) with exponent 2 and beta = gamma = 1/2, which tends to
/// the unit vector along a monotonous bending: a cycle wide against `yield_per_m` is a loop 2 h EI high.
SectionLawPtr bouc_wen(double height_per_m, double yield_per_m);

/// The material is stiffer by `share` where it has not yet been bent so far. With `recovers` as Ogden and
/// Roxburgh (Proc. R. Soc. A 455, 1999) have it: always on the primary curve, below the largest curvature m
/// seen there only by the share times 1 - erf((m^2 - u^2) / scale^2). Without: by the share times
/// exp(-m / scale) everywhere.
SectionLawPtr mullins(double share, double scale_per_m, bool recovers);

/// How a jammed core answers: K e, e its elastic curvature, in place of K u.
struct CoreLaw {
  /// Of the curvature that it had when it was jammed (all vacuum at once, or bit by bit): what it takes for
  /// its straight state. 0: it always takes the straight arm for it.
  double memory = 0.0;
  double yield_per_m = 0.0;  ///< |e| at which it slips; 0: never
  bool smooth = false;       ///< slips gradually, by the model of bouc_wen(); else sharply
};
SectionLawPtr jammed_core(const CoreLaw& law);

/// Against bending in the plane through azimuth, EI is 1 + share times what it is.
SectionLawPtr plane_stiffness(double azimuth_rad, double share);

/// The same at small curvatures; ribs give way as the part of the curvature in that plane grows: they add
/// EI share a tanh(u / a), a = 8 / m.
SectionLawPtr rib_stiffness(double azimuth_rad, double share);

/// Towards azimuth, the part of the curvature in that plane meets 1 - share times the EI. Sets in over 0.5 /
/// m.
SectionLawPtr one_sided_softness(double azimuth_rad, double share);

/// The same at large curvatures; the wall there folds bit by bit: 1 - share (1 - exp(-u / a)) times the EI, a
/// = 2 / m, is what the next bit of bending meets.
SectionLawPtr one_sided_folds(double azimuth_rad, double share);

/// z of the Bouc-Wen model of bouc_wen() after a straight path, exactly. @param path in yield curvatures
/// @param tangent derivative by the path's end
Eigen::Vector2d bouc_wen_along(const Eigen::Vector2d& z, const Eigen::Vector2d& path,
                               Eigen::Matrix2d& tangent);

}  // namespace softarm::rig
