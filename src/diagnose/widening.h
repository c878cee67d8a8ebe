// How much less is known than a posterior says, by how far apart fits to parts of the trials lie.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "unseen.h"

namespace softarm::diagnose {

/// Of a spread among few folds little is known, but all unknowns of a fit are told by the same trials: what
/// is usual among them stands beside what each one's own spread says (Smyth 2004,
/// doi:10.2202/1544-6115.1027). A posterior's variances, times a factor of each unknown, are its variances;
/// factors are scattered as a scaled inverse chi^2, the spreads about them as chi^2. Scale and degrees of
/// freedom of the factors are averaged over by what the spreads say of them.
class Widening {
 public:
  /// @param spreads, covariance of a fit's unknowns
  Widening(const Spreads& spreads, const Eigen::MatrixXd& covariance);

  /// Factors of the variances of some unknowns: of the normal distribution whose interval, as sizes are told
  /// (Words::interval_sd), is as wide as Student's t's; 1 or more. What the unknown has from before the
  /// trials does not widen. By sequence and session what both say is added, less what trials that share both
  /// say, which is in either (Cameron, Gelbach and Miller 2011, doi:10.1198/jbes.2010.07136); no less than
  /// each says alone, as the difference may chance to.
  /// @param spreads of all unknowns of a fit, some of them perhaps held
  /// @param rows the unknowns
  /// @param variance of each of `rows`, by the posterior
  Eigen::VectorXd times(const Spreads& spreads, const std::vector<Eigen::Index>& rows,
                        const Eigen::VectorXd& variance) const;

 private:
  /// What is usual among factors, with its probability.
  struct Usual {
    double scale, freedom, weight;
  };
  static std::vector<Usual> usual_of(const Spread& spread, const Eigen::MatrixXd& covariance);
  static Eigen::VectorXd moderated(const Spread& spread, const std::vector<Usual>& usual,
                                   const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& variance);

  std::vector<Usual> by_sequence_, by_session_, by_both_;
};

}  // namespace softarm::diagnose
