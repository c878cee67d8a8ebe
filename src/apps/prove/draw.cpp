#include "draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "displacement.h"
#include "math/parallel.h"
#include "rig/campaign.h"
#include "rig/effect_size.h"
#include "rig/simulator.h"
#include "rig/truth_yaml.h"
#include "signal.h"
#include "softarm/arm/arm_file.h"
#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/read_trials.h"
#include "softarm/record_trial.h"
#include "softarm/shipped.h"
#include "wished_size.h"

namespace softarm::prove {
namespace {

namespace fs = std::filesystem;
using app::Failure;
using Json = nlohmann::ordered_json;
using rig::HiddenChoice;

constexpr int kAttempts = 12;
constexpr int kScalings = 4;         // simulations until an effect has its size
constexpr double kFirstScale = 0.3;  // of a usual size: what is measured first is nearer to where it ends

rig::CampaignSpec campaign_of(const std::string& name, const std::string& kind) {
  const fs::path path = app::find_config("campaigns", name);
  return rig::parse_campaign(app::read_text(path), path.string(), kind);
}

/// Every kind has draws of its own: else the first case of each would be the same arm with the same effect.
std::uint64_t seed_of(const DrawOptions& options) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const char c : options.kind) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash ^ (options.seed * 0x9e3779b97f4a7c15ULL);
}

/// A case that cannot be made to what is asked for: drawn again.
struct NotThisOne : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Case {
 public:
  Case(const rig::CampaignSpec& spec, const DrawOptions& options, int attempt)
      : spec_(spec), options_(options), work_(options.folder.string() + ".partial") {
    std::vector<rig::Scenario> arms;
    for (const rig::CampaignArm& arm : spec.arms) {
      const fs::path scenario = app::find_config("scenarios", arm.scenario);
      arms.push_back(rig::parse_scenario(app::read_text(scenario), scenario.string()));
    }
    drawn_ = rig::draw_case(spec, arms, seed_of(options), options.number, attempt);
    arm_ = arm::load_arm_file(spec.arms[drawn_.arm].arm, app::config_folders("arms"));
    random_.seed(seed_of(options) * 1000003u + static_cast<std::uint64_t>(options.number) * 131u +
                 static_cast<std::uint64_t>(attempt));
    std::error_code ignored;
    fs::remove_all(work_, ignored);
    fs::create_directories(work_);
  }
  ~Case() {
    std::error_code ignored;
    fs::remove_all(work_, ignored);
  }
  Case(const Case&) = delete;
  Case& operator=(const Case&) = delete;

  void make() {
    for (HiddenChoice& choice : drawn_.effects)
      if (spec_.signal && !spec_.signal->raw_snr) choice = rig::scaled(choice, kFirstScale);
    const std::vector<trial::Trial> plain = recorded({}, "plain");
    reference_ = std::make_unique<Reference>(arm_, plain, options_.jobs);
    const Left nothing = reference_->residuals(plain);
    Left background = fit_distractors(nothing);
    std::vector<Signal> signals;
    for (HiddenChoice& choice : drawn_.effects) signals.push_back(fit_effect(choice, background));
    // Two are measured one by one, and recorded together. A single one has just been recorded.
    if (signals.size() != 1)
      signals_together(nothing, background);
    else
      all_ = signals.front();
    truth_["kind"] = options_.kind;
    truth_["arm"] = spec_.arms[drawn_.arm].arm;
    truth_["effects"] = Json::array();
    for (std::size_t i = 0; i < signals.size(); ++i)
      truth_["effects"].push_back(json_of(drawn_.effects[i], signals[i]));
    if (signals.size() == 2) truth_["cosine"] = reference_->cosine(signals[0], signals[1]);
    truth_["class"] = kinds_of_hidden();
    truth_["distractors"] = Json::array();
    for (const HiddenChoice& choice : drawn_.distractors) truth_["distractors"].push_back(json_of(choice));
    truth_["distractors_leave_m"] = distractors_leave_m_;
    truth_["noise_m"] = noise_m();
    if (spec_.signal && spec_.signal->wished && !signals.empty()) truth_["clear"] = are_clear(signals);
    truth_["all"] = json_of(all_);
    for (const Signal& one : signals) displacements_.push_back(rows_of(one.moved));
    say_ideal();
    truth_["constants"] = reference_->constants();
    truth_["mass_ratio"] = mass_ratio();
  }

  /// Draws of this case that did not do, and why.
  void say_rejected(const std::vector<std::string>& reasons) { truth_["rejected"] = reasons; }

  void keep() {
    const fs::path trials = work_ / "trials", sealed = work_ / "sealed";
    keep_trials(sealed);
    write(sealed / "case.json", truth_.dump(1) + '\n');
    write(sealed / "displacement.json", displacements_.dump() + '\n');
    fs::create_directories(fs::absolute(options_.truth).parent_path());
    fs::remove_all(options_.truth);
    fs::rename(sealed, options_.truth);
    fs::rename(trials, options_.folder);
  }

