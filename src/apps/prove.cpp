// What scripts/prove runs beside `softarm diagnose`: draws and seals the cases, and lets the baselines decide
// them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "prove/deciders.h"
#include "prove/draw.h"
#include "softarm/arm/arm_file.h"
#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/read_trials.h"
#include "softarm/shipped.h"

namespace softarm::prove {
namespace {

struct DecideOptions {
  std::string arm, out;
  std::vector<std::string> bags;
  unsigned jobs = 0;
};

void write_decisions(const DecideOptions& options) {
  const arm::Arm arm = arm::load_arm_file(options.arm, app::config_folders("arms"));
  nlohmann::ordered_json json;
  for (const Decision& decision :
       decide(arm, app::read_trials(options.bags, arm, true, options.jobs), options.jobs)) {
    nlohmann::ordered_json& item = json[decision.method];
    item = {{"alarm", decision.alarm}, {"effects", nlohmann::json::array()}, {"ranking", decision.ranking}};
    for (const Named& named : decision.effects) {
      item["effects"].push_back({{"name", named.effect}});
      if (named.probability) item["effects"].back()["probability"] = *named.probability;
    }
  }
  app::OutputFile file(options.out);
  file.write(json.dump(1) + "\n");
  file.commit();
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
  draws->callback([&] { prove::draw(draw); });

  std::string campaign;
  CLI::App* kinds = program.add_subcommand("kinds", "The kinds of a campaign, as JSON.");
  kinds->add_option("CAMPAIGN", campaign)->required();
  kinds->callback([&] { fmt::print("{}\n", prove::kinds_json(campaign)); });

  prove::DecideOptions decide;
  CLI::App* decides = program.add_subcommand("decide", "What the baselines make of the trials of one case.");
  decides->add_option("--arm", decide.arm, "arm file, or the name of one in config/arms")->required();
  decides->add_option("--out", decide.out, "JSON to write")->required();
  decides->add_option("BAG", decide.bags, "trial bags")->required();
  decides->add_option("--jobs", decide.jobs, "threads; default: one per core");
  decides->callback([&] { prove::write_decisions(decide); });

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
