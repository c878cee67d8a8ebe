#include "input_kind.h"

#include <stdexcept>

namespace softarm::arm {

std::string to_string(InputKind kind) {
  switch (kind) {
    case InputKind::kPressure:
      return "pressure";
    case InputKind::kVacuum:
      return "vacuum";
    case InputKind::kTension:
      return "tension";
    case InputKind::kAngle:
      return "angle";
  }
  throw std::logic_error("kind of input without a name");
}

std::string unit_of(InputKind kind) {
  switch (kind) {
    case InputKind::kTension:
      return "N";
    case InputKind::kAngle:
      return "rad";
    default:
      return "Pa";
  }
}

}  // namespace softarm::arm
