// What report.html is made of, wherever this program finds it.
#pragma once

#include <string>

#include "softarm/report/report.h"

namespace softarm::app {

struct ReportPage {
  report::PageFiles files;
  std::string warning;  ///< one line where the plotting library is missing; else empty
};

/// The page's files as they ship, and the plotting library: packed by the build, or as the system has it.
/// @throws Failure if they were not installed
ReportPage find_report_page();

}  // namespace softarm::app
