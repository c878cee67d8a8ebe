#include "nominal_step.h"
#include "tangent_step.h"

namespace softarm::rod::kernel {

Kernel avx512_kernel() {
  return {nominal_step, tangent_step<8>};
}

}  // namespace softarm::rod::kernel
