// Lists of markers in messages of the drivers' own packages. They are read by the names of their fields, so
// versions with more of them are read as well.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "body_driver.h"
#include "body_reader.h"
#include "marker_bodies.h"

namespace softarm {

/// Fields of a marker: "", false or NaN where it has none of that name.
std::string text_at(const nlohmann::json& marker, const char* field);
bool flag_at(const nlohmann::json& marker, const char* field);
/// @param field that has x, y and z; empty: the marker itself has
Eigen::Vector3d position_at(const nlohmann::json& marker, const std::string& field, const BodyReader& reader);

using ReadMarker = ReportedMarker (*)(const nlohmann::json&, const BodyReader&);

/// The topic of a message whose field `list` holds the markers.
std::vector<InputTopic> marker_list_topic(const arm::Arm& arm, const arm::BodySource& source,
                                          const Bodies& bodies, const char* list, ReadMarker read);

}  // namespace softarm
