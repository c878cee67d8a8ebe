// What tracking software does with bodies: loses, freezes, flips, swaps them. Private to the rig.
#pragma once

#include <vector>

#include "sensors_random.h"
#include "simulator.h"

namespace softarm::rig {

/// Faults of tracking, frame after frame.
class Tracking {
 public:
  explicit Tracking(const Scenario& scenario);

  /// In order: jumps, flips, losses, freezing (a frozen body is sent though it is lost), swapped names, gaps.
  /// @param bodies in the order of Simulator::body_names()
  /// @param rings_base true poses of the rings in the rod's base frame
  void track(double t_s, const std::vector<Pose>& rings_base, std::vector<std::optional<Pose>>& bodies);

 private:
  struct Jumping {
    const Jumps* spec;
    RandomStream random;
  };
  struct Bursting {
    Telegraph telegraph;
    RandomStream random;
  };
  struct Body {
    int number = 0;  ///< 0: base
    std::vector<Jumping> jumps;
    std::vector<Bursting> bursts;
    std::optional<Pose> last_seen;
  };

  void jump(Body& body, std::optional<Pose>& pose) const;
  void flip(double t_s, const Body& body, std::optional<Pose>& pose) const;
  bool is_hidden(const Body& body, const std::vector<Pose>& rings_base) const;
  void freeze(double t_s, Body& body, std::optional<Pose>& pose) const;

  const SensorSpec& spec_;
  std::vector<Body> bodies_;
};

}  // namespace softarm::rig
