// Many random trials with something hidden in them: arms, sizes, protocols and distractors drawn from ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hidden.h"
#include "scenario.h"

namespace softarm::rig {

/// A closed range to draw from.
struct Span {
  double low = 0.0, high = 0.0;
};

/// An arm of a campaign: the scenario that describes it, and the arm file that a laboratory would have.
struct CampaignArm {
  std::string scenario;  ///< name of a shipped one, or a file
  std::string arm;       ///< the same
};

/// Which of an effect's functional forms are drawn.
enum class FormChoice {
  kAny,
  kDefault,  ///< the first
  kOther,    ///< not the first, where there are others
};

/// Sizes as they come: effects and background are scaled a few times towards a size that is drawn evenly in
/// its logarithm, and stay as they are then. Nothing is drawn again because it is small, or hard to see.
struct WishedSize {
  double least_noise = 0.2;  ///< effects leave from this share of the position noise on ...
  double most_m = 4e-3;      ///< ... to this
};

/// How large the effects of a case are made, by what they leave of themselves once the arm's constants are
/// fitted anew; absent: as drawn. Whoever records the campaign measures that and scales them.
struct SignalSpec {
  Span leftover_snr{12.0, 36.0};  ///< of each effect, in standard deviations of the noise
  double least_leftover_m = 0.0;  ///< rms over the bodies; of the two the larger
  double distractor_m = 2e-5;     ///< so much at most, all distractors together
  std::optional<Span>
      background_m;  ///< instead: so much do they leave, an arm of which nothing is quite right
  std::optional<WishedSize> wished;  ///< instead of leftover_snr, also for the background
  std::optional<double> raw_snr;     ///< compensated: this at least with the constants held ...
  double per_frame_sd = 3.0;         ///< ... and below this in a chi^2 test of fits frame by frame
};

/// A kind of cases of a campaign, and how many of them make a sample and the whole.
struct CampaignKind {
  std::string name;
  int sample = 0, full = 0;
};

/// The ranges. A case is one arm with one set of hidden effects, seen in several trials.
struct CampaignSpec {
  std::string name;
  std::vector<CampaignArm> arms;

  std::vector<double> effect_count_weights{0.0, 1.0};  ///< of no effect, one, two ...
  std::vector<std::string> effects;                    ///< ids to draw from, each at most once in a case
  FormChoice forms = FormChoice::kAny;
  std::vector<std::pair<std::string, std::string>> apart;  ///< never in one case
  std::optional<SignalSpec> signal;
  Span effect_size{0.0, 1.0};  ///< where in its usual range an effect's size lies, 0 its low end
  int most_distractors = 0;    ///< effects too small to matter: so many at most in a case
  int fewest_distractors = 0;
  std::vector<std::string> distractors;
  double distractor_size = 0.1;  ///< at most so much of the smallest usual size

  /// Relative standard deviations (log-normal) of the true arm's constants about the scenario's.
  double stiffness_spread = 0.0, gain_spread = 0.0, mass_spread = 0.0, length_spread = 0.0;

  int trials = 3;  ///< of a case; attitude and speed go round their lists, everything else is drawn
  std::vector<std::string> attitudes{"hanging"};
  std::vector<double> speeds{1.0};  ///< factor on the frequencies of random inputs
  Span seconds{30.0, 30.0};
  Span pause_s{0.0, 0.0};     ///< from the end of one trial to the beginning of the next
  Span payload_kg{0.0, 0.0};  ///< of a trial, known; put on after a quarter of it
  Span mocap_rate_hz{120.0, 120.0};
  Span position_sd_m{0.5e-3, 0.5e-3};
  Span orientation_sd_rad{0.01, 0.01};
  Span dropout_probability{0.0, 0.0};
  Span slow_position_sd_m{0.0, 0.0};  ///< of coloured noise, each body its own
  Span slow_correlation_s{1.0, 1.0};

  std::vector<CampaignKind> kinds;  ///< what the document has, whichever was chosen
};

/// One case: what is recorded, and what is sealed.
struct CampaignCase {
  std::size_t arm = 0;                ///< index into CampaignSpec::arms
  std::vector<HiddenChoice> effects;  ///< what is to be found
  std::vector<HiddenChoice> distractors;
  std::vector<Scenario> trials;
  std::vector<Scenario> plain;  ///< the same trials, nothing hidden in them but coloured noise
};

/// Parses a campaign, see config/campaigns/development.yaml for every key.
/// @param source name of the document for messages
/// @param kind one of the document's kinds, whose keys replace the document's; empty: none of them
/// @throws ScenarioError
CampaignSpec parse_campaign(const std::string& text, const std::string& source, const std::string& kind = "");

/// Draws case `number`; it depends on the seed, the number and the attempt alone.
/// @param arms the scenarios of CampaignSpec::arms, in its order
/// @param attempt another draw of the same case, for one that cannot be simulated
/// @throws std::invalid_argument, a line, if the arm takes none of the effects
CampaignCase draw_case(const CampaignSpec& spec, const std::vector<Scenario>& arms, std::uint64_t seed,
                       int number, int attempt = 0);

}  // namespace softarm::rig
