// Whether the motion of the arm belongs to the inputs of quite another time of the recording.
#pragma once

#include <optional>

#include "context.h"

namespace softarm::check {

struct ClockSearch {
  /// Share of the motion that the inputs explain, in pieces of the recording that their model was not fitted
  /// to, within a second of the stamps; at most 1, and below 0 where the model is worse than none.
  double as_stamped = 0.0;
  /// The shift at which they explain by far more; absent where there is none.
  std::optional<double> shift_s;
  double explained = 0.0;  ///< the same share there
  /// Another shift that is nearly as good: which of them nobody can tell (periodic inputs).
  std::optional<double> other_s;
  double other_explained = 0.0;
};

/// Looks over all shifts that leave enough of bodies and inputs together. Two steps: the correlation of how
/// much the arm moves with how much the inputs change, over all shifts; and, at its peaks, the regression of
/// clock_problem.h on one half of the recording's pieces, judged by the other half.
/// @return nothing where no input changes while a body is seen, or for too short
std::optional<ClockSearch> clock_search(const Context& context);

}  // namespace softarm::check
