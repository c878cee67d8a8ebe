// Results of another run are not replaced unasked; the very same command may be run again.
#include <gmock/gmock.h>

#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

void expect_kept(const std::string& command, const std::string& file) {
  const std::string before = text_of(file);
  const Outcome o = softarm_program(command);
  EXPECT_EQ(o.status, 1) << command;
  EXPECT_THAT(o.err,
              HasSubstr(file + ": is there already, of another run or changed since; --force replaces it"));
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_EQ(text_of(file), before) << command;
}

TEST(Replacing, OnlyTheSameCommandAndForceMay) {
  const TestFolder dir;
  const std::string bag = dir / "trial.bag", simulate = "simulate trial_10s --seconds 6 --out " + bag;
  ASSERT_EQ(softarm_program(simulate).status, 0);
  EXPECT_EQ(softarm_program(simulate).status, 0) << "again";
  expect_kept(simulate + " --seed 9", bag);
  EXPECT_EQ(softarm_program(simulate + " --seed 9 --force").status, 0);
  EXPECT_EQ(softarm_program(simulate + " --seed 9").status, 0) << "its own";

  const std::string csv = dir / "out/trial/estimates.csv",
                    estimate = "estimate --arm online_200mm " + bag + " --out " + dir / "out";
  ASSERT_EQ(softarm_program(estimate).status, 0);
  EXPECT_EQ(softarm_program(estimate).status, 0);
  expect_kept(estimate + " --unknown payload", csv);
  EXPECT_EQ(softarm_program(estimate + " --unknown payload --force").status, 0);

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
  EXPECT_EQ(softarm_program(make).status, 0);
  std::ofstream(arm, std::ios::app) << "# measured today\n";
  expect_kept(make, arm);
  std::ofstream(arm) << "# not made by any run\n";
  expect_kept(make, arm);
  EXPECT_EQ(softarm_program(make + " --force").status, 0);
}

}  // namespace
}  // namespace softarm
