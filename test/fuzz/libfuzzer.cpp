// libFuzzer's entry to the target SOFTARM_FUZZ_TARGET: scripts/fuzz.
#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  softarm::fuzz::SOFTARM_FUZZ_TARGET(data, size);
  return 0;
}
