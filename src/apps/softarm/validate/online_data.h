// The online paper's experiment on the virtual rig, and what each method makes of every frame.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "experiment.h"
#include "softarm/estimate/estimator.h"

namespace softarm::app::validate {

/// Where the experiment is done.
struct OnlineSetting {
  const char* name = "";
  Quality quality = Quality::kIdeal;
  bool standing = false;
};
constexpr std::array<OnlineSetting, 4> kOnlineSettings{{{"ideal, standing", Quality::kIdeal, true},
                                                        {"real-like, standing", Quality::kRealLike, true},
                                                        {"ideal, hanging", Quality::kIdeal, false},
                                                        {"real-like, hanging", Quality::kRealLike, false}}};

constexpr std::array<arm::Method, 4> kOnlineMethods{arm::Method::kFullPoints, arm::Method::kEndOrientation,
                                                    arm::Method::kCcPoints, arm::Method::kCcEndpoint};
constexpr std::array<arm::Objective, 2> kOnlineObjectives{arm::Objective::kSumOfDistances,
                                                          arm::Objective::kLeastSquares};
constexpr std::size_t kPrinted = 0, kSquares = 1;  // of these

/// One frame by one method.
struct OnlineFit {
  bool ok = false;
  double error_percent = 0.0;  ///< against the measured points
  double truth_percent = 0.0;  ///< against their true places
  double tip_mm = 0.0;         ///< tip against its true place
  std::optional<double> bending_stiffness_nm2, payload_kg;
  bool identifiable = false;  ///< EI, or the payload where that is the unknown
};

struct OnlineFrame {
  trial::Frame frame;  ///< as measured
  double payload_kg = 0.0;
  double true_stiffness_nm2 = 0.0;
  double tip_angle_rad = 0.0;
  std::array<std::array<OnlineFit, kOnlineObjectives.size()>, kOnlineMethods.size()> fits;
  OnlineFit printed;  ///< full points with the printed load moments, least squares; first repeat only
  /// Unseen weights only: payload from EI of the first data set.
  std::array<OnlineFit, kOnlineObjectives.size()> weighed;
};

/// All of one combination of pressures.
struct OnlineSet {
  std::vector<double> pressures_pa;
  double baseline_pa = 0.0;                        ///< lowest of them
  std::vector<std::vector<OnlineFrame>> datasets;  ///< by payload, then repeats: one frame each
  std::vector<OnlineFrame> unseen;                 ///< repeats
  double moving_m = 0.0;                           ///< at most, while measured
};

/// 0, 150, 170, 190, 210, 230 g.
const std::vector<double>& online_payloads_kg();

/// Error formula (7), in percent: 100 sum_i |error_i| / (i L), i = 1 ... K. With points at i L / K that is
/// the mean over the points of their error relative to their arclength.
double online_error_percent(const std::vector<Eigen::Vector3d>& errors_m, double length_m);

/// Runs the experiment: pressures, no load, five loads; rest; pressures again with an unseen weight.
std::vector<OnlineSet> online_experiment(const OnlineSetting& setting, const Settings& settings, int sets,
                                         int repeats);

}  // namespace softarm::app::validate
