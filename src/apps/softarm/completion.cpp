// softarm completion: what a shell needs to complete commands, options and names, made of the command line's
// own description.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <boost/algorithm/string.hpp>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "command.h"
#include "shipped.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCompletionExamples = R"text(Examples:
  eval "$(scripts/softarm completion bash)"       in ~/.bashrc, with the path of the checkout
  scripts/softarm completion bash > ~/.local/share/bash-completion/completions/softarm
  scripts/softarm completion zsh > ~/.zfunc/_softarm       a folder of $fpath, before compinit
It completes softarm and scripts/softarm; rosrun completes for itself.)text";

/// One option, or what stands without one.
struct Completed {
  std::vector<std::string> names;  ///< with their dashes; empty: positional
  bool has_value = false;
  std::vector<std::string> words;  ///< what the value may be, beside a file
  bool only_words = false;
  std::string meaning;
};

/// Names in a folder of config/.
std::vector<std::string> shipped_names(const std::string& kind) {
  std::set<std::string> names;
  std::error_code error;
  for (const std::string& folder : config_folders(kind))
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  return {names.begin(), names.end()};
}

/// Members of a set, as CLI11 writes its type: TEXT:{on,off}.
std::vector<std::string> members_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  std::vector<std::string> words;
  if (begin != std::string::npos && end != std::string::npos && end > begin + 1)
    boost::split(words, type.substr(begin + 1, end - begin - 1), [](char c) { return c == ','; });
  return words;
}

std::string folder_of(const std::string& name) {
  if (name == "--arm") return "arms";
  if (name == "SCENARIO") return "scenarios";
  if (name == "LAYOUT") return "layouts";
  return name == "CAMPAIGN" ? "campaigns" : "";
}

Completed completed(const CLI::Option& option) {
  Completed one;
  for (const std::string& name : option.get_snames()) one.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) one.names.push_back("--" + name);
  one.has_value = option.get_items_expected_max() > 0;
  one.words = members_of(option);
  one.only_words = !one.words.empty();
  const std::string folder = folder_of(one.names.empty() ? option.get_name() : one.names.back());
  if (!folder.empty()) one.words = shipped_names(folder);
  one.meaning = option.get_description();
  return one;
}

/// Of a command, with those of the commands that come behind it.
std::vector<Completed> completed(const CLI::App& command) {
  std::vector<Completed> all;
  std::set<std::vector<std::string>> known;
  const auto add = [&](const CLI::App& of) {
    for (const CLI::Option* option : of.get_options())
      if (Completed one = completed(*option); one.names.empty() || known.insert(one.names).second)
        all.push_back(std::move(one));
  };
  add(command);
  Completed commands;
  for (const CLI::App* next : command.get_subcommands({})) {
    if (next->get_group().empty()) continue;  // not for typing
    commands.words.push_back(next->get_name());
    add(*next);
  }
  if (!commands.words.empty()) all.push_back(commands);
  return all;
}

std::string bash_case(const CLI::App& command) {
  std::string options, positional, values;
  for (const Completed& one : completed(command)) {
    if (one.names.empty()) positional += fmt::format(" {}", fmt::join(one.words, " "));
    if (!one.names.empty()) options += fmt::format(" {}", fmt::join(one.names, " "));
    if (one.names.empty() || !one.has_value) continue;
    values += fmt::format("        {}) words='{}' files={};;\n", fmt::join(one.names, "|"),
                          fmt::join(one.words, " "), one.only_words ? "" : "yes");
  }
  boost::trim(options);
  boost::trim(positional);
  return fmt::format(
      "    {}) options='{}' words='{}'\n      case $previous in\n{}        *) value=;;\n      esac;;\n",
      command.get_name(), options, positional, values);
}

std::string bash_script(const CLI::App& program) {
  std::vector<std::string> names;
  std::string cases, top;
  for (const CLI::App* command : program.get_subcommands({})) {
    names.push_back(command->get_name());
    cases += bash_case(*command);
  }
  for (const CLI::Option* option : program.get_options())
    top += fmt::format(" {}", fmt::join(completed(*option).names, " "));
  return fmt::format(R"(# bash completion of softarm; made by `softarm completion bash`
_softarm() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local options= words= files=yes value=yes before= IFS=$' \t\n'
  COMPREPLY=()
  if [[ $current == --*=* ]]; then  # --option=value, where = is none of COMP_WORDBREAKS
    previous=${{current%%=*}} before=${{current%%=*}}= current=${{current#*=}}
  elif [ "$current" = = ]; then
    current=
  elif [ "$previous" = = ]; then
    previous=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W '{0}{1}' -- "$current"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{2}    *) return;;
  esac
  if [ -z "$value" ] && [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
    return
  fi
  COMPREPLY=($(compgen -P "$before" -W "$words" -- "$current"))
  if [ -n "$files" ]; then
    compopt -o filenames 2>/dev/null
    IFS=$'\n'
    COMPREPLY+=($(compgen -P "$before" -f -- "$current"))
  fi
}}
complete -F _softarm softarm
)",
                     fmt::join(names, " "), top, cases);
}

/// Within single quotes and the brackets or colons of _arguments.
std::string zsh_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'') {
      safe += "'\\''";
    } else {
      if (c == '[' || c == ']' || c == ':' || c == '\\') safe += '\\';
      safe += c == '\n' ? ' ' : c;
    }
  }
  return safe;
}

std::string zsh_action(const Completed& one) {
  if (one.only_words) return fmt::format("({})", fmt::join(one.words, " "));
  if (one.words.empty()) return "_files";
  // A colon would end the action.
  return fmt::format("{{_alternative \"names\\:name\\:({})\" \"files\\:file\\:_files\"}}",
                     fmt::join(one.words, " "));
}

std::string zsh_case(const CLI::App& command) {
  std::string text = fmt::format("      {})\n        _arguments \\\n", command.get_name());
  std::string positional = "'*:file:_files'";
  for (const Completed& one : completed(command)) {
    if (one.names.empty()) {
      if (!one.words.empty()) positional = fmt::format("'1:name:{}' '*:file:_files'", zsh_action(one));
      continue;
    }
    for (const std::string& name : one.names)  // "=": the value may stand behind one, too
      text += fmt::format("          '*{}{}[{}]{}' \\\n", name,
                          one.has_value && name.rfind("--", 0) == 0 ? "=" : "", zsh_text(one.meaning),
                          one.has_value ? ":value:" + zsh_action(one) : "");
  }
  return text + "          " + positional + ";;\n";
}

std::string zsh_script(const CLI::App& program) {
  std::string commands, cases;
  for (const CLI::App* command : program.get_subcommands({})) {
    commands += fmt::format("    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    cases += zsh_case(*command);
  }
  return fmt::format(R"(#compdef softarm
# zsh completion of softarm; made by `softarm completion zsh`
_softarm() {{
  local curcontext=$curcontext state line
  local -a commands
  commands=(
{0}  )
  _arguments -C '--help[how it is used]' '--version[its version]' '1:command:->command' '*::argument:->argument'
  case $state in
    command) _describe command commands;;
    argument)
      case $line[1] in
{1}      esac;;
  esac
}}
if [ "$funcstack[1]" = _softarm ]; then _softarm "$@"; else compdef _softarm softarm; fi
)",
                     commands, cases);
}

}  // namespace

void add_completion(CLI::App& program) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      program.add_subcommand("completion", "Print what makes a shell complete this program's command line.");
  command->add_option("SHELL", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(kCompletionExamples);
  command->callback(
      [shell, &program] { fmt::print("{}", *shell == "bash" ? bash_script(program) : zsh_script(program)); });
}

}  // namespace softarm::app
