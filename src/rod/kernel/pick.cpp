#include "kernel.h"

namespace softarm::rod::kernel {

TangentStep pick_tangent_step() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return tangent_step_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return tangent_step_avx2;
#endif
  return tangent_step_baseline;
}

}  // namespace softarm::rod::kernel
