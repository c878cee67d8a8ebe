// Diagnosis to JSON, shared by report.json and report.html.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "softarm/diagnose/diagnose.h"
#include "softarm/report/report.h"

namespace softarm::report {

using Json = nlohmann::ordered_json;

/// What report.json holds; numbers that are not finite are absent.
Json report_json(const diagnose::Diagnosis& diagnosis, const Origin& origin);

/// Takes out what JSON has no number for: a key whose value is not finite goes, an element of a list becomes
/// null.
void drop_not_finite(Json& json);

/// As text. Bytes that are not UTF-8 (names of bags may have them) become U+FFFD.
/// @param indent  spaces; -1: all on one line
std::string dump(const Json& json, int indent);

}  // namespace softarm::report
