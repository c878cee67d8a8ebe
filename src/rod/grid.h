// Where a rod's integration steps: at every segment end, stiffness knot, load and station, and between them
// as finely as asked.
#pragma once

#include <vector>

#include "rod/kernel/kernel.h"
#include "softarm/rod/rod.h"

namespace softarm::rod {

/// A stretch between two breakpoints, from its distal end towards the base.
struct Interval {
  int segment = 0;
  double s_distal = 0.0;
  double s_proximal = 0.0;
  int coarse_steps = 1;     ///< at refinement 1
  bool brief = false;       ///< so short that a method of order 5 does
  int first_step = 0;       ///< in Grid::steps
  bool from_joint = false;  ///< its proximal end is its segment's start
};

struct Grid {
  std::vector<Interval>
      intervals;  ///< from the tip to the base; breakpoint k is the distal end of interval k
  std::vector<kernel::Step> steps;         ///< room for the largest refinement
  std::vector<double> segment_start;       ///< s at which each segment begins
  std::vector<std::vector<int>> loads_at;  ///< indices of loads at breakpoint k (the base is the last)
  std::vector<int> station_breakpoint;     ///< breakpoint of each station

  /// @throws std::invalid_argument for loads or stations off the rod
  Grid(const Rod& layout, const std::vector<double>& stations_m, int max_refinement);

  int breakpoints() const { return static_cast<int>(intervals.size()) + 1; }
  double s(int breakpoint) const {
    return breakpoint < static_cast<int>(intervals.size()) ? intervals[breakpoint].s_distal : 0.0;
  }
  /// Lays out the steps anew; sections are those of the segments, in order.
  void refine(const Rod& layout, int refinement, const std::vector<kernel::Section>& sections);
};

/// 1 / stiffness factor of a segment's profile at a fraction of its length.
double flexibility_factor(const std::vector<arm::StiffnessKnot>& profile, double fraction);

}  // namespace softarm::rod
