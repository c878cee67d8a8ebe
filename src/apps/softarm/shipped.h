// Finds files that ship with the package by their bare names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softarm::app {

/// Folders where files of this kind ship: installed beside this program, and in the source checkout.
std::vector<std::string> config_folders(const std::string& kind);

/// A file given by its path, or one that ships given by its bare name: "online_200mm" of kind "scenarios".
///
/// @throws Failure naming the files that ship
std::filesystem::path find_config(const std::string& kind, const std::string& path_or_name);

}  // namespace softarm::app
