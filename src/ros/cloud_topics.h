// Points without identity, all bodies on one topic.
#pragma once

#include <optional>
#include <vector>

#include "body_driver.h"
#include "body_reader.h"
#include "conversions.h"
#include "marker_bodies.h"

namespace softarm {

using Markers = std::vector<ReportedMarker>;

template <class Points>
Markers markers_at(const Points& points, const BodyReader& reader) {
  Markers markers;
  for (const auto& p : points) markers.push_back({{}, reader.position(p.x, p.y, p.z)});
  return markers;
}

/// @tparam markers_of reads a message, which has a header; absent where it holds no points
template <class Message, std::optional<Markers> (*markers_of)(const Message&, const BodyReader&)>
std::vector<InputTopic> cloud_topic(const arm::Arm& arm, const arm::BodySource& source,
                                    const Bodies& bodies) {
  const auto convert = [reader = BodyReader(source), sink = associated_bodies(arm)](
                           const Message& message, trial::Stamp receipt, trial::FrameAssembler& assembler) {
    if (!reader.reads(message.header.frame_id)) return assembler.count_rejected("other_frame", "markers");
    const std::optional<Markers> markers = markers_of(message, reader);
    if (!markers) return assembler.count_rejected("no_points", "markers");
    sink(reader.stamp(to_stamp(message.header.stamp), receipt), *markers, assembler);
  };
  return {make_input_topic<Message>(source.topic, names_of(bodies), convert)};
}

}  // namespace softarm
