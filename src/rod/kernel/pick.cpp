#include "kernel.h"

namespace softarm::rod::kernel {

Kernel pick_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return avx512_kernel();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2_kernel();
#endif
  return baseline_kernel();
}

}  // namespace softarm::rod::kernel
