#include "far_from_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "policy.h"
#include "sentences.h"
#include "softarm/identify/identify.h"

namespace softarm::diagnose {
namespace {

constexpr std::size_t kMostNamed = 4;  // in one sentence

/// What an arm has whatever is asked of it; what others say is often not determined.
bool is_of_every_arm(arm::ConstantKind kind) {
  return kind == arm::ConstantKind::kMomentGain || kind == arm::ConstantKind::kCableGain ||
         kind == arm::ConstantKind::kBendingStiffness;
}

/// "5 % of", or "1.2e+03 times".
std::string times(double ratio) {
  return ratio < 1.0 ? fmt::format("{:.2g} % of", 100.0 * ratio) : fmt::format("{:.2g} times", ratio);
}

}  // namespace

std::string far_from_file(const JointModel& model, const std::vector<Shift>& shifts) {
  std::vector<std::string> far;
  for (std::size_t j = 0; j < shifts.size(); ++j) {
    const identify::ConstantRef& constant = model.constants()[j];
    const double told = identify::value_of(model.arm(), constant), seen = shifts[j].after;
    if (!is_of_every_arm(constant.kind) || !(told > 0.0)) continue;
    const double ratio = std::max(0.0, seen) / told;
    if (ratio <= kPolicy.words.far && ratio * kPolicy.words.far >= 1.0) continue;
    if (std::abs(seen - told) < kPolicy.words.far_sd * shifts[j].sd_after) continue;
    far.push_back(fmt::format("{} is {}", shifts[j].name, times(ratio)));
  }
  if (far.empty()) return "";
  if (far.size() > kMostNamed) far.resize(kMostNamed);
  return fmt::format(
      "Constants that fit these trials are far from the arm file's: {} the file's value. Is everything "
      "connected, are the inputs in the file's order and units, are the direction of gravity and the "
      "payloads right? All that follows uses the constants as fitted to the trials.",
      one_of(far, "and"));
}

}  // namespace softarm::diagnose
