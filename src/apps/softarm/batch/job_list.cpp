#include "job_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glob.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

#include "../command.h"
#include "../output_file.h"
#include "arm/edit_distance.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

/// One entry: what is said of a job, or of the jobs of several bags.
struct Entry {
  std::string place;   ///< for messages: "trials.yaml:4"
  std::string folder;  ///< what its paths are relative to
  std::string arm;
  std::string name;
  std::vector<Word> options;
  std::vector<std::string> bags;  ///< bags, folders and patterns
};

bool is_pattern(const std::string& text) {
  return text.find_first_of("*?[") != std::string::npos;
}

std::string absolute(const std::string& path, const std::string& folder) {
  return (fs::path(folder) / path).lexically_normal().string();
}

bool ends_with_one_of(const std::string& path, std::initializer_list<const char*> ends) {
  const std::string end = fs::path(path).extension().string();
  return std::any_of(ends.begin(), ends.end(), [&](const char* one) { return end == one; });
}

std::vector<std::string> matches(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> paths;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  return paths;
}

/// The bags in a folder and in those below it, sorted.
std::vector<std::string> bags_below(const std::string& folder, const std::string& place) {
  std::vector<std::string> bags;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.front() != '.' && entry->path().extension() == ".bag" && entry->is_regular_file())
      bags.push_back(entry->path().lexically_normal().string());
  }
  if (error) throw Failure(fmt::format("{}{}: cannot be read: {}", place, folder, error.message()), 2);
  if (bags.empty()) throw Failure(fmt::format("{}{}: there is no .bag in this folder", place, folder), 2);
  std::sort(bags.begin(), bags.end());
  return bags;
}

/// A bag, a folder or a pattern to bags.
std::vector<std::string> bags_of(const std::string& input, const std::string& folder,
                                 const std::string& place) {
  const std::string path = absolute(input, folder);
  std::error_code error;
  if (fs::is_directory(path, error)) return bags_below(path, place);
  if (fs::is_regular_file(path, error)) return {path};
  if (!is_pattern(input)) throw Failure(fmt::format("{}{}: no such bag or folder", place, input), 2);
  std::vector<std::string> bags;
  for (const std::string& match : matches(path)) {
    if (fs::is_directory(match, error)) {
      const std::vector<std::string> below = bags_below(match, place);
      bags.insert(bags.end(), below.begin(), below.end());
    } else {
      bags.push_back(fs::path(match).lexically_normal().string());
    }
  }
  if (bags.empty()) throw Failure(fmt::format("{}{}: nothing matches", place, input), 2);
  return bags;
}

std::vector<Entry> entries_of_text(const std::string& path, const JobListRequest& request) {
  std::vector<Entry> entries;
  std::istringstream text(read_text(path));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    Entry entry;
    entry.place = fmt::format("{}:{}: ", path, number);
    entry.folder = fs::absolute(path).parent_path().string();
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::vector<std::string> words = shell_words(line, entry.place);
    if (words.empty()) continue;
    std::map<std::string, bool> known = request.has_value;
    known["--arm"] = true;
    for (const Word& option : take_options(words, known, entry.place, entry.bags)) {
      if (option.name == "--arm")
        entry.arm = *option.value;
      else
        entry.options.push_back(option);
    }
    if (entry.bags.empty()) throw Failure(entry.place + "names no bag", 2);
    entries.push_back(entry);
  }
  return entries;
}

/// A text, or a list of texts, of a YAML list.
std::vector<std::string> texts(const YAML::Node& node, const std::string& place, const char* key) {
  std::vector<std::string> all;
  if (node.IsScalar()) all.push_back(node.Scalar());
  for (const YAML::Node& one : node) {
    if (!node.IsSequence() || !one.IsScalar()) break;
    all.push_back(one.Scalar());
  }
  if (all.empty() || (node.IsSequence() && all.size() != node.size()))
    throw Failure(fmt::format("{}key '{}': must be a text or a list of texts", place, key), 2);
  return all;
}

void refuse_other_keys(const YAML::Node& map, const std::vector<std::string>& keys,
                       const std::string& place) {
  for (const auto& pair : map) {
    const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : "?";
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const auto near = arm::yaml::nearest_word(key, keys);
    throw Failure(fmt::format("{}unknown key '{}'{}; there are {}", place, key,
                              near ? fmt::format(", did you mean '{}'?", *near) : "", fmt::join(keys, ", ")),
                  2);
  }
}

