#include "softarm/fit/estimate.h"
#include "softarm/fit/estimator.h"

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
    case Status::kMissingInputs:
      return "missing_inputs";
    case Status::kInvalidInput:
      return "invalid_input";
    case Status::kNoConvergence:
      return "no_convergence";
    case Status::kInconsistent:
      return "inconsistent";
  }
  return "unknown_status";
}

std::string advice(const EstimatorOptions& options) {
  if (options.method == Method::kCcPoints || options.method == Method::kCcEndpoint) return {};
  if (options.unknown != Unknown::kBoth || options.prior.enabled) return {};
  return "one frame cannot tell EI and payload apart: enable the prior";
}

}  // namespace softarm
