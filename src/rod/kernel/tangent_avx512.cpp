#include "tangent_step.h"

namespace softarm::rod::kernel {

void tangent_step_avx512(const Step& step, const Stage* stages, const LaneSource& source, LaneState& y) {
  tangent_step<8>(step, stages, source, y);
}

}  // namespace softarm::rod::kernel
