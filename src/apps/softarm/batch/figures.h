// What of a job's results goes into the table of a batch.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "job_folder.h"

namespace softarm::app::batch {

/// One cell: a column of batch.csv (SI) and of the page.
struct Figure {
  std::string column;            ///< "held_out_rms_m"
  std::string heading;           ///< "error on unseen trials"
  std::optional<double> number;  ///< in the column's unit
  std::string text;              ///< where it is no number
  double scale = 1.0;            ///< from that unit to the one that is shown
  std::string unit = {};         ///< that is shown
};

/// The figures of a job that is done, out of what its command wrote.
/// @throws Failure if a result cannot be read
std::vector<Figure> figures_of(const Job& job, const JobFolder& folder);

/// Of the texts of summary.txt, report.json and findings.json.
std::vector<Figure> figures_of_estimate(const std::string& summary);
std::vector<Figure> figures_of_diagnosis(const std::string& json);
std::vector<Figure> figures_of_check(const std::string& json);

/// In one line for the terminal, as the job ends.
std::string headline(const std::vector<Figure>& figures);

/// The page or the file that a reader would open, relative to the job's folder; empty: none.
std::string page_of(const Job& job, const JobFolder& folder);

}  // namespace softarm::app::batch
