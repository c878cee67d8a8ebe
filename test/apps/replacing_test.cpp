// Results of another run are not replaced unasked; the very same command may be run again.
#include <gmock/gmock.h>
#include <sys/xattr.h>

#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

void expect_kept(const std::string& command, const std::string& file, int status = 1) {
  const std::string before = text_of(file);
  const Outcome o = softarm_program(command);
  EXPECT_EQ(o.status, status) << command;
  EXPECT_THAT(o.err,
              HasSubstr(file + ": exists already, from another run or changed since; --force replaces it"));
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_EQ(text_of(file), before) << command;
}

/// Whether the file system can say who wrote a file: else even the same command is another one.
bool is_known_again(const TestFolder& dir) {
  return ::setxattr(dir.write("attributes", "").c_str(), "user.test", "1", 1, 0) == 0;
}

TEST(Replacing, OnlyTheSameCommandAndForceMay) {
  const TestFolder dir;
  const int again = is_known_again(dir) ? 0 : 1;
  const std::string bag = dir / "trial.bag", simulate = "simulate trial_10s --seconds 6 --out " + bag;
  ASSERT_EQ(softarm_program(simulate).status, 0);
  EXPECT_EQ(softarm_program(simulate).status, again);
  expect_kept(simulate + " --seed 9", bag);
  EXPECT_EQ(softarm_program(simulate + " --seed 9 --force").status, 0);
  EXPECT_EQ(softarm_program(simulate + " --seed 9").status, again);

  const std::string csv = dir / "out/trial/estimates.csv",
                    estimate = "estimate --arm online_200mm " + bag + " --out " + dir / "out";
  ASSERT_EQ(softarm_program(estimate).status, 0);
  EXPECT_EQ(softarm_program(estimate).status, again);
  expect_kept(estimate + " --unknown payload", csv);
  EXPECT_EQ(softarm_program(estimate + " --unknown payload --force").status, 0);

  const std::string json = dir / "findings.json",
                    check = "check --arm online_200mm " + bag + " --json " + json;
  ASSERT_EQ(softarm_program(check).status, 0);
  EXPECT_EQ(softarm_program(check).status, 2 * again);
  expect_kept(check + " --quiet", json, 2);

  std::ofstream(csv, std::ios::app) << "a remark\n";
  expect_kept(estimate + " --unknown payload", csv);
}

TEST(Replacing, WhatSomebodyEditedIsKept) {
  const TestFolder dir;
  const std::string
      arm = dir / "arm.yaml",
      make =
          "new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators 3 "
          "--bodies 4 --out " +
          arm;
  ASSERT_EQ(softarm_program(make).status, 0);
  EXPECT_EQ(softarm_program(make).status, is_known_again(dir) ? 0 : 1);
  std::ofstream(arm, std::ios::app) << "# measured today\n";
  expect_kept(make, arm);
  std::ofstream(arm) << "# not made by any run\n";
  expect_kept(make, arm);
  EXPECT_EQ(softarm_program(make + " --force").status, 0);
}

}  // namespace
}  // namespace softarm
