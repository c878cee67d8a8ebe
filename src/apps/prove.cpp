// What scripts/prove runs beside `softarm diagnose`: draws and seals the cases, and lets the baselines decide
// them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "prove/deciders.h"
#include "prove/displacement.h"
#include "prove/draw.h"
#include "prove/signal.h"
#include "softarm/arm/arm_file.h"
#include "softarm/command.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/output_file.h"
#include "softarm/read_trials.h"
#include "softarm/shipped.h"

namespace softarm::prove {
namespace {

struct DecideOptions {
  std::string arm, out;
  std::vector<std::string> bags, held, tied;
  unsigned jobs = 0;
};

struct CompareOptions {
  std::string arm, changed_arm, out;
  std::vector<std::string> plain, changed, held, tied;
  unsigned jobs = 0;
};

void write_decisions(const DecideOptions& options) {
  const arm::Arm arm = arm::load_arm_file(options.arm, app::config_folders("arms"));
  nlohmann::ordered_json json;
  for (const Decision& decision : decide(arm, app::read_trials(options.bags, arm, true, options.jobs),
                                         options.jobs, options.held, options.tied)) {
    nlohmann::ordered_json& item = json[decision.method];
    item = {{"alarm", decision.alarm}, {"effects", nlohmann::json::array()}, {"ranking", decision.ranking}};
    for (const Named& named : decision.effects)
      item["effects"].push_back({{"name", named.effect},
                                 {"probability", named.probability},
                                 {"confusable_with", named.confusable_with}});
  }
  app::OutputFile file(options.out);
  file.write(json.dump(1) + "\n");
  file.commit();
}

/// What recordings that were tampered with differ in from the same untouched, beyond the arm's free
/// constants, and the effects of the catalogue that act like it: their signatures against the difference.
void write_comparison(const CompareOptions& options) {
  if (options.plain.size() != options.changed.size())
    throw app::Failure("--plain and --changed: as many bags of the one as of the other");
  const auto load = [](const std::string& name) {
    return arm::load_arm_file(name, app::config_folders("arms"));
  };
  const arm::Arm arm = load(options.arm);
  const arm::Arm changed = options.changed_arm.empty() ? arm : load(options.changed_arm);
  const std::vector<trial::Trial> plain = app::read_trials(options.plain, arm, true, options.jobs);
  Reference reference(arm, plain, options.jobs, options.held, options.tied);
  const Left without = reference.residuals(plain);
  const Left with =
      reference.residuals(changed, app::read_trials(options.changed, changed, true, options.jobs));
  const Signal signal = reference.signal(with, without);
  nlohmann::ordered_json json{{"raw_snr", signal.raw_snr},
                              {"leftover_snr", signal.leftover_snr},
                              {"raw_m", signal.raw_m},
                              {"leftover_m", signal.leftover_m},
                              {"unexplained_m", reference.unexplained_m()}};
  json["ideal"] = nlohmann::json::array();
  for (const Ideal& ideal : reference.ideal(signal))
    json["ideal"].push_back(
        {{"effect", ideal.effect}, {"explains", ideal.explains}, {"cosine", ideal.cosine}});
  json["constants"] = reference.constants();
  json["displacement"] = rows_of(signal.moved);
  app::OutputFile file(options.out);
  file.write(json.dump(1) + "\n");
  file.commit();
}

/// By how much each effect of an arm file moves the bodies of the trials.
void write_displacements(const DecideOptions& options) {
  const std::vector<std::string> folders = app::config_folders("arms");
  const arm::Arm arm = arm::load_arm_file(options.arm, folders);
  const std::vector<model::Present> effects = effects::load_effects(arm, options.arm, folders);
  nlohmann::ordered_json json = nlohmann::json::array();
  for (const Displacement& one :
       displacements(arm, effects, app::read_trials(options.bags, arm, true, options.jobs), options.jobs)) {
    json.push_back({{"effect", one.effect}, {"trials", rows_of(one.by)}});
    if (one.relative_sd) json.back()["relative_sd"] = *one.relative_sd;
  }
  app::OutputFile file(options.out);
  file.write(json.dump() + "\n");
  file.commit();
}

void add_held_and_tied(CLI::App& command, std::vector<std::string>& held, std::vector<std::string>& tied) {
  const auto list = [&](const char* name, std::vector<std::string>& values) {
    command.add_option(name, values, "constants, as in softarm diagnose")
        ->delimiter(',')
        ->allow_extra_args(false);
  };
  list("--hold", held);
  list("--tie", tied);
}

/// A command on the trials of one case.
CLI::App* add_of_trials(CLI::App& program, DecideOptions& options, const char* name, const char* words) {
  CLI::App* command = program.add_subcommand(name, words);
  command->add_option("--arm", options.arm, "arm file, or the name of one in config/arms")->required();
  command->add_option("--out", options.out, "JSON to write")->required();
  command->add_option("BAG", options.bags, "trial bags")->required();
  command->add_option("--jobs", options.jobs, "threads; default: one per core");
  return command;
}

}  // namespace
}  // namespace softarm::prove

