// A bag as the recording that `check` looks at.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "softarm/arm/arm.h"
#include "softarm/trial/recording.h"

namespace softarm {

/// Reads everything that the arm listens to, through the conversions of the live node; what is missing, of
/// another type, defined otherwise or cannot be read is said in CheckRecording::topics, not refused. The time
/// of a record is that of receipt.
/// @param on_total called once with the number of messages
/// @param on_messages called now and then with the messages read since the last call
/// @throws BagError if it is no complete bag, or is itself damaged
/// @throws std::invalid_argument where the arm names a type that no adapter reads
trial::CheckRecording read_recording(const std::string& path, const arm::Arm& arm,
                                     const std::function<void(std::uint64_t)>& on_total,
                                     const std::function<void(std::uint64_t)>& on_messages);

}  // namespace softarm
