// The table of the drivers.
#include "arm/body_types.h"
#include "body_driver.h"

namespace softarm {

#define SOFTARM_DECLARE(name, type, message, unit, server_time) BodyDriver driver_##name();
SOFTARM_BODY_TYPES(SOFTARM_DECLARE)
#undef SOFTARM_DECLARE

const std::map<std::string, BodyDriver>& body_drivers() {
#define SOFTARM_MAKE(name, type, message, unit, server_time) {type, driver_##name()},
  static const std::map<std::string, BodyDriver> table{SOFTARM_BODY_TYPES(SOFTARM_MAKE)};
#undef SOFTARM_MAKE
  return table;
}

}  // namespace softarm
