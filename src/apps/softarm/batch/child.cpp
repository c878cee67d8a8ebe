#include "child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/algorithm/string.hpp>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "../command.h"
#include "../output_file.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(20);
constexpr int kLooksAtStop = 10;  // who ends a whole job, as Slurm does, reaches the child first
constexpr auto kPatience = std::chrono::seconds(5);  // from SIGTERM to SIGKILL

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Only what is allowed between fork and exec of a program with threads.
[[noreturn]] void become(char* const* words, int log, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::sigaction(signal, &usual, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::execv(words[0], words);
  ::_exit(127);
}

pid_t start(const std::vector<std::string>& words, int log) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(pointers.data(), log, parent);
  if (child < 0) throw Failure(fmt::format("{}: cannot be started: {}", words.front(), std::strerror(errno)));
  ::setpgid(child, child);  // both do it: whoever is first
  return child;
}

}  // namespace

ChildEnd run_child(const std::vector<std::string>& words, const fs::path& log,
                   const std::function<bool()>& stop) {
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) throw Failure(fmt::format("{}: cannot be written: {}", log.string(), std::strerror(errno)));
  const Clock::time_point begun = Clock::now();
  pid_t child = -1;
  try {
    child = start(words, file);
  } catch (...) {
    ::close(file);
    throw;
  }
  ::close(file);
  ChildEnd end;
  int status = 0;
  rusage usage{};
  Clock::time_point asked;
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    const Clock::time_point now = Clock::now();
    if (!end.stopped && stop()) {
      end.stopped = true;
      asked = now;
      ::kill(-child, SIGTERM);
    } else if (end.stopped && now - asked > kPatience) {
      ::kill(-child, SIGKILL);
    }
    std::this_thread::sleep_for(kLook);
  }
  if (WIFEXITED(status)) end.exit_status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  for (int i = 0; i < kLooksAtStop && end.signal != 0 && !end.stopped; ++i) {
    end.stopped = stop();
    std::this_thread::sleep_for(kLook);
  }
  end.seconds = std::chrono::duration<double>(Clock::now() - begun).count();
  end.core_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  end.peak_memory_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return end;
}

bool run_and_read(const std::vector<std::string>& words, std::string& out, std::string& error) {
  std::string place = (fs::temp_directory_path() / "softarm_batch_XXXXXX").string();
  const int file = ::mkstemp(place.data());
  if (file < 0) throw Failure(fmt::format("{}: cannot be made: {}", place, std::strerror(errno)));
  ::close(file);
  std::string said;
  ChildEnd end;
  try {
    end = run_child(words, place, [] { return false; });
    said = read_text(place);
  } catch (...) {
    ::unlink(place.c_str());
    throw;
  }
  ::unlink(place.c_str());
  boost::trim_right(said);
  (end.exit_status == 0 ? out : error) = said;
  return end.exit_status == 0;
}

std::string on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::vector<std::string> folders;
  if (path != nullptr) boost::split(folders, std::string(path), [](char c) { return c == ':'; });
  for (const std::string& folder : folders) {
    const fs::path place = fs::path(folder) / program;
    if (!folder.empty() && ::access(place.c_str(), X_OK) == 0) return place.string();
  }
  return "";
}

}  // namespace softarm::app::batch
