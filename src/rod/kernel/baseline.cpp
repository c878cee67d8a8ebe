#include "nominal_step.h"
#include "tangent_step.h"

namespace softarm::rod::kernel {

Kernel baseline_kernel() {
  return {nominal_step, tangent_step<2>};
}

}  // namespace softarm::rod::kernel
