// Other trials like these, by the Bayesian bootstrap.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace softarm::diagnose {

/// Weights of units (trials, say) in resamples of them, u x b, of mean 1 in each: uniform over all weights
/// that sum to u (Rubin 1981). No unit is ever left out whole, so what one trial alone shows stays seen.
Eigen::MatrixXd bootstrap_weights(std::size_t units);

/// Of each instant, in what unit it is: its trial, or where there are few of them a piece of it. A trial of
/// fewer instants than pieces leaves numbers out.
/// @param trial of each instant, those of a trial one after the other
std::vector<std::size_t> resampled_units(const std::vector<std::size_t>& trial);

/// How probable models are on average over resamples of the units (BayesBag; Huggins and Miller, Bayesian
/// Analysis 18, 2023). No model of an arm is exact. Then the evidence for one of two that are both wrong
/// grows with the length of the recordings, whichever it is, and trials of another day would favour the
/// other: there the average says so. Where all units say the same it is the posterior itself, and where a
/// model is right a little less sure than that.
/// @param log marginal likelihood with the odds beforehand, of each of m models; finite
/// @param by_unit u x m, log likelihood of each unit under each model, at its most probable coefficients: to
/// first order what a unit's weight changes, but for how well the unit determines the coefficients
/// @return m, of sum 1
Eigen::VectorXd averaged_over_resamples(const Eigen::VectorXd& log, const Eigen::MatrixXd& by_unit);

}  // namespace softarm::diagnose
