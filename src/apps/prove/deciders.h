// What else could decide: the proof's baselines. They have what a round of the diagnosis has, the same fit,
// noise, signatures, refits and gates, and differ in how they decide.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bic.h"
#include "diagnose/refits.h"
#include "softarm/identify/identify.h"

namespace softarm::prove {

struct Named {
  std::string effect;
  double probability = 0.0;
  std::vector<std::string> confusable_with;  ///< as good, or instead of it
};

struct Decision {
  std::string method;
  bool alarm = false;                ///< something is there
  std::vector<Named> effects;        ///< what it names, best first
  std::vector<std::string> ranking;  ///< best first, as many as it ranks
};

/// What decisions of one step stand upon: a model so far, and the catalogue beside it.
struct Look {
  diagnose::Standing standing;
  diagnose::Round round;                   ///< screened and refitted
  std::vector<model::Present> candidates;  ///< the catalogue at the values that the data say so far
  std::unique_ptr<Bic> bic;                ///< null: too few instants
  std::vector<Weighed> models;             ///< nothing more, and the best with one effect more
  std::vector<double> rough;               ///< BIC of each that was screened, to first order
};

/// @param delayed a fit with clocks apart, from which the refit of that begins; null: none
/// @param may_move whether the model so far may come to better constants first
Look look(diagnose::JointModel& model, diagnose::Standing standing, const diagnose::Linearised* delayed,
          const diagnose::Options& options, bool may_move = true);

/// Step by step the effect that is most probable by BIC weights, through the gates of the diagnosis, while
/// there is one.
Decision bic_stepwise(diagnose::JointModel& model, const Look& first, const diagnose::Options& options);

/// The set of a group lasso's path whose refit has the least BIC, less what that refit does not support.
Decision group_lasso(diagnose::JointModel& model, const Look& first, const diagnose::Options& options);

/// Residuals of fits frame by frame, and that effect whose signature in such residuals is the most probable
/// by BIC weights: if its refit to all trials supports it.
Decision per_frame(diagnose::JointModel& model, const Look& first);

/// What is left, by its size on unseen trials and by what a flexible model learns of it: there is something,
/// or there is not. It never names.
Decision flexible(const diagnose::JointModel& model, const Look& first, unsigned jobs);

/// What several of these have in common.
/// Sets how far residuals are beyond the noise, from a fit, which a step before may have left at its own:
/// none of these decides otherwise after another one.
void begin_at(diagnose::JointModel& model, const diagnose::Linearised& fit);
Weighed weighed(const diagnose::JointModel& model, const Look& look, const diagnose::Linearised& refit);
/// Ids of the catalogue as it was screened, by their probability, then to first order.
std::vector<std::string> ranking_of(const Look& look, const diagnose::Posterior& posterior);
/// What is named first, then the others in their order.
void put_first(const std::vector<Named>& effects, std::vector<std::string>& ranking);
/// Those that are there where this one is not.
std::vector<std::string> instead_of(const Look& look, const diagnose::Posterior& posterior,
                                    const model::Effect* effect);
/// Null: there is none in the round.
const diagnose::Refitted* refit_of(const Look& look, const model::Effect* effect);
/// From where the linear model expects it.
diagnose::Linearised refit_with(diagnose::JointModel& model, const Look& look,
                                const diagnose::EffectList& effects);

/// All four: per_frame, bic, lasso, gp. What the flexible model finds is an alarm of the others, too.
/// @param held, tied constants, as `softarm diagnose` takes them
std::vector<Decision> decide(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
                             const std::vector<std::string>& held = {},
                             const std::vector<std::string>& tied = {});

}  // namespace softarm::prove
