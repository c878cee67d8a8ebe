// softarm: checks recordings, estimates over them, identifies arms, diagnoses what their descriptions leave
// out, imports recordings, simulates trials.
#include <fmt/format.h>
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "arm/edit_distance.h"
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

/// What to say of a word that should be a command and is none; empty where all are.
std::string no_command(const CLI::App& program, const std::vector<std::string>& words, std::size_t from) {
  for (std::size_t i = from; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word[0] == '-') {
      const CLI::Option* option = program.get_option_no_throw(word.substr(0, word.find('=')));
      if (option != nullptr && option->get_items_expected_max() > 0 && word.find('=') == std::string::npos)
        ++i;
      continue;
    }
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands({})) {
      if (command->get_group().empty() && command->get_name() != word) continue;  // not for typing
      names.push_back(command->get_name());
      if (command->get_name() != word) continue;
      return command->get_require_subcommand_min() > 0 ? no_command(*command, words, i + 1) : "";
    }
    const auto near = softarm::arm::yaml::nearest_word(word, names);
    return fmt::format("no command '{}'; {} {}", word.substr(0, 60),
                       near ? fmt::format("did you mean '{}'? There are", *near) : "there are",
                       fmt::join(names, ", "));
  }
  return "";
}

/// What is written must have a name: an empty one would be that of a file beside it, or of this folder.
void refuse_empty_names(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands({})) {
    for (const char* name : {"--out", "--truth", "--json"}) {
      CLI::Option* option = command->get_option_no_throw(name);
      if (option == nullptr || option->get_items_expected_max() == 0) continue;
      option->check([](const std::string& word) {
        return word.empty() ? std::string("'' is not the name of a file or folder") : std::string();
      });
    }
  }
}

/// CLI11's ranges let through what is no number, and take less than nothing for very much.
void refuse_no_numbers(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands({})) {
    refuse_no_numbers(*command);
    for (CLI::Option* option : command->get_options()) {
      const std::string type = option->get_type_name();
      if (type.rfind("FLOAT", 0) == 0) {
        option->check([](const std::string& word) {
          try {
            if (!std::isfinite(std::stod(word))) return fmt::format("{} is no number", word);
          } catch (const std::exception&) {  // said where it is read
          }
          return std::string();
        });
      } else if (type.rfind("UINT", 0) == 0) {
        option->check([](const std::string& word) {
          return word.rfind('-', 0) == 0 ? fmt::format("{} must be 0 or more", word) : std::string();
        });
      }
    }
  }
}

/// @throws Failure where what was printed has not arrived
void flush_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout)
    throw softarm::app::Failure("the standard output cannot be written: the output is incomplete");
}

/// Text of `--help`, `--version` and of what was typed wrongly. @return exit status
int said(const CLI::App& program, const CLI::ParseError& error) {
  if (program.exit(error) != 0) return 2;
  try {
    flush_output();
  } catch (const softarm::app::Failure& failure) {
    fmt::print(stderr, "softarm: {}\n", one_line(failure.what()));
    return failure.status;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // what became of a fit is said by who asked for it
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
  softarm::app::add_batch(program);
  softarm::app::add_completion(program);
  refuse_empty_names(program);
  refuse_no_numbers(program);
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (const std::string why = no_command(program, words, 0); !why.empty())
      throw softarm::app::Failure(why, 2);
    program.parse(argc, argv);
    flush_output();
  } catch (const CLI::ParseError& error) {
    return said(program, error);
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
