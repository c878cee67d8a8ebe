// What report.html is made of, wherever it is found.
#pragma once

#include <string>
#include <vector>

#include "softarm/report/report.h"

namespace softarm::report {

struct FoundPage {
  PageFiles files;
  std::string warning;  ///< one line where the plotting library is missing; else empty
};

/// The page's files as they ship, and the plotting library: packed by the build, or as the system has it.
/// @param folders config/report, installed and in the checkout
/// @throws std::runtime_error if they were not installed
FoundPage find_page(const std::vector<std::string>& folders);

}  // namespace softarm::report
