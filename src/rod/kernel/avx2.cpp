#include "nominal_step.h"
#include "tangent_step.h"

namespace softarm::rod::kernel {

Kernel avx2_kernel() {
  return {nominal_step, tangent_step<4>};
}

}  // namespace softarm::rod::kernel
