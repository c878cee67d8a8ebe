#include "shipped.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <system_error>
#include <vector>

#include "command.h"

namespace softarm::app {
namespace fs = std::filesystem;

std::vector<std::string> config_folders(const std::string& kind) {
  // Installed: <prefix>/lib/softarm_estimator/softarm and <prefix>/share/softarm_estimator/config.
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path share = program.parent_path().parent_path().parent_path() / "share" / "softarm_estimator";
  return {(share / "config" / kind).string(), (fs::path(SOFTARM_SOURCE_DIR) / "config" / kind).string()};
}

fs::path find_config(const std::string& kind, const std::string& path_or_name) {
  std::error_code error;
  if (fs::is_regular_file(path_or_name, error)) return path_or_name;
  std::set<std::string> names;
  for (const std::string& folder : config_folders(kind)) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() != ".yaml") continue;
      if (entry.path().stem() == path_or_name) return entry.path();
      names.insert(entry.path().stem().string());
    }
  }
  throw Failure(fmt::format("{}: no such file, and no shipped one of that name in config/{} ({})",
                            path_or_name, kind, fmt::join(names, ", ")));
}

}  // namespace softarm::app
