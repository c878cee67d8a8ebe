#include "tangent_step.h"

namespace softarm::rod::kernel {

void tangent_step_baseline(const Step& step, const Stage* stages, const LaneSource& source, LaneState& y) {
  tangent_step<2>(step, stages, source, y);
}

}  // namespace softarm::rod::kernel
