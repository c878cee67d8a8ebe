#include "child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPoll(50);

std::string last_line_of(const std::string& path) {
  std::ifstream file(path);
  std::string last, line;
  while (std::getline(file, line)) {
    // Progress rewrites its line.
    if (const auto at = line.rfind('\r'); at != std::string::npos) line = line.substr(at + 1);
    if (line.find_first_not_of(" \t") != std::string::npos) last = line;
  }
  return last;
}

}  // namespace

Ended run_program(const std::string& program, const std::vector<std::string>& arguments,
                  const std::string& log, const std::atomic<bool>& stop) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0)
    throw std::runtime_error(fmt::format("{}: cannot be started: {}", program, std::strerror(error)));

  int status = 0;
  bool told = false;
  pid_t ended = 0;
  while ((ended = waitpid(child, &status, WNOHANG)) == 0) {
    if (stop && !std::exchange(told, true)) kill(child, SIGTERM);
    std::this_thread::sleep_for(kPoll);
  }
  if (ended < 0)
    throw std::runtime_error(
        fmt::format("{}: its exit status is not known: {}", program, std::strerror(errno)));
  const int exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {exit_status, last_line_of(log)};
}

std::string beside_this_program(const std::string& name) {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  const fs::path beside = self.parent_path() / name;
  return !error && fs::exists(beside, error) ? beside.string() : name;
}

}  // namespace softarm::app
