#include "job_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "../command.h"
#include "../output_file.h"
#include "version.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kFormat = 1;

std::string text_of(const OrderedJson& json) {
  // Names of files may be anything; what is not UTF-8 would end it.
  return json.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

/// Absent where it is not there, cut off, or of another format.
std::optional<OrderedJson> json_in(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  OrderedJson json = OrderedJson::parse(read_text(path), nullptr, false);
  if (json.is_discarded() || !json.is_object() || json.value("format", 0) != kFormat) return std::nullopt;
  return json;
}

void write_json(const fs::path& path, const OrderedJson& json) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  OutputFile file(path);
  file.write(text_of(json));
  file.commit();
}

bool stat_of(const std::string& path, NotedFile& file) {
  struct stat info {};
  file.path = path;
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return false;
  file.size = static_cast<std::uint64_t>(info.st_size);
  file.changed_ns = static_cast<std::int64_t>(info.st_mtim.tv_sec) * 1000000000 + info.st_mtim.tv_nsec;
  return true;
}

OrderedJson to_json(const Job& job) {
  OrderedJson json{{"format", kFormat}, {"work", job.work}, {"arm", job.arm}, {"bags", job.bags}};
  json["options"] = OrderedJson::array();
  for (const Word& option : job.options) {
    OrderedJson words = OrderedJson::array({option.name});
    if (option.value) words.push_back(*option.value);
    json["options"].push_back(words);
  }
  return json;
}

OrderedJson to_json(const std::vector<NotedFile>& files) {
  OrderedJson list = OrderedJson::array();
  for (const NotedFile& file : files) {
    list.push_back({{"path", file.path}, {"size", file.size}, {"changed_ns", file.changed_ns}});
    if (!file.sha256.empty()) list.back()["sha256"] = file.sha256;
  }
  return list;
}

std::vector<NotedFile> files_of(const OrderedJson& list) {
  std::vector<NotedFile> files;
  for (const OrderedJson& one : list)
    files.push_back({one.at("path").get<std::string>(), one.at("size").get<std::uint64_t>(),
                     one.at("changed_ns").get<std::int64_t>(), one.value("sha256", "")});
  return files;
}

bool is_as_noted(const NotedFile& noted) {
  NotedFile now;
  if (!stat_of(noted.path, now) || now.size != noted.size) return false;
  return now.changed_ns == noted.changed_ns ||
         (!noted.sha256.empty() && sha256_of_file(noted.path) == noted.sha256);
}

bool share_a_bag(const Job& a, const Job& b) {
  return std::any_of(a.bags.begin(), a.bags.end(), [&](const std::string& bag) {
    return std::find(b.bags.begin(), b.bags.end(), bag) != b.bags.end();
  });
}

}  // namespace

std::optional<Job> JobFolder::order() const {
  const std::optional<OrderedJson> json = json_in(path_ / "job.json");
  if (!json) return std::nullopt;
  try {
    Job job;
    job.work = json->at("work").get<std::string>();
    job.arm = json->at("arm").get<std::string>();
    job.bags = json->at("bags").get<std::vector<std::string>>();
    for (const OrderedJson& option : json->at("options")) {
      Word word{option.at(0).get<std::string>(), std::nullopt};
      if (option.size() > 1) word.value = option.at(1).get<std::string>();
      job.options.push_back(word);
    }
    return job;
  } catch (const OrderedJson::exception&) {
    return std::nullopt;
  }
}

void JobFolder::write_order(const Job& job) const {
  write_json(path_ / "job.json", to_json(job));
}

std::optional<Outcome> JobFolder::outcome() const {
  const std::optional<OrderedJson> json = json_in(path_ / "outcome.json");
  if (!json) return std::nullopt;
  try {
    Outcome outcome;
    outcome.done = json->at("status").get<std::string>() == "done";
    outcome.reason = json->value("reason", "");
    outcome.version = json->value("version", "");
    outcome.machine = json->value("machine", "");
    outcome.order_sha256 = json->value("order_sha256", "");
    outcome.seconds = json->value("seconds", 0.0);
    outcome.core_seconds = json->value("core_seconds", 0.0);
    outcome.peak_memory_bytes = json->value("peak_memory_bytes", 0.0);
    outcome.inputs = files_of(json->at("inputs"));
    outcome.results = files_of(json->at("results"));
    return outcome;
  } catch (const OrderedJson::exception&) {
    return std::nullopt;
  }
}

