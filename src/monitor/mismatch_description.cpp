#include "mismatch_description.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace softarm::monitor {
namespace {

std::string place(const Mismatch& mismatch) {
  if (std::abs(mismatch.s_to_m - mismatch.s_from_m) < 0.0005)
    return fmt::format("at {:.0f} mm", 1e3 * mismatch.s_to_m);
  if (mismatch.kind == ChangeKind::kContact) {
    return fmt::format("at {:.0f} mm ({:.0f} ... {:.0f})", 1e3 * mismatch.s_m, 1e3 * mismatch.s_from_m,
                       1e3 * mismatch.s_to_m);
  }
  return fmt::format("at {:.0f} ... {:.0f} mm", 1e3 * mismatch.s_from_m, 1e3 * mismatch.s_to_m);
}

std::string body_name(const Mismatch& mismatch, const arm::Arm& arm) {
  return mismatch.body ? arm.bodies[static_cast<std::size_t>(*mismatch.body)].name : std::string("a body");
}

std::string kind_description(ChangeKind kind, const Mismatch& mismatch, const arm::Arm& arm) {
  switch (kind) {
    case ChangeKind::kNone:
      return "nothing";
    case ChangeKind::kRing:
      return kind == mismatch.kind ? body_name(mismatch, arm) + " moved on the arm" : "a body that moved";
    case ChangeKind::kContact:
      return kind == mismatch.kind ? "contact " + place(mismatch) : "a contact";
    case ChangeKind::kActuation:
      return kind == mismatch.kind ? "another actuation " + place(mismatch) : "another actuation";
    case ChangeKind::kBase:
      return "the arm moved against its base";
    case ChangeKind::kUnclear:
      return "something changed, most at " + body_name(mismatch, arm);
  }
  throw std::logic_error("kind of change without a description");
}

}  // namespace

std::string to_string(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kNone:
      return "none";
    case ChangeKind::kRing:
      return "ring";
    case ChangeKind::kContact:
      return "contact";
    case ChangeKind::kActuation:
      return "actuation";
    case ChangeKind::kBase:
      return "base";
    case ChangeKind::kUnclear:
      return "unclear";
  }
  throw std::logic_error("kind of change without a name");
}

std::string to_string(MismatchAxis axis) {
  switch (axis) {
    case MismatchAxis::kNone:
      return "";
    case MismatchAxis::kInPlane:
      return "in_plane";
    case MismatchAxis::kOutOfPlane:
      return "out_of_plane";
    case MismatchAxis::kAxial:
      return "axial";
  }
  throw std::logic_error("axis without a name");
}

std::string describe(const Mismatch& mismatch, const arm::Arm& arm) {
  if (!mismatch.valid) return "not enough frames yet";
  if (mismatch.alarm) {
    std::string text = kind_description(mismatch.kind, mismatch, arm);
    if (mismatch.or_kind) text += " (or " + kind_description(*mismatch.or_kind, mismatch, arm) + ")";
    return fmt::format("{}: {:.1f} mm", text, 1e3 * mismatch.size_m);
  }
  std::string text = fmt::format("{:.1f} mm off {}", 1e3 * mismatch.rms_m,
                                 mismatch.laws ? "the arm's laws" : "the fit (no laws: inputs missing)");
  if (mismatch.body && mismatch.laws)
    text += fmt::format(", most at {:.0f} ... {:.0f} mm", 1e3 * mismatch.s_from_m, 1e3 * mismatch.s_to_m);
  if (mismatch.threshold_sd == 0.0) text += "; learning, or the payload changed: no alarms yet";
  return text;
}

}  // namespace softarm::monitor
