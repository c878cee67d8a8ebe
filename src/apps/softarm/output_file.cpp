#include "output_file.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include "command.h"

namespace softarm::app {
namespace fs = std::filesystem;

namespace {

/// Of processes that are no more.
void remove_leftovers(const fs::path& folder, const std::string& name) {
  const std::string begin = "." + name + ".", end = ".partial";
  std::error_code error;
  std::vector<fs::path> dead;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error)) {
    const std::string file = entry->path().filename().string();
    if (file.size() <= begin.size() + end.size() || file.compare(0, begin.size(), begin) != 0 ||
        file.compare(file.size() - end.size(), end.size(), end) != 0)
      continue;
    const std::string process = file.substr(begin.size(), file.size() - begin.size() - end.size());
    pid_t id = 0;
    const auto [stop, wrong] = std::from_chars(process.data(), process.data() + process.size(), id);
    if (wrong != std::errc() || stop != process.data() + process.size() || id <= 0) continue;
    if (::kill(id, 0) != 0 && errno == ESRCH) dead.push_back(entry->path());
  }
  for (const fs::path& path : dead) fs::remove(path, error);
}

std::string sha256_of(std::istream& stream) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  if (!context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) {
    throw Failure("SHA-256 is not available in this machine's OpenSSL");
  }
  std::array<char, 65536> block{};
  while (stream) {
    stream.read(block.data(), block.size());
    EVP_DigestUpdate(context.get(), block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  EVP_DigestFinal_ex(context.get(), digest.data(), &length);
  std::string hex;
  for (unsigned int i = 0; i < length; ++i) fmt::format_to(std::back_inserter(hex), "{:02x}", digest[i]);
  return hex;
}

// Who wrote a file stands in an attribute of it, which is gone where a file system has none: then --force is
// needed.
constexpr char kRunAttribute[] = "user.softarm.run";
constexpr std::size_t kMostOfRun = 1000;  // all attributes of a file share a block

/// Whose work a file is: when it was last written, how large it was, and by which command.
std::string run_of(const fs::path& path, const std::string& command) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return "";
  return fmt::format("{}.{:09} {} {}", info.st_mtim.tv_sec, info.st_mtim.tv_nsec, info.st_size,
                     command.size() <= kMostOfRun ? command : sha256_of_text(command));
}

void note_run(const fs::path& path, const std::string& command) {
  const std::string run = run_of(path, command);
  (void)::setxattr(path.c_str(), kRunAttribute, run.data(), run.size(), 0);
}

bool is_of_run(const fs::path& path, const std::string& command) {
  std::array<char, 4096> noted{};
  const ssize_t size = ::getxattr(path.c_str(), kRunAttribute, noted.data(), noted.size());
  return size > 0 && run_of(path, command) == std::string(noted.data(), static_cast<std::size_t>(size));
}

/// The file that an output appears as, at the end of its links, whether or not it is there; nothing where it
/// must be written straight to: a device, a pipe, what a process has open.
std::optional<fs::path> replaceable(fs::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return std::nullopt;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    // What stands in /proc as a link is a file that is open: its name may be another's by now.
    const fs::path folder = fs::canonical(path.has_parent_path() ? path.parent_path() : ".", error);
    if (!error && folder.string().rfind("/proc/", 0) == 0) return std::nullopt;
    const fs::path to = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / to;  // of an absolute one, that one
  }
  return path;
}

}  // namespace

Replacing Replacing::of_this_run(bool force) {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::error_code ignored;
  Replacing replacing{force, fs::current_path(ignored).string() + ":"};
  std::string word;
  for (bool first = true; std::getline(file, word, '\0'); first = false)
    if (!first && word != "--force") replacing.command += " " + std::to_string(word.size()) + " " + word;
  return replacing;
}

void refuse_to_replace(const fs::path& path, const Replacing& replacing) {
  std::error_code ignored;
  if (replacing.all || !replaceable(path) || !fs::is_regular_file(path, ignored) ||
      is_of_run(path, replacing.command))
    return;
  throw Failure(fmt::format("{}: exists already, from another run or changed since; --force replaces it",
                            path.string()));
}

ResultsFolder::ResultsFolder(const fs::path& path) {
  std::error_code error;
  for (fs::path p = path; !p.empty() && !fs::exists(p, error); p = p.parent_path()) made_.push_back(p);
  fs::create_directories(path, error);
  if (error) throw Failure(fmt::format("{}: cannot be made: {}", path.string(), error.message()));
  for (auto p = made_.rbegin(); p != made_.rend(); ++p) empty_.emplace_back(p->string());
}

ResultsFolder::~ResultsFolder() {
  std::error_code not_empty;
  for (const fs::path& p : made_) fs::remove(p, not_empty);
}

void finish(std::ofstream& stream, const fs::path& path) {
  // The first failure is that of the disk; those that follow say nothing.
  const int reason = errno;
  const bool failed = !stream;
  errno = 0;
  stream.close();
  if (stream) return;
  const int why = failed ? reason : errno;
  throw Failure(fmt::format("{}: cannot be written{}", path.string(),
                            why != 0 ? fmt::format(": {}", std::strerror(why)) : ""));
}

void write_text(const fs::path& path, const std::string& text) {
  errno = 0;
  std::ofstream stream(path, std::ios::binary);
  stream << text << std::flush;
  finish(stream, path);
}

void OutputFile::write(const std::string& text) {
  try {
    write_text(temporary_, text);
  } catch (const Failure& failure) {  // people know the file by its own name
    std::string why = failure.what();
    why.replace(0, temporary_.string().size(), path_.string());
    throw Failure(why);
  }
}

OutputFile::OutputFile(fs::path path, Replacing replacing)
    : path_(std::move(path)), temporary_(path_), replacing_(std::move(replacing)) {
  place_ = replaceable(path_).value_or("");
  if (place_.empty()) return;
  const fs::path folder = place_.has_parent_path() ? place_.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Failure(fmt::format("{}: the folder {} does not exist", path_.string(), folder.string()));
  }
  if (fs::is_directory(place_, error)) throw Failure(fmt::format("{}: is a folder", path_.string()));
  if (::access(folder.c_str(), W_OK) != 0) {
    throw Failure(fmt::format("{}: the folder {} cannot be written", path_.string(), folder.string()));
  }
  refuse_to_replace(path_, replacing_);
  remove_leftovers(folder, place_.filename().string());
  // Hidden, with the process in its name: two runs do not write into each other's file.
  temporary_ = folder / fmt::format(".{}.{}.partial", place_.filename().string(), ::getpid());
  unfinished_.emplace(temporary_.string());
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (!committed_ && !place_.empty()) fs::remove(temporary_, ignored);
}

void OutputFile::commit() {
  committed_ = true;
  if (place_.empty()) return;
  std::error_code error;
  if (!replacing_.command.empty()) note_run(temporary_, replacing_.command);
  fs::rename(temporary_, place_, error);
  committed_ = !error;
  if (error) throw Failure(fmt::format("{}: cannot be written: {}", path_.string(), error.message()));
}

std::string read_text(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw Failure(fmt::format("{}: is a folder", path.string()));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Failure(fmt::format("{}: cannot be read", path.string()));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string sha256_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Failure(fmt::format("{}: cannot be read", path.string()));
  return sha256_of(file);
}

std::string sha256_of_text(const std::string& text) {
  std::istringstream stream(text);
  return sha256_of(stream);
}

}  // namespace softarm::app
