// The results of a batch, gathered: one CSV and one page.
#pragma once

#include <string>
#include <vector>

#include "figures.h"
#include "job_folder.h"
#include "report/table_page.h"

namespace softarm::app::batch {

/// A line of the table.
struct TableRow {
  Job job;
  std::string name;
  std::string state;   ///< done, failed or open
  std::string reason;  ///< why it failed
  std::string page;    ///< relative to the batch's folder; empty: none
  std::string log;
  std::vector<Figure> figures;
  double seconds = 0.0, core_seconds = 0.0, peak_memory_bytes = 0.0;
};

/// A job's line as its folder is now.
TableRow row_of(const Job& job, const JobFolder& folder);

/// batch.csv: a line per job. It holds nothing of where and how fast jobs ran: every engine gives the same.
std::string to_csv(const std::vector<TableRow>& rows);

/// The page's content.
report::TablePage table_page(const std::string& work, const std::vector<TableRow>& rows,
                             const std::string& kicker);

}  // namespace softarm::app::batch