  /// Only the trials, of what is hidden as it was sealed: nothing is measured.
  void make_again(const Json& sealed) {
    drawn_.effects = choices_of(sealed.at("effects"));
    drawn_.distractors = choices_of(sealed.at("distractors"));
    simulated(drawn_.effects, "trials");
    keep_trials(work_ / "sealed");
    fs::remove_all(options_.folder);
    fs::rename(work_ / "trials", options_.folder);
  }

 private:
  /// Of those outside the catalogue the effects there whose words say them.
  Json kinds_of_hidden() const {
    Json kinds = Json::array();
    for (const HiddenChoice& choice : drawn_.effects)
      if (const std::string& kind = rig::find_hidden_effect(choice.effect)->of_the_kind; !kind.empty())
        kinds.push_back(kind);
    return kinds;
  }

  /// What a lone hidden effect is in the catalogue; empty: it is not there, or not alone.
  std::string hidden_alone() const {
    if (drawn_.effects.size() != 1) return {};
    const rig::HiddenEffect& effect = *rig::find_hidden_effect(drawn_.effects.front().effect);
    return effect.catalogued ? effect.id : effect.like;
  }

  /// How the catalogue acts against what is hidden, and what in it nobody can tell from that in these trials.
  void say_ideal() {
    truth_["ideal"] = Json::array();
    if (drawn_.effects.empty()) return;
    const std::string own = hidden_alone();
    const std::vector<Ideal> list = reference_->ideal(all_, own);
    for (const Ideal& ideal : list) {
      Json one{{"effect", ideal.effect}, {"explains", ideal.explains}, {"cosine", ideal.cosine}};
      if (!own.empty()) one["cosine_with_hidden"] = ideal.own_cosine;
      truth_["ideal"].push_back(std::move(one));
    }
    for (std::string& name : not_told_apart(list, own, all_.leftover_snr))
      truth_["class"].push_back(std::move(name));
  }

  /// The trials' folder gets what a laboratory knows of it; what is hidden in each goes to another.
  void keep_trials(const fs::path& sealed) {
    const fs::path trials = work_ / "trials";
    fs::create_directories(sealed);
    Json known{{"arm", spec_.arms[drawn_.arm].arm}, {"trials", Json::array()}};
    for (std::size_t i = 0; i < drawn_.plain.size(); ++i) {
      const std::string name = name_of(i);
      known["trials"].push_back(name + ".bag");
      fs::rename(trials / (name + ".truth.yaml"), sealed / (name + ".truth.yaml"));
    }
    write(trials / "case.json", known.dump(1) + '\n');
    fs::create_directories(fs::absolute(options_.folder).parent_path());
  }

  /// The rig's arm over what the arm file says of it: as far as it goes, no recording distinguishes that from
  /// payloads that are told wrong.
  double mass_ratio() const {
    double rig_kg = 0.0, file_kg = 0.0;
    for (const rig::SegmentSpec& segment : drawn_.plain.front().arm.segments) rig_kg += segment.mass_kg;
    for (const arm::Segment& segment : arm_.segments)
      file_kg += segment.mass_per_length_kg_m * segment.length_m;
    return rig_kg / file_kg;
  }

  /// Of the cameras' positions, per coordinate: root mean square of the trials.
  double noise_m() const {
    double sum = 0.0;
    for (const rig::Scenario& trial : drawn_.plain)
      sum += std::pow(trial.mocap.ring_noise.position_sd_m, 2) / static_cast<double>(drawn_.plain.size());
    return std::sqrt(sum);
  }

  bool are_clear(const std::vector<Signal>& signals) const {
    return std::all_of(signals.begin(), signals.end(),
                       [&](const Signal& one) { return is_clear(one, noise_m(), distractors_leave_m_); });
  }

  static std::string name_of(std::size_t i) { return fmt::format("trial_{:02}", i + 1); }

  static void write(const fs::path& path, const std::string& text) {
    app::OutputFile file(path);
    file.write(text);
    file.commit();
  }

  static Json json_of(const Signal& signal) {
    return {{"raw_snr", signal.raw_snr},
            {"leftover_snr", signal.leftover_snr},
            {"per_frame_snr", signal.per_frame_snr},
            {"per_frame_sd", signal.per_frame_sd},
            {"raw_m", signal.raw_m},
            {"leftover_m", signal.leftover_m}};
  }

  static Json json_of(const HiddenChoice& choice) {
    const rig::HiddenEffect& effect = *rig::find_hidden_effect(choice.effect);
    Json json{{"effect", choice.effect}, {"catalogued", effect.catalogued}};
    if (!effect.like.empty()) json["like"] = effect.like;
    if (!choice.form.empty()) json["form"] = choice.form;
    json["values"] = choice.values;
    return json;
  }

