// Topics whose messages belong to packages that need not be here.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "input_topic.h"

namespace softarm {

/// Converts a decoded message: (message, time of receipt, assembler).
using ConvertAny = std::function<void(const nlohmann::json&, trial::Stamp, trial::FrameAssembler&)>;

/// An InputTopic of messages of `type`, read by the definition that comes with them (MessageSchema), so that
/// versions of a definition that add or leave out fields are read too. A publisher that sends no definition
/// is read by our mirror of the type, if its MD5 sum is that of the mirror. What cannot be decoded is counted
/// as rejected: "undecodable <feeds>".
InputTopic make_any_input_topic(const std::string& topic, const std::string& type, const std::string& feeds,
                                ConvertAny convert);

/// Stamp of a decoded message by its header; absent where it has none or leaves it zero.
std::optional<trial::Stamp> header_stamp(const nlohmann::json& message);

}  // namespace softarm
