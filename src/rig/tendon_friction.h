// Tensions along rubbing tendons: private to the rig.
#pragma once

#include <vector>

#include "input_path.h"

namespace softarm::rig {

/// Each tendon passes the routing before the base and then every segment up to its last, listed there or
/// sheathed. Behind each the tension moves only when friction cannot hold it: a play whose edges are those of
/// the capstan equation. Along a segment it falls exponentially; what acts is the mean.
class TendonFrictionState {
 public:
  TendonFrictionState(const TendonFriction& spec, const ArmSpec& arm, const std::vector<double>& start_n);

  /// Replaces the tensions at the motors by those in each segment.
  void act(std::vector<Acting>& segments);

 private:
  struct Tendon {
    std::vector<double> behind_n;  ///< tension behind the routing and behind each segment that it passes
  };
  TendonFriction spec_;
  std::vector<Tendon> tendons_;
};

}  // namespace softarm::rig
