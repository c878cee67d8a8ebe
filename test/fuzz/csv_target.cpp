#include <string>
#include <vector>

#include "scratch_file.h"
#include "targets.h"
#include "trial/csv_layout.h"
#include "trial/csv_recording.h"
#include "trial/layout_guess.h"

namespace softarm::fuzz {
namespace {

std::vector<std::string> parts_of(const std::string& text) {
  const std::string kMark = "\n---\n";
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t at = text.find(kMark); at != std::string::npos && parts.size() < 2;
       at = text.find(kMark, from)) {
    parts.push_back(text.substr(from, at + 1 - from));
    from = at + kMark.size();
  }
  parts.push_back(text.substr(from));
  return parts;
}

}  // namespace

void csv(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> parts = parts_of(std::string(reinterpret_cast<const char*>(data), size));
  if (parts.size() < 2) return;
  const ScratchFile recording("recording.csv", parts[1].data(), parts[1].size());
  try {
    const trial::CsvLayout layout = trial::parse_csv_layout(parts[0], "layout.yaml");
    trial::CsvSources sources;
    const std::string joined = parts.size() > 2 ? parts[2] : "";
    const ScratchFile inputs("inputs.csv", joined.data(), joined.size());
    if (parts.size() > 2) sources.inputs_path = inputs.path();
    trial::read_csv_recording(
        layout, recording.path(), [](const trial::CsvRow&) {}, sources);
  } catch (const trial::CsvError&) {
  }
  try {
    trial::guess_layout(recording.path());
  } catch (const trial::CsvError&) {
  }
}

}  // namespace softarm::fuzz
