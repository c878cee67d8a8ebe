// Runs the built program `softarm` as a user would.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace softarm {

inline std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Names of parametrised tests have slashes.
inline std::string file_name_of(std::string test) {
  std::replace(test.begin(), test.end(), '/', '_');
  return test;
}

/// A folder of the running test, removed with it.
class TestFolder {
 public:
  TestFolder() {
    const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("softarm_" + file_name_of(std::string(test->test_suite_name()) + "_" + test->name()) + "." +
             std::to_string(getpid()));  // several run one test at a time
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return *this / name;
  }
  /// Everything below it, hidden files too.
  std::size_t entries() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::recursive_directory_iterator(path_)) ++count;
    return count;
  }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int status = -1;       ///< exit status; -1 if a signal ended the program
  std::string out, err;  ///< err without the lines that tell of progress, which hang on how long it took
};

/// What a program that runs for long says on its way where standard error is no terminal: "10 s: 37 % ...".
inline bool tells_of_progress(const std::string& line) {
  const std::size_t digits = line.find_first_not_of("0123456789");
  return digits > 0 && digits != std::string::npos && line.compare(digits, 3, " s:") == 0;
}

inline std::string without_progress(const std::string& text) {
  std::string rest;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!tells_of_progress(line)) rest += line + (lines.eof() ? "" : "\n");
  return rest;
}

/// @param arguments as typed in a shell
/// @param before what the shell does first
inline Outcome softarm_program(const std::string& arguments, const std::string& before = "") {
  // Outside of the test's folder, whose files are counted.
  const std::string stem = std::string(::testing::TempDir()) + "/softarm_run_" +
                           file_name_of(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
                           "." + std::to_string(getpid());
  const std::string command = before + SOFTARM_PROGRAM_DIR "/softarm " + arguments + " >" + stem + ".out 2>" +
                              stem + ".err </dev/null";
  const int raw = std::system(command.c_str());
  Outcome outcome;
  if (WIFEXITED(raw)) outcome.status = WEXITSTATUS(raw);
  outcome.out = text_of(stem + ".out");
  outcome.err = without_progress(text_of(stem + ".err"));
  std::filesystem::remove(stem + ".out");
  std::filesystem::remove(stem + ".err");
  return outcome;
}

/// Where the recordings of real arms are; empty where they are absent.
inline std::string recordings() {
  const char* told = std::getenv("SOFTARM_DATA");
  const std::filesystem::path data = told ? told : SOFTARM_SOURCE_DIR "/../shared/data";
  return std::filesystem::is_directory(data / "pouch_arm") ? data.string() : "";
}

}  // namespace softarm
