// softarm: checks recordings, estimates over them, identifies arms, diagnoses what their descriptions leave
// out, imports recordings, simulates trials.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "softarm/command.h"

namespace {

/// One line, whatever a library's message holds.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Backbone, bending stiffness and payload of soft arms, from recordings.", "softarm"};
  program.set_version_flag("--version", std::string("softarm ") + SOFTARM_VERSION);
  program.require_subcommand(1);
  program.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("softarm: {} (softarm --help shows how)\n", one_line(error.what()));
  });
  program.footer("softarm COMMAND --help shows the command's options with examples.");
  softarm::app::add_campaign(program);
  softarm::app::add_check(program);
  softarm::app::add_diagnose(program);
  softarm::app::add_estimate(program);
  softarm::app::add_identify(program);
  softarm::app::add_import(program);
  softarm::app::add_new_arm(program);
  softarm::app::add_simulate(program);
  softarm::app::add_validate(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const softarm::app::Ended& end) {
    return end.status;
  } catch (const softarm::app::Failure& error) {
    fmt::print(stderr, "softarm: {}\n", one_line(error.what()));
    return error.status;
  } catch (const std::exception& error) {
    fmt::print(stderr, "softarm: {}\n", one_line(error.what()));
    return 1;
  }
  return 0;
}