int main(int argc, char** argv) {
  using namespace softarm;
  CLI::App program{
      "Cases of the proof of `softarm diagnose`, and baselines that decide them; see scripts/prove.",
      "prove"};
  program.require_subcommand(1);

  prove::DrawOptions draw;
  CLI::App* draws = program.add_subcommand("draw", "Draw, measure, scale and record one case.");
  draws->add_option("--campaign", draw.campaign, "campaign file, or the name of one in config/campaigns")
      ->required();
  draws->add_option("--kind", draw.kind, "one of its kinds")->required();
  draws->add_option("--number", draw.number, "of the case within its kind")->check(CLI::Range(0, 1000000));
  draws->add_option("--seed", draw.seed, "of all draws");
  draws->add_option("--case", draw.folder, "folder for what a laboratory would have")->required();
  draws->add_option("--truth", draw.truth, "folder for what is hidden")->required();
  draws->add_option("--jobs", draw.jobs, "threads; default: one per core");
  bool again = false;
  draws->add_flag("--again", again, "only the trials of a case that was drawn before, by its truth");
  draws->callback([&] { again ? prove::draw_again(draw) : prove::draw(draw); });

  std::string campaign;
  CLI::App* kinds = program.add_subcommand("kinds", "The kinds of a campaign, as JSON.");
  kinds->add_option("CAMPAIGN", campaign)->required();
  kinds->callback([&] { fmt::print("{}\n", prove::kinds_json(campaign)); });

  prove::DecideOptions decide;
  CLI::App* decides = prove::add_of_trials(program, decide, "decide", "What the baselines make of one case.");
  prove::add_held_and_tied(*decides, decide.held, decide.tied);
  decides->callback([&] { prove::write_decisions(decide); });

  prove::DecideOptions displace;
  prove::add_of_trials(
      program, displace, "displacement",
      "By how much each effect of an arm file, as softarm diagnose writes it, moves the bodies.")
      ->callback([&] { prove::write_displacements(displace); });

  prove::CompareOptions compare;
  CLI::App* compares = program.add_subcommand(
      "compare", "What changed recordings differ in from the same untouched, and which effects act like it.");
  compares->add_option("--arm", compare.arm, "arm file of the untouched ones")->required();
  compares->add_option("--changed-arm", compare.changed_arm, "arm file of the others; default: the same");
  compares->add_option("--plain", compare.plain, "untouched bags")->required();
  compares->add_option("--changed", compare.changed, "changed bags, in the same order")->required();
  compares->add_option("--out", compare.out, "JSON to write")->required();
  compares->add_option("--jobs", compare.jobs, "threads; default: one per core");
  prove::add_held_and_tied(*compares, compare.held, compare.tied);
  compares->callback([&] { prove::write_comparison(compare); });

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "prove: {}\n", error.what());
    return 1;
  }
  return 0;
}