void JobFolder::write_outcome(const Outcome& outcome) const {
  OrderedJson json{{"format", kFormat}, {"status", outcome.done ? "done" : "failed"}};
  if (!outcome.done) json["reason"] = outcome.reason;
  json["version"] = outcome.version;
  json["machine"] = outcome.machine;
  json["order_sha256"] = outcome.order_sha256;
  json["seconds"] = outcome.seconds;
  json["core_seconds"] = outcome.core_seconds;
  json["peak_memory_bytes"] = outcome.peak_memory_bytes;
  json["inputs"] = to_json(outcome.inputs);
  std::vector<NotedFile> results;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(result(), error), end; !error && entry != end;
       entry.increment(error)) {
    NotedFile file;
    if (stat_of(entry->path().string(), file)) results.push_back(file);
  }
  std::sort(results.begin(), results.end(),
            [](const NotedFile& a, const NotedFile& b) { return a.path < b.path; });
  for (NotedFile& file : results) file.path = fs::path(file.path).lexically_relative(path_).string();
  json["results"] = to_json(results);
  write_json(path_ / "outcome.json", json);
}

void JobFolder::clear() const {
  std::error_code error;
  fs::remove(path_ / "outcome.json", error);  // first: what is left is not taken for whole
  if (!error) fs::remove(log(), error);
  if (!error) fs::remove_all(result(), error);
  if (error) throw Failure(fmt::format("{}: cannot be removed: {}", path_.string(), error.message()));
}

Standing JobFolder::standing(const Job& job) const {
  const std::optional<Outcome> noted = outcome();
  const std::optional<Job> ordered = order();
  if (!noted || !ordered) return Standing::kNew;
  if (!(*ordered == job) || noted->order_sha256 != digest_of(job) || noted->version != program_version())
    return Standing::kChanged;
  for (const NotedFile& file : noted->inputs)
    if (!is_as_noted(file)) return Standing::kChanged;
  if (!noted->done) return Standing::kFailed;
  for (NotedFile file : noted->results) {
    NotedFile now;
    if (!stat_of((path_ / file.path).string(), now) || now.size != file.size) return Standing::kChanged;
  }
  return Standing::kDone;
}

std::string digest_of(const Job& job) {
  return sha256_of_text(text_of(to_json(job)));
}

std::vector<NotedFile> note_inputs(const Job& job) {
  std::vector<NotedFile> files;
  std::vector<std::string> paths{job.arm};
  paths.insert(paths.end(), job.bags.begin(), job.bags.end());
  for (const std::string& path : paths) {
    NotedFile file;
    if (!stat_of(path, file)) throw Failure(fmt::format("{}: no such file", path));
    file.sha256 = sha256_of_file(path);
    files.push_back(file);
  }
  return files;
}

std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : name.substr(0, 100))
    plain += std::isalnum(static_cast<unsigned char>(c)) != 0 || (c == '.' && !plain.empty()) || c == '_' ||
                     c == '-'
                 ? c
                 : '_';
  return plain.empty() ? "job" : plain;
}

std::vector<JobFolder> find_folders(const fs::path& folder, const std::vector<Job>& jobs, bool force) {
  std::map<std::string, std::optional<Job>> there;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    there[entry->path().filename().string()] = JobFolder(entry->path()).order();
  std::vector<std::string> names(jobs.size());
  std::set<std::string> taken;
  for (const auto& [name, ordered] : there) {
    const auto job = ordered ? std::find(jobs.begin(), jobs.end(), *ordered) : jobs.end();
    if (job == jobs.end() || !names[static_cast<std::size_t>(job - jobs.begin())].empty()) continue;
    names[static_cast<std::size_t>(job - jobs.begin())] = name;
    taken.insert(name);
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::string wanted = plain_name(jobs[i].wanted_name);
    for (int n = 1; names[i].empty(); ++n) {
      const std::string name = n == 1 ? wanted : fmt::format("{}_{}", wanted, n);
      if (taken.count(name) != 0) continue;
      const auto old = there.find(name);
      // Of other bags that only have the same name; of the same bags, one more or one less, it goes on.
      if (old != there.end() && old->second && !share_a_bag(*old->second, jobs[i])) continue;
      if (old != there.end() && !force && !(old->second && same_command(*old->second, jobs[i])))
        throw Failure(
            fmt::format("{}: exists already, with another arm file or other options; --force repeats it with "
                        "these, or give another --out",
                        (folder / name).string()));
      names[i] = name;
      taken.insert(name);
    }
  }
  std::vector<JobFolder> folders;
  for (const std::string& name : names) folders.emplace_back(folder / name);
  return folders;
}

}  // namespace softarm::app::batch
