// What constants would be that the arm file's ranges stop.
#pragma once

#include <string>
#include <vector>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

struct BeyondRange {
  std::string text;  ///< empty: no constant rests at an end
  /// That trials are predicted better, by more than what is too small to matter, with a constant beyond the
  /// file's own range.
  bool helps = false;
  /// Where that helps: for each effect that was selected, its probability given all others with the constants
  /// free of the file's ranges. What only stood in for a range that is too narrow is hardly there.
  std::vector<double> still_there;
};

/// In one or two sentences which of the arm's constants rest at an end of what the arm file allows because
/// the trials draw them beyond it, and, where the file's own range stops them, what they would be without it
/// and how much better trials are predicted then.
BeyondRange beyond_range(const JointModel& model, const Selection& selection, const Options& options);

}  // namespace softarm::diagnose
