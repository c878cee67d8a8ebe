// The table of the checks against the page that lists what they find.
#include "check/checks.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "check/context.h"
#include "check_fixture.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

/// Of no check: found before there is a recording to check, or when all have been.
const std::set<std::string> kOfTheProgram{"unreadable", "zero_of_all", "zeros_differ", "pooled_setting",
                                          "settings_differ"};

/// Ids and the word for the worst severity, of every row of the page's table of findings.
std::map<std::string, std::string> rows_of_page() {
  std::ifstream file(SOFTARM_SOURCE_DIR "/doc/check.md");
  std::map<std::string, std::string> rows;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| id |", 0) == 0) {
      inside = true;
    } else if (inside && line.rfind("| `", 0) == 0) {
      std::istringstream cells(line.substr(1));
      std::string ids, meaning, worst;
      std::getline(cells, ids, '|');
      std::getline(cells, meaning, '|');
      std::getline(cells, worst, '|');
      static const std::regex kId("`([a-z_]+)`");
      for (std::sregex_iterator id(ids.begin(), ids.end(), kId), end; id != end; ++id)
        EXPECT_TRUE(rows.emplace((*id)[1], worst).second) << (*id)[1] << " has two rows";
    } else if (line.rfind("|---", 0) != 0) {
      inside = false;
    }
  }
  return rows;
}

TEST(Checks, EveryIdThatIsStatedHasARowOfThePageAndNoneElse) {
  const auto rows = rows_of_page();
  std::set<std::string> on_page = kOfTheProgram, stated = kOfTheProgram;
  for (const auto& row : rows) on_page.insert(row.first);
  for (const check::Check& check : check::checks()) {
    for (const check::Statement& statement : check.states) {
      EXPECT_TRUE(stated.insert(statement.id).second) << statement.id << " is stated twice";
    }
  }
  EXPECT_EQ(stated, on_page);
  for (const std::string& id : kOfTheProgram) EXPECT_EQ(rows.count(id), 1u) << id;
}

TEST(Checks, ASeriousFindingIsCalledSoOnThePage) {
  const auto rows = rows_of_page();
  for (const check::Check& check : check::checks()) {
    for (const check::Statement& statement : check.states) {
      if (statement.severity != check::Severity::kSerious || rows.count(statement.id) == 0) continue;
      EXPECT_THAT(rows.at(statement.id), HasSubstr("serious")) << statement.id;
    }
  }
}

TEST(Checks, WhatACheckDoesNotStateItCannotSay) {
  const trial::CheckRecording recording = testing_check::clean();
  const arm::Arm arm = testing_check::hanging_arm();
  check::Context context(recording, arm);
  check::Check check;
  check.states = {{"always", check::Severity::kWarning}, {"depends", {}}};
  context.check = &check;
  EXPECT_EQ(context.add("always", "", "").severity, check::Severity::kWarning);
  EXPECT_EQ(context.add(check::Severity::kSerious, "depends", "", "").severity, check::Severity::kSerious);
  EXPECT_THROW(context.add("something_else", "", ""), std::logic_error);
  EXPECT_THROW(context.add("depends", "", ""), std::logic_error);
  EXPECT_THROW(context.add(check::Severity::kSerious, "always", "", ""), std::logic_error);
  EXPECT_EQ(context.findings.size(), 2u);
}

/// A finding of every id that the sources write: a path that no recording takes would throw at a user.
TEST(Checks, EveryIdThatASourceAddsIsStatedInThatSource) {
  static const std::regex kAdd(R"(\.add\(\s*([^;]*?)\"([a-z_]+)\"(\s*:\s*\"([a-z_]+)\")?,)");
  std::set<std::string> stated, added;
  for (const check::Check& check : check::checks()) {
    for (const check::Statement& statement : check.states) stated.insert(statement.id);
  }
  for (const auto& file : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/src/check")) {
    if (file.path().extension() != ".cpp") continue;
    std::ifstream in(file.path());
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    for (std::sregex_iterator add(text.begin(), text.end(), kAdd), end; add != end; ++add) {
      for (const int group : {2, 4}) {
        if (!(*add)[group].matched) continue;
        added.insert((*add)[group]);
        EXPECT_EQ(stated.count((*add)[group]), 1u) << file.path() << ": " << (*add)[group];
        EXPECT_THAT(text, HasSubstr("{\"" + (*add)[group].str() + "\", ")) << file.path();
      }
    }
  }
  EXPECT_GE(added.size(), 45u);
}

}  // namespace
}  // namespace softarm
