// Messages of a time that cannot be the recording's.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "softarm/arm/arm.h"
#include "softarm/trial/recording.h"

namespace softarm::check {

/// What is set aside of one source.
struct Stray {
  std::size_t count = 0;
  std::size_t of = 0;       ///< messages of the source
  std::size_t stamped = 0;  ///< of those set aside: by their stamps, too, which the programs go by
  double off_s = 0.0;       ///< the furthest, from the recording
  bool of_receipt = false;  ///< else of the stamps
};

struct Strays {
  trial::CheckRecording kept;  ///< the recording without them
  std::map<std::string, Stray> by_source;
};

/// Sets aside messages that were recorded, or stamped, hours away from the others: single ones, and, where
/// what is left still lasts for days, all but the longest stretch. What comes after may then take time for as
/// long as the recording lasts.
Strays without_strays(const trial::CheckRecording& recording, const arm::Arm& arm);

}  // namespace softarm::check
