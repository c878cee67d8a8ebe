// The corpus of scripts/fuzz through its targets, whole and cut off: what was ever found stays mended.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "targets.h"

namespace softarm::fuzz {
namespace {

constexpr int kCuts = 16;  // of each file

void run(void (*target)(const std::uint8_t*, std::size_t), const char* name) {
  int files = 0;
  const std::filesystem::path folder =
      std::filesystem::path(SOFTARM_SOURCE_DIR) / "test" / "fuzz" / "corpus" / name;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    for (int cut = 1; cut <= kCuts; ++cut) {
      const std::size_t size = bytes.size() * static_cast<std::size_t>(cut) / kCuts;
      // Of its own, so that a sanitizer sees what is read behind it.
      const std::string part = bytes.substr(0, size);
      EXPECT_NO_THROW(target(reinterpret_cast<const std::uint8_t*>(part.data()), part.size()))
          << entry.path() << ", the first " << size << " bytes";
    }
    ++files;
  }
  EXPECT_GT(files, 0) << folder;
}

TEST(Corpus, OfArms) {
  run(arm, "arm");
}
TEST(Corpus, OfBags) {
  run(bag, "bag");
}
TEST(Corpus, OfLayoutsAndRecordings) {
  run(csv, "csv");
}
TEST(Corpus, OfMessages) {
  run(message, "message");
}
TEST(Corpus, OfScenarios) {
  run(scenario, "scenario");
}

}  // namespace
}  // namespace softarm::fuzz
