#include "softarm/arm/arm_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace softarm::arm {
namespace {

namespace fs = std::filesystem;

fs::path find_arm(const std::string& name, const std::vector<std::string>& directories) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return name;
  const bool bare = !name.empty() && name.find('/') == std::string::npos;
  if (bare) {
    for (const std::string& directory : directories) {
      for (const char* ending : {".yaml", ""}) {
        const fs::path candidate = fs::path(directory) / (name + ending);
        if (fs::is_regular_file(candidate, ignored)) return candidate;
      }
    }
  }
  std::string message = "arm '" + name + "': no such file";
  if (bare && !directories.empty()) {
    std::string names;
    for (const std::string& known : arm_names(directories)) names += (names.empty() ? "" : ", ") + known;
    message += names.empty() ? ", and no shipped arms found" : ", nor a shipped arm (" + names + ")";
  }
  throw ArmError(message);
}

}  // namespace

ArmText read_arm_text(const std::string& name, const std::vector<std::string>& directories) {
  const fs::path path = find_arm(name, directories);
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || !text) throw ArmError(path.string() + ": cannot be read");
  return {text.str(), path.string()};
}

Arm load_arm_file(const std::string& name, const std::vector<std::string>& directories) {
  const ArmText file = read_arm_text(name, directories);
  return parse_arm(file.text, file.source);
}

void assume_payload(Arm& arm, double kg) {
  const Range& range = arm.payload.range_kg;
  if (!(kg >= range.low && kg <= range.high))
    throw std::invalid_argument(fmt::format("payload {}: must be from {} to {} kg for the arm {}", kg,
                                            range.low, range.high, arm.name));
  arm.payload.default_kg = kg;
}

std::vector<std::string> arm_names(const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace softarm::arm