  static Json json_of(const HiddenChoice& choice, const Signal& signal) {
    Json json = json_of(choice);
    json["signal"] = json_of(signal);
    return json;
  }

  static std::vector<HiddenChoice> choices_of(const Json& sealed) {
    std::vector<HiddenChoice> choices;
    for (const Json& one : sealed)
      choices.push_back({one.at("effect"), one.value("form", std::string()),
                         one.at("values").get<std::map<std::string, double>>()});
    return choices;
  }

  /// Simulates all trials with these effects and the distractors as they are; @return paths of their bags
  std::vector<std::string> simulated(const std::vector<HiddenChoice>& effects, const std::string& folder) {
    const fs::path path = work_ / folder;
    fs::remove_all(path);
    fs::create_directories(path);
    std::vector<std::string> bags;
    for (std::size_t i = 0; i < drawn_.plain.size(); ++i)
      bags.push_back((path / (name_of(i) + ".bag")).string());
    const bool with_distractors = folder != "plain";
    math::in_parallel(drawn_.plain.size(), options_.jobs, [&](std::size_t i) {
      rig::Scenario scenario = drawn_.plain[i];
      try {
        for (const HiddenChoice& choice : effects) rig::hide(choice, scenario);
        if (with_distractors)
          for (const HiddenChoice& choice : drawn_.distractors) rig::hide(choice, scenario);
      } catch (const std::invalid_argument& error) {
        throw NotThisOne(error.what());
      }
      // No series of the truth: nothing is scored by it; the constants and the seed make it again.
      app::record_bag(scenario, bags[i], [](const rig::Sample&) {});
      if (folder == "trials") write(path / (name_of(i) + ".truth.yaml"), rig::truth_yaml(scenario));
    });
    return bags;
  }

  /// The same, and reads what was recorded.
  std::vector<trial::Trial> recorded(const std::vector<HiddenChoice>& effects, const std::string& folder) {
    const std::vector<std::string> bags = simulated(effects, folder);
    std::vector<trial::Trial> trials = app::read_trials(bags, arm_, true, options_.jobs);
    if (folder != "trials") fs::remove_all(work_ / folder);
    return trials;
  }

  /// Scales the distractors until they are below what may be, or as large as asked for; @return the residuals
  /// with them.
  Left fit_distractors(const Left& nothing) {
    if (drawn_.distractors.empty()) return nothing;
    const rig::SignalSpec spec = spec_.signal.value_or(rig::SignalSpec());
    double most_m = spec.distractor_m, least_m = 0.0, wanted_m = 0.7 * most_m;
    if (spec.background_m) {
      least_m = spec.background_m->low;
      most_m = spec.background_m->high;
      wanted_m = least_m * std::pow(most_m / least_m, std::uniform_real_distribution<double>()(random_));
    }
    if (spec.wished) {
      std::vector<HiddenChoice*> all;
      for (HiddenChoice& choice : drawn_.distractors) all.push_back(&choice);
      Measured found = towards(wanted_m, all, [&] {
        Measured now{reference_->residuals(recorded({}, "background")), {}};
        now.signal = reference_->signal(now.left, nothing);
        return now;
      });
      distractors_leave_m_ = found.signal.leftover_m;
      return std::move(found.left);
    }
    for (int n = 0; n <= kScalings; ++n) {
      Left with = reference_->residuals(recorded({}, "background"));
      distractors_leave_m_ = reference_->signal(with, nothing).leftover_m;
      if (distractors_leave_m_ >= least_m && distractors_leave_m_ <= most_m) return with;
      for (HiddenChoice& choice : drawn_.distractors)
        choice = rig::scaled(choice, std::clamp(wanted_m / distractors_leave_m_, 0.02, 30.0));
    }
    throw NotThisOne("the distractors do not come to their size");
  }

  struct Measured {
    Left left;
    Signal signal;
  };
  /// Scales effects together towards a size; what they have come to after that, they stay.
  /// @param measure simulates them as they are
  Measured towards(double wished_m, const std::vector<HiddenChoice*>& choices,
                   const std::function<Measured()>& measure) const {
    Measured now = measure();
    for (int n = 0; n < kScalings; ++n) {
      const double factor = factor_towards(wished_m, spec_.signal->wished->most_m, now.signal);
      if (factor == 1.0) break;
      bool changed = false;
      std::vector<HiddenChoice> before;
      for (HiddenChoice* choice : choices) {
        before.push_back(*choice);
        *choice = rig::scaled(*choice, factor);
        changed = changed || choice->values != before.back().values;
      }
      if (!changed) break;
      try {
        now = measure();
      } catch (const rig::SimulationError&) {  // so large it cannot be
        for (std::size_t i = 0; i < choices.size(); ++i) *choices[i] = before[i];
        return measure();
      }
    }
    return now;
  }

