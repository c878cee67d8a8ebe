// Data association: which of the unlabelled points of one instant is which body of the arm.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"

namespace softarm::trial {

/// Limits of PointAssociator. The defaults suit soft arms at 50 ... 1000 Hz.
struct AssociationLimits {
  double jitter_m = 0.001;  ///< of a prediction, beside the noise: driver's filtering, jitter of stamps
  double acceleration_m_s2 = 20.0;  ///< of a body that moves freely between two samples
  double max_speed_m_s = 5.0;       ///< two samples that imply more are not of one body
  double gate_sds = 4.0;            ///< a point further from the prediction is another one
  double remembered_s = 0.06;    ///< a body that was not seen for so long is looked for by the arm's geometry
  double stretch = 0.35;         ///< the backbone grows or shrinks by no more than this share
  double ambiguity = 6.0;        ///< cost (-2 ln of likelihood ratio) by which the answer must beat any other
  double missing_cost = 12.0;    ///< of a body without a point, when the arm's geometry decides
  int broken_after_samples = 3;  ///< geometrically impossible so often in a row: all is looked for afresh
  double time_jump_s = 1.0;      ///< a stamp that goes back or leaps by more: all is looked for afresh
  std::size_t max_points = 64;   ///< an instant with more is refused: no mocap of one arm
  double min_spacing_m = 1e-5;   ///< points closer than this are one that was sent twice
};

/// Gives the unlabelled points of one instant to the arm's bodies: each point to at most one body, each body
/// at most one point, absent where the answer is not clear. The bodies' order along the arm is never guessed.
///
/// 1. Every body seen twice, and within `remembered_s`, is predicted (constant velocity), less and less
/// surely; the assignment of least total cost within the gates is found (Hungarian method: Kuhn 1955,
/// Munkres 1957), against the cost of absence. A body for which another assignment costs hardly more is
/// absent. Points of no body (ghosts) are followed, too: one that was there when the body was last seen is
/// not the body, however near it passes, and contends for its own point (joint data association with clutter
/// tracks: Blackman, Popoli 1999).
/// 2. Bodies without a prediction are looked for among the remaining points by the arm's geometry, from the
///    rod's base along the bodies that are known: distances cannot exceed the backbone between them nor fall
///    below the chord of the strongest bend, and curvature changes gently (find_chain). What all nearly best
///    answers agree on holds. A point that was there a moment ago and is hidden now counts as one that
///    might be the body. At the start this is how every body is found.
/// 3. Known bodies that break the geometry (two too far apart), or that a free point fits far better, are
///    absent; when that lasts, everything is forgotten and found afresh, and restarts() says so.
///
/// A frame with `max_points`, one body hidden and all others ghosts in its gate, takes one assignment and a
/// shortest path per contended point (rise_without()): no point need be left out to bound its time.
///
/// A body of kind ring with MeasuredBody::markers of three or more is the centre of a marker cluster of
/// radius MeasuredBody::marker_cluster_radius_m: any three of its points give it.
class PointAssociator {
 public:
  /// @throws std::invalid_argument in one line for an arm without bodies
  explicit PointAssociator(const arm::Arm& arm, const AssociationLimits& limits = {});

  /// @param stamp_s of the instant; a step by more than time_jump_s forgets what was known
  /// @param points in the mocap frame, m, in any order; those that are not finite are ignored
  /// @param base_body pose of Base::body in the mocap frame; ignored where the arm's base is fixed. Without a
  /// base nothing can be started, but what is known is followed
  /// @return position of each of Arm::bodies in the mocap frame, m
  std::vector<std::optional<Eigen::Vector3d>> update(double stamp_s,
                                                     const std::vector<Eigen::Vector3d>& points,
                                                     const std::optional<Eigen::Isometry3d>& base_body = {});
  void reset();

  /// Of the last update: what each body became. kNoPoint: none near where it should be.
  enum class Outcome { kFollowed, kFound, kNoPoint, kAmbiguous, kBrokenGeometry };
  const std::vector<Outcome>& outcomes() const { return outcomes_; }
  /// Words for the diagnostics: "no_point", "ambiguous", "broken_geometry".
  static const char* name(Outcome outcome);

  /// Points that belonged to no body, so far: ghosts, other objects.
  std::uint64_t points_unused() const { return points_unused_; }
  /// How often everything was looked for afresh because the geometry was broken or time jumped.
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Track {
    double stamp_s = 0.0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    std::optional<Eigen::Vector3d> velocity;  // m/s
  };
  struct Other {  // a point of no body
    Track track;
    double since_s = 0.0;  // followed without a break
  };
  struct Expected {  // of a track at an instant
    Eigen::Vector3d p;
    double sd_m;
  };
  struct Instant;  // the points of one call and what has been made of them

  std::vector<Eigen::Vector3d> distinct(const std::vector<Eigen::Vector3d>& points) const;
  Instant instant_of(double stamp_s, const std::vector<Eigen::Vector3d>& points,
                     const std::optional<Eigen::Isometry3d>& base_body) const;
  void start_afresh(double stamp_s);
  bool is_predicted(std::size_t body, double stamp_s) const;
  bool is_remembered(const Track& track, double stamp_s) const;
  Expected expected(const Track& track, double noise_m, double stamp_s) const;
  double cost_at(const Expected& there, const Eigen::Vector3d& p) const;
  Eigen::MatrixXd contest(const Instant& instant, const std::vector<std::size_t>& rows,
                          std::vector<std::size_t>& rivals) const;
  void follow(Instant& instant);
  void follow_others(Instant& instant) const;
  void look_for(Instant& instant);
  bool holds(Instant& instant);
  std::vector<bool> used_points(const Instant& instant) const;
  Track seen_again(const Track& before, double stamp_s, const Eigen::Vector3d& p) const;
  void remember(double stamp_s, std::size_t body, const Eigen::Vector3d& p);
  void remember_others(const Instant& instant, const std::vector<bool>& used);

  AssociationLimits limits_;
  arm::Base base_;
  std::vector<arm::MeasuredBody> bodies_;
  std::vector<int> kinds_;  // per body: 0 one marker; else which kind of cluster
  std::vector<std::optional<Track>> tracks_;
  std::vector<Other> others_;  // the oldest first
  std::vector<Outcome> outcomes_;
  double noise_m_ = 0.0;  // of points of no body
  std::optional<double> stamp_s_;
  int broken_ = 0;
  std::uint64_t points_unused_ = 0, restarts_ = 0;
};

}  // namespace softarm::trial
