// What the walls of an arm remember: the one place where their elements are walked through time.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"

namespace softarm::arm {

// What an arm file may say of an element, and of how many of a kind.
constexpr double kLeastWallTime_s = 0.01, kMostWallTime_s = 3600.0;
constexpr double kMostWallShare = 0.98;  // of all together: something comes at once
constexpr int kMostWallElements = 3;

/// What a segment's static laws say at an instant: curvature by its actuation (x, y; 1/m) and length (m).
struct WallDrive {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd by;       ///< by constants, one column each; may have none
  double pressure_pa = 0.0;  ///< mean of the chambers', above zero
};

WallDrive wall_drive(const Segment& segment, const SegmentPrediction& by_laws, double pressure_pa);
/// Mean gauge pressure of the segment's chambers and central chamber, those below zero as zero; absent ones
/// are left out.
double mean_pressure_pa(const Arm& arm, const Segment& segment, const InputValues& inputs);

/// What one unit of a constant changes of the wall.
struct WallChange {
  int element = -1;  ///< those of bending first; -1: none
  double time_s = 0.0, share = 0.0, slows_per_pa = 0.0, shares_grow_per_pa = 0.0;
};

/// Standard deviation of an element's state at the beginning: curvature, 1/m, or length, m. Where the arm
/// does not say it, 0.2 rad over the segment, and 2 % of its length.
double wall_start_sd(const Segment& segment, bool axial);

/// The elements of one segment's wall, bending first. The state at the beginning counts two numbers for each
/// of bending (x, y), then one for each axial one.
class WallMemory {
 public:
  explicit WallMemory(const Segment& segment);
  bool empty() const { return elements_.empty(); }
  int starts() const { return starts_; }
  /// Standard deviation of each number of the state at the beginning.
  Eigen::VectorXd start_sd() const;

  /// @param start of the recording, what the elements have beyond the drive; empty: nothing
  void begin(const WallDrive& drive, const Eigen::VectorXd& start = {});
  /// The drive went straight from its last value.
  /// @param changes of the wall by the constants of WallDrive::by, column by column; empty: none
  void follow(double dt_s, const WallDrive& now, const std::vector<WallChange>& changes = {});

  /// What is still to come: that of the static laws less the present.
  Eigen::Vector3d lag() const;
  Eigen::Matrix3Xd lag_by(const std::vector<WallChange>& changes) const;
  Eigen::Matrix3Xd lag_by_start() const;
  /// Of the lag, for what is not known of the beginning and of gaps.
  Eigen::Vector3d lag_variance() const;

 private:
  struct Element {
    double time_s, share;
    int row, rows, start;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< w, in its rows
    Eigen::Matrix3Xd by = {};                      ///< constants
    double left = 1.0;                             ///< share of the beginning that is left
    Eigen::Vector3d variance = Eigen::Vector3d::Zero();
    double start_sd;
  };
  /// What an element's share is multiplied by at the present pressure, with its derivatives: by the sum of
  /// the shares of its kind and by shares_grow_per_pa.
  struct Grown {
    double factor = 1.0, by_sum = 0.0, by_growth = 0.0;
  };
  Grown grown(const Element& element) const;
  void follow(double dt_s, const WallDrive& now, const std::vector<WallChange>& changes, int which);

  std::vector<Element> elements_;
  double slows_per_pa_ = 0.0, shares_grow_per_pa_ = 0.0;
  double bending_share_ = 0.0, axial_share_ = 0.0;  ///< sums, without pressure
  int starts_ = 0;
  WallDrive last_;
};

/// The walls of an arm, frame by frame.
class LawMemory {
 public:
  explicit LawMemory(const Arm& arm);
  bool empty() const { return walls_.empty(); }
  void reset() { last_s_.reset(); }
  /// Walks to the frame and takes from the predictions of the static laws what is still to come. A stamp
  /// before the last one begins anew.
  void follow(double stamp_s, const InputValues& inputs, std::vector<SegmentPrediction>& predictions);
  /// What was taken from the last predictions, of all segments; empty where none has a wall.
  const std::vector<Eigen::Vector3d>& kept_back() const { return kept_back_; }
  /// Of a segment's curvature (x, y) and length, see WallMemory::lag_variance().
  Eigen::Vector3d variance(std::size_t segment) const;

 private:
  const Arm& arm_;
  std::vector<WallMemory> walls_;  ///< of all segments; empty where none has a wall
  std::vector<Eigen::Vector3d> kept_back_;
  std::optional<double> last_s_;
};

/// Takes what is still to come from what the static laws say.
void take_off(const Eigen::Vector3d& lag, SegmentPrediction& prediction);

bool has_wall(const Arm& arm);

}  // namespace softarm::arm
