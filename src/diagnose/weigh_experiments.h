// What each experiment of a menu would separate or show.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "experiment_menu.h"
#include "separation.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Separations in standard deviations: row: the model that is true; column: the one that is fitted to old and
/// new trials, all its constants and numbers anew. 0 on the diagonal.
struct Separations {
  Eigen::MatrixXd today;  ///< of the trials that there are
  /// By experiment; nothing where the arm would have no equilibrium, or would swing all the time.
  std::vector<std::optional<Eigen::MatrixXd>> with;
};

/// @param model of the trials that there are
/// @param baseline the fit without effects: what it takes for swinging will not be compared
/// @param whole derivatives where those are needed (JointModel::needs_whole_derivatives), not to first order:
/// these tell which experiments are worth a look, for a tenth of the time
/// @param inflation of chi^2: how much residuals of neighbouring instants are worth less than independent
/// ones
/// @param options of the model: threads, constants held and tied
Separations weigh_apart(const JointModel& model, const JointParameters& baseline,
                        const std::vector<Explanation>& explanations, const std::vector<Experiment>& menu,
                        bool whole, double inflation, const Options& options);

/// Standard deviations by which effects of these sizes would be seen, all constants being fitted.
struct Visibility {
  std::vector<double> today;                             ///< by effect
  std::vector<std::optional<std::vector<double>>> with;  ///< by experiment, then by effect
};

/// @param at the fit to the trials that there are; derivatives by everything are added to it
/// @param hidden effects that are not in it, with their sizes
Visibility weigh_collinear(JointModel& model, Linearised& at, const std::vector<model::Present>& hidden,
                           const std::vector<Experiment>& menu, double inflation, const Options& options);

}  // namespace softarm::diagnose
