// `softarm batch` over tiny trials of the rig, with processes of this machine.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "program.h"

namespace softarm {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void record(const TestFolder& dir, const std::string& name, const std::string& more = "--seconds 6") {
  fs::create_directories(fs::path(dir / name).parent_path());
  const Outcome o = softarm_program("simulate trial_10s " + more + " --out " + dir / name);
  ASSERT_EQ(o.status, 0) << o.err;
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(SoftarmBatch, OneTableOfAllAndOnlyWhatChangedIsDoneAgain) {
  const TestFolder dir;
  record(dir, "trials/a.bag", "--seconds 6 --seed 1");
  record(dir, "trials/b.bag", "--seconds 6 --seed 2");
  dir.write("trials/c.bag", "#ROSBAG V2.0\nand no more");
  const std::string estimate =
      "batch estimate --arm online_200mm " + dir / "trials" + " --out " + dir / "out";
  const Outcome first = softarm_program(estimate);
  EXPECT_EQ(first.status, 1) << first.err;
  EXPECT_THAT(first.out,
              HasSubstr("3 jobs: 2 done, 1 failed\nfailed trials_c: " + dir / "trials/c.bag: damaged"));
  EXPECT_THAT(
      first.err,
      HasSubstr("softarm: 1 of 3 jobs failed; once the cause is removed, --retry-failed runs them again\n"));
  EXPECT_THAT(first.err, HasSubstr("done   trials_a: frames ok 721, EI where identifiable"));
  const std::string table = text_of(dir / "out/batch.csv");
  EXPECT_EQ(lines(table), 4U);
  EXPECT_THAT(
      table,
      HasSubstr("job,state,duration_s,frames,frames_ok,rms_residual_m,reduced_chi_square,tip_angle_rad,M0_nm,"
                "L_m,EI_nm2,EI_identifiable_frames,EI_where_identifiable_nm2,payload_kg,reason,"));
  const std::string page = text_of(dir / "out/batch.html");
  EXPECT_THAT(page, HasSubstr("jobs/trials_a/result/a/summary.txt"));
  EXPECT_THAT(page, HasSubstr("damaged at byte 13"));

  const Outcome again = softarm_program(estimate);
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(
      again.err,
      HasSubstr("3 jobs: 0 to do, 2 done before, 1 failed before (--retry-failed runs them again)\n"));
  EXPECT_EQ(text_of(dir / "out/batch.csv"), table);
  EXPECT_THAT(softarm_program(estimate + " --retry-failed").err,
              HasSubstr("3 jobs: 1 to do, 2 done before\n"));

  fs::copy_file(dir / "trials/a.bag", dir / "trials/c.bag", fs::copy_options::overwrite_existing);
  const Outcome mended = softarm_program(estimate);
  EXPECT_EQ(mended.status, 0) << mended.err;
  EXPECT_THAT(mended.err,
              HasSubstr("3 jobs: 1 to do, 2 done before, 1 of them again: what they read has changed\n"));
  EXPECT_EQ(mended.out.substr(0, mended.out.find('\n')), "3 jobs: 3 done");
}

TEST(SoftarmBatch, AListGivesEachJobItsArmAndOptions) {
  const TestFolder dir;
  record(dir, "one/a.bag");
  record(dir, "two/a.bag");
  const std::string list =
      dir.write("list.txt", "--arm online_200mm one\n--arm online_200mm two/*.bag --unknown payload\n");
  const std::string command = "batch --jobs 1 estimate " + list + " --out " + dir / "out";
  const Outcome o = softarm_program(command);
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(text_of(dir / "out/jobs/one_a/result/a/summary.txt"), HasSubstr("unknown: stiffness"));
  EXPECT_THAT(text_of(dir / "out/jobs/two_a/result/a/summary.txt"), HasSubstr("unknown: payload"));
  const Outcome other = softarm_program(command + " --window 0.5");
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err,
              HasSubstr("out/jobs/one_a: exists already, with another arm file or other options; --force"));
  const Outcome forced = softarm_program(command + " --window 0.5 --force");
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_THAT(text_of(dir / "out/jobs/two_a/result/a/summary.txt"), HasSubstr("window: 0.5 s"));
}

TEST(SoftarmBatch, WhatCheckFindsIsAResult) {
  const TestFolder dir;
  record(dir, "a.bag");
  dir.write("b.bag", "#ROSBAG V2.0\nand no more");
  const Outcome o = softarm_program("batch check --arm online_200mm '" + dir / "*.bag' --out " + dir / "out");
  EXPECT_EQ(o.status, 1) << o.err;
  EXPECT_THAT(o.out, HasSubstr("2 jobs: 2 done\nserious findings in 1 of 2 recordings\n"));
  EXPECT_THAT(text_of(dir / "out/batch.csv"), HasSubstr("_b,done,serious,1,unreadable,0,"));
}

TEST(SoftarmBatch, BadUsageIsOneLineBeforeAnyWork) {
  const TestFolder dir;
  dir.write("a.bag", "");
  const auto said = [&](const std::string& words) {
    const Outcome o = softarm_program("batch " + words + " --out " + dir / "out");
    EXPECT_EQ(o.status, 2) << words;
    EXPECT_EQ(lines(o.err), 1U) << o.err;
    EXPECT_FALSE(fs::exists(dir / "out")) << words;
    return o.err;
  };
  EXPECT_THAT(said("estimat --arm online_200mm a.bag"),
              HasSubstr("no command 'estimat'; did you mean 'estimate'? There are"));
  EXPECT_THAT(said("estimate --arm online_200mn " + dir / "a.bag"), HasSubstr("arm 'online_200mn'"));
  EXPECT_THAT(said("estimate --arm online_200mm --window 99 " + dir / "a.bag"), HasSubstr("--window"));
  EXPECT_THAT(said("check --arm online_200mm --window 1 " + dir / "a.bag"), HasSubstr("--window"));
  EXPECT_THAT(said("check --arm online_200mm --no-wait " + dir / "a.bag"),
              HasSubstr("are for --engine slurm"));
}

TEST(SoftarmBatch, FoldersOfOthersAreLeftAlone) {
  const TestFolder dir;
  dir.write("a.bag", "");
  const std::string check = "batch check --arm online_200mm " + dir / "a.bag" + " --out " + dir / "out";
  fs::create_directories(dir / "out");
  dir.write("out/thesis.tex", "");
  EXPECT_THAT(softarm_program(check).err, HasSubstr("exists already and is not a batch"));
  fs::remove(dir / "out/thesis.tex");
  EXPECT_EQ(softarm_program(check).status, 1);  // the bag is empty
  const Outcome other =
      softarm_program("batch estimate --arm online_200mm " + dir / "a.bag" + " --out " + dir / "out");
  EXPECT_THAT(other.err, HasSubstr("is another command's batch: softarm batch check"));
  const int lock = ::open((dir / "out/.lock").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
  const Outcome second = softarm_program(check);
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.err, HasSubstr("another batch is running there"));
  ::close(lock);
}

TEST(SoftarmBatch, AnInterruptLeavesWhatCanBeGoneOnWith) {
  const TestFolder dir;
  record(dir, "trials/a.bag");
  record(dir, "trials/long.bag", "--seconds 60");
  const std::string estimate =
      "batch --jobs 1 estimate --arm online_200mm " + dir / "trials" + " --out " + dir / "out";
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string shell = "exec " SOFTARM_PROGRAM_DIR "/softarm " + estimate + " >" + dir / "said 2>&1";
    ::execl("/bin/sh", "sh", "-c", shell.c_str(), nullptr);
    ::_exit(127);
  }
  for (int i = 0; i < 600 && !fs::exists(dir / "out/jobs/trials_long/log.txt"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(fs::exists(dir / "out/jobs/trials_a/outcome.json"));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 130) << text_of(dir / "said");
  EXPECT_THAT(text_of(dir / "said"), HasSubstr("2 jobs: 1 done, 1 open\n"));
  EXPECT_THAT(text_of(dir / "said"), HasSubstr("interrupted; the same command goes on from here\n"));
  EXPECT_THAT(text_of(dir / "out/batch.csv"), HasSubstr("trials_long,open,"));
  EXPECT_FALSE(fs::exists(dir / "out/jobs/trials_long/result"));
  const Outcome rest = softarm_program(estimate);
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_THAT(rest.err, HasSubstr("2 jobs: 1 to do, 1 done before\n"));
}

}  // namespace
}  // namespace softarm
