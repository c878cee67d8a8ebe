#include "version.h"

namespace softarm::app::batch {

const char* program_version() {
  return SOFTARM_VERSION;
}

}  // namespace softarm::app::batch