  void signals_together(const Left& nothing, const Left& background) {
    const Left whole = reference_->residuals(recorded(drawn_.effects, "trials"));
    all_ = reference_->signal(whole, drawn_.effects.empty() ? nothing : background);
  }

  /// Scales an effect until it is as large as the campaign asks for.
  Signal fit_effect(HiddenChoice& choice, const Left& background) {
    std::optional<double> wanted;
    const double place = std::uniform_real_distribution<double>()(random_);
    const auto measured = [&] {
      return reference_->signal(
          reference_->residuals(recorded({choice}, drawn_.effects.size() == 1 ? "trials" : "trial")),
          background);
    };
    if (spec_.signal && spec_.signal->wished) {
      const double least_m = spec_.signal->wished->least_noise * noise_m();
      const double wished_m = least_m * std::pow(spec_.signal->wished->most_m / least_m, place);
      return towards(wished_m, {&choice}, [&] { return Measured{{}, measured()}; }).signal;
    }
    Signal signal;
    for (int n = 0; n <= kScalings; ++n) {
      signal = measured();
      if (!spec_.signal) return signal;
      const rig::SignalSpec& s = *spec_.signal;
      if (s.raw_snr) {
        if (signal.raw_snr < *s.raw_snr) throw NotThisOne(fmt::format("{} is too small", choice.effect));
        if (signal.per_frame_sd < s.per_frame_sd) return signal;
        choice = rig::scaled(choice, std::sqrt(0.6 * s.per_frame_sd / signal.per_frame_sd));
        continue;
      }
      if (!(signal.leftover_snr > 0.0)) throw NotThisOne(fmt::format("{} leaves nothing", choice.effect));
      const double least_snr = s.least_leftover_m * signal.leftover_snr / signal.leftover_m;
      const double raised = std::max(1.0, least_snr / s.leftover_snr.low);
      const double low = raised * s.leftover_snr.low, high = raised * s.leftover_snr.high;
      if (!wanted) wanted = low * std::pow(high / low, place);
      if (signal.leftover_snr >= 0.999 * low && signal.leftover_snr <= 1.05 * high) return signal;
      const double target = std::clamp(*wanted, 1.03 * low, high);
      const HiddenChoice before = choice;
      choice = rig::scaled(choice, std::clamp(target / signal.leftover_snr, 0.02, 30.0));
      if (choice.values == before.values)
        throw NotThisOne(fmt::format("{} cannot be so large", choice.effect));
    }
    throw NotThisOne(fmt::format("{} does not come to its size: {:.3g}", choice.effect, signal.leftover_snr));
  }

  const rig::CampaignSpec& spec_;
  const DrawOptions& options_;
  const fs::path work_;
  arm::Arm arm_;
  rig::CampaignCase drawn_;
  std::mt19937_64 random_;
  std::unique_ptr<Reference> reference_;
  double distractors_leave_m_ = 0.0;
  Signal all_;  ///< of the effects together, beside the distractors; of these where there are none
  Json truth_, displacements_ = Json::array();  ///< the latter by effect, see rows_of()
};

}  // namespace

std::string kinds_json(const std::string& campaign) {
  Json list = Json::array();
  for (const rig::CampaignKind& kind : campaign_of(campaign, "").kinds)
    list.push_back({{"kind", kind.name}, {"sample", kind.sample}, {"full", kind.full}});
  return list.dump();
}

void draw(const DrawOptions& options) {
  const rig::CampaignSpec spec = campaign_of(options.campaign, options.kind);
  std::vector<std::string> rejected;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    try {
      Case one(spec, options, attempt);
      one.make();
      one.say_rejected(rejected);
      one.keep();
      return;
    } catch (const NotThisOne& error) {
      rejected.emplace_back(error.what());
    } catch (const rig::SimulationError& error) {
      rejected.emplace_back(error.what());
    } catch (const std::invalid_argument& error) {
      rejected.emplace_back(error.what());
    }
  }
  for (const std::string& reason : rejected) fmt::print(stderr, "{}\n", reason);  // kept by scripts/prove
  throw Failure(fmt::format("{}, kind {}, case {}: {} draws do not do, the last: {}", options.campaign,
                            options.kind, options.number, kAttempts, rejected.back()));
}

void draw_again(const DrawOptions& options) {
  const fs::path path = options.truth / "case.json";
  const rig::CampaignSpec spec = campaign_of(options.campaign, options.kind);
  try {
    const Json sealed = Json::parse(app::read_text(path));
    Case(spec, options, static_cast<int>(sealed.at("rejected").size())).make_again(sealed);
  } catch (const Json::exception& error) {
    throw Failure(fmt::format("{}: not the truth of a case: {}", path.string(), error.what()));
  }
}

}  // namespace softarm::prove
