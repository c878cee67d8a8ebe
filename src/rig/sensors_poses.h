// From where the bodies are to what the cameras make of them: private to the rig.
#pragma once

#include <functional>
#include <vector>

#include "sensors_random.h"
#include "simulator.h"

namespace softarm::rig {

/// Pose in the rod's base frame at a fraction of the arm's length at rest, now.
using PoseAt = std::function<Pose(double fraction)>;

/// Systematic errors and noise of the measured poses of one frame after the other.
class PoseSensors {
 public:
  explicit PoseSensors(const Scenario& scenario);

  /// Poses of `base` (if measured) and the rings in the mocap frame, nothing lost.
  std::vector<Pose> observe(double t_s, const std::vector<Pose>& rings_base, const PoseAt& pose_at);

 private:
  struct Coloured {
    RandomStream random;
    GaussMarkov position, orientation;
  };
  /// One wobbling ring's memory.
  struct Wobble {
    const WobblingRing* spec;
    std::vector<Eigen::Vector3d> last_p;      ///< the last two places in the mocap frame
    std::optional<Eigen::Vector3d> across_g;  ///< apparent weight across the arm over gravity, lagging
  };
  struct Body {
    int number = 0;                        ///< 0: base
    const TrackedBody* tracked = nullptr;  ///< absent: centred on the backbone
    std::vector<const MarkerSlip*> slips;
    std::vector<const SkinMarker*> skins;
    Eigen::Vector3d bias_m = Eigen::Vector3d::Zero(), bias_turn_rad = Eigen::Vector3d::Zero();
    std::vector<Wobble> wobbles;
    std::vector<Coloured> coloured;
  };

  Pose true_pose(const Body& body, double t_s, const std::vector<Pose>& rings_base,
                 const PoseAt& pose_at) const;
  /// What a skin that slides does to a ring at a fraction of the arm's length.
  void slide(const SkinMarker& skin, double fraction, const PoseAt& pose_at, Pose& pose) const;
  void wobble(Wobble& wobble, const Pose& ring_mocap, Pose& measured) const;
  void see(double t_s, Pose& pose) const;

  const Scenario& scenario_;
  double frame_s_;
  std::vector<Body> bodies_;
};

/// Whether a fault of a number of bodies or inputs concerns this one.
inline bool concerns(int selected, int number) {
  return selected == kAll || selected == number;
}

/// Turns a pose by a rotation vector in its own frame; none leaves it exactly alone.
void turn_in_body(const Eigen::Vector3d& rotation_vector, Pose& pose);

}  // namespace softarm::rig