std::vector<Word> yaml_options(const YAML::Node& node, const JobListRequest& request,
                               const std::string& place) {
  std::vector<std::string> words, others;
  for (const std::string& text : texts(node, place, "options")) {
    if (node.IsSequence()) {
      words.push_back(text);
    } else {
      words = shell_words(text, place);
    }
  }
  const std::vector<Word> options = take_options(words, request.has_value, place, others);
  if (!others.empty())
    throw Failure(fmt::format("{}key 'options': '{}' is no option", place, others.front()), 2);
  return options;
}

/// Options of `more` take the place of those of the same name.
std::vector<Word> merged(std::vector<Word> options, const std::vector<Word>& more) {
  options.erase(std::remove_if(options.begin(), options.end(),
                               [&](const Word& old) {
                                 return std::any_of(more.begin(), more.end(),
                                                    [&](const Word& one) { return one.name == old.name; });
                               }),
                options.end());
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

Entry entry_of_yaml(const YAML::Node& node, const Entry& defaults, const std::string& path,
                    const JobListRequest& request) {
  Entry entry = defaults;
  entry.place = fmt::format("{}:{}: ", path, node.Mark().line + 1);
  if (!node.IsMap()) {
    entry.bags = texts(node, entry.place, "jobs");
    return entry;
  }
  refuse_other_keys(node, {"arm", "bags", "name", "options"}, entry.place);
  if (!node["bags"]) throw Failure(entry.place + "key 'bags' is missing", 2);
  entry.bags = texts(node["bags"], entry.place, "bags");
  if (node["arm"]) entry.arm = texts(node["arm"], entry.place, "arm").front();
  if (node["name"]) entry.name = texts(node["name"], entry.place, "name").front();
  if (node["options"])
    entry.options = merged(entry.options, yaml_options(node["options"], request, entry.place));
  return entry;
}

std::vector<Entry> entries_of_yaml(const std::string& path, const JobListRequest& request) {
  YAML::Node document;
  try {
    document = YAML::Load(read_text(path));
  } catch (const YAML::Exception& error) {
    throw Failure(fmt::format("{}:{}: {}", path, error.mark.line + 1, error.msg), 2);
  }
  const std::string place = path + ": ";
  if (!document.IsMap()) throw Failure(place + "a list of jobs has the key 'jobs' (softarm batch --help)", 2);
  refuse_other_keys(document, {"arm", "jobs", "options"}, place);
  if (!document["jobs"] || !document["jobs"].IsSequence())
    throw Failure(place + "key 'jobs' must be a list of jobs", 2);
  Entry defaults;
  defaults.folder = fs::absolute(path).parent_path().string();
  if (document["arm"]) defaults.arm = texts(document["arm"], place, "arm").front();
  if (document["options"]) defaults.options = yaml_options(document["options"], request, place);
  std::vector<Entry> entries;
  for (const YAML::Node& node : document["jobs"])
    entries.push_back(entry_of_yaml(node, defaults, path, request));
  return entries;
}

std::string name_of_folder(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name.empty() ? "trials" : name;
}

constexpr std::size_t kMostTold = 20;  // in one line

/// The jobs of what one entry names.
/// @param missing gets what it names and is not there, in words
void add_jobs(const Entry& entry, const JobListRequest& request, bool by_folder, std::vector<Job>& jobs,
              std::vector<std::string>& missing) {
  Job job;
  job.work = request.work;
  if (entry.arm.empty() && request.arm.empty())
    throw Failure(entry.place + "no arm: give --arm, or name it in the list", 2);
  job.arm = entry.arm.empty() ? request.find_arm(request.arm, fs::current_path().string())
                              : request.find_arm(entry.arm, entry.folder);
  job.options = merged(request.options, entry.options);
  std::vector<std::string> bags;
  for (const std::string& input : entry.bags) {
    try {
      for (const std::string& bag : bags_of(input, entry.folder, entry.place))
        if (std::find(bags.begin(), bags.end(), bag) == bags.end()) bags.push_back(bag);
    } catch (const Failure& failure) {
      missing.push_back(failure.what());
    }
  }
  std::vector<std::vector<std::string>> groups;
  std::map<std::string, std::size_t> group_of;
  for (const std::string& bag : bags) {
    const std::string key = request.work != "diagnose" ? bag
                            : by_folder                ? fs::path(bag).parent_path().string()
                                                       : "";
    const auto [group, fresh] = group_of.emplace(key, groups.size());
    if (fresh) groups.emplace_back();
    groups[group->second].push_back(bag);
  }
  for (const std::vector<std::string>& group : groups) {
    const fs::path first = group.front();
    job.bags = group;
    job.wanted_name = name_of_folder(first.parent_path());
    if (request.work != "diagnose") job.wanted_name += "_" + first.stem().string();
    if (!entry.name.empty())
      job.wanted_name = entry.name + (groups.size() > 1 ? "_" + first.stem().string() : "");
    if (std::find(jobs.begin(), jobs.end(), job) == jobs.end()) jobs.push_back(job);
  }
}

}  // namespace

