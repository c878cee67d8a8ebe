#include "softarm/fit/estimate.h"

namespace softarm {

std::string to_string(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kNoBasePose:
      return "no_base_pose";
    case Status::kNotEnoughBodies:
      return "not_enough_bodies";
    case Status::kMissingPayload:
      return "missing_payload";
    case Status::kMissingPressures:
      return "missing_pressures";
    case Status::kInvalidInput:
      return "invalid_input";
    case Status::kNoConvergence:
      return "no_convergence";
    case Status::kInconsistent:
      return "inconsistent";
  }
  return "unknown_status";
}

}  // namespace softarm
