// One case of the proof: drawn, measured, scaled, recorded, its truth apart from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace softarm::prove {

struct DrawOptions {
  std::string campaign, kind;
  int number = 0;
  std::uint64_t seed = 1;
  std::filesystem::path folder, truth;  ///< of the case; made whole or not at all
  unsigned jobs = 0;
};

/// @throws app::Failure where the campaign cannot be used, or no draw comes to the size asked for
void draw(const DrawOptions& options);

/// The trials of a case that was drawn and sealed, by what options.truth has of it: as they were, to the last
/// digits of the sizes to which its effects were scaled. Its truth stays as it is.
/// @throws app::Failure where there is no such truth
void draw_again(const DrawOptions& options);

/// The kinds of a campaign and how many cases of each make the sample and the whole, as JSON.
std::string kinds_json(const std::string& campaign);

}  // namespace softarm::prove