std::vector<std::string> shell_words(const std::string& line, const std::string& place) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) {
        quote = 0;
      } else if (c == '\\' && quote == '"' && i + 1 < line.size()) {
        word += line[++i];
      } else {
        word += c;
      }
    } else if (c == ' ' || c == '\t') {
      if (in_word) words.push_back(word);
      word.clear();
      in_word = false;
    } else if (c == '#' && !in_word) {
      break;
    } else {
      in_word = true;
      if (c == '\'' || c == '"') {
        quote = c;
      } else {
        word += c == '\\' && i + 1 < line.size() ? line[++i] : c;
      }
    }
  }
  if (quote != 0) throw Failure(fmt::format("{}a quote {} is not closed", place, quote), 2);
  if (in_word) words.push_back(word);
  return words;
}

std::vector<Word> take_options(const std::vector<std::string>& words,
                               const std::map<std::string, bool>& has_value, const std::string& place,
                               std::vector<std::string>& others) {
  std::vector<Word> options;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].compare(0, 2, "--") != 0) {
      others.push_back(words[i]);
      continue;
    }
    const std::size_t equal = words[i].find('=');
    Word option{words[i].substr(0, equal), std::nullopt};
    const auto known = has_value.find(option.name);
    if (known == has_value.end()) {
      std::vector<std::string> names;
      for (const auto& [name, value] : has_value) names.push_back(name);
      throw Failure(fmt::format("{}no option '{}'; there are {}", place, option.name, fmt::join(names, ", ")),
                    2);
    }
    if (known->second) {
      if (equal == std::string::npos && i + 1 == words.size())
        throw Failure(fmt::format("{}{} has no value", place, option.name), 2);
      option.value = equal == std::string::npos ? words[++i] : words[i].substr(equal + 1);
    } else if (equal != std::string::npos) {
      throw Failure(fmt::format("{}{} takes no value", place, option.name), 2);
    }
    options.push_back(option);
  }
  return options;
}

std::vector<Job> list_jobs(const JobListRequest& request) {
  std::vector<Job> jobs;
  std::vector<std::string> missing;
  Entry typed;  // everything on the command line that is no list, together
  typed.folder = fs::current_path().string();
  const auto add_typed = [&] {
    if (!typed.bags.empty()) add_jobs(typed, request, true, jobs, missing);
    typed.bags.clear();
  };
  for (const std::string& input : request.inputs) {
    std::error_code error;
    const bool text = ends_with_one_of(input, {".txt"}), yaml = ends_with_one_of(input, {".yaml", ".yml"});
    if ((!text && !yaml) || is_pattern(input)) {
      typed.bags.push_back(input);
      continue;
    }
    add_typed();
    if (!fs::is_regular_file(input, error)) throw Failure(fmt::format("{}: no such list", input), 2);
    const std::vector<Entry> entries =
        text ? entries_of_text(input, request) : entries_of_yaml(input, request);
    if (entries.empty()) throw Failure(fmt::format("{}: names no job", input), 2);
    for (const Entry& entry : entries) add_jobs(entry, request, false, jobs, missing);
  }
  add_typed();
  if (!missing.empty()) {
    const std::size_t told = std::min(kMostTold, missing.size());
    std::string all = fmt::format(
        "{}", fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(told), "; "));
    if (told < missing.size()) all += fmt::format("; and {} more", missing.size() - told);
    throw Failure(all, 2);
  }
  return jobs;
}

}  // namespace softarm::app::batch
