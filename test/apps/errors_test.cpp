// What the program says to bad input: one line, a non-zero exit status, nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <vector>

#include "program.h"

namespace softarm {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr const char* kLayout = R"(
time: {column: 1, unit: s}
mocap:
  unit: m
  up: z
  bodies:
    - {name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: xyzw}
)";

/// Runs it and expects the refusal; nothing may be added to the folder.
void expect_refused(const TestFolder& folder, const std::string& arguments,
                    const ::testing::Matcher<const std::string&>& matcher) {
  SCOPED_TRACE("softarm " + arguments);
  const std::size_t before = folder.entries();
  const Outcome o = softarm_program(arguments);
  EXPECT_GT(o.status, 0);
  EXPECT_THAT(o.err, matcher);
  EXPECT_EQ(o.err.rfind("softarm: ", 0), 0u) << o.err;
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_EQ(folder.entries(), before) << "something was left behind";
}

TEST(SoftarmErrors, CommandLine) {
  const TestFolder dir;
  expect_refused(dir, "", HasSubstr("subcommand"));
  expect_refused(dir, "estmate x.bag", AllOf(HasSubstr("'estmate'"), HasSubstr("did you mean 'estimate'?")));
  expect_refused(dir, "estimate x.bag", HasSubstr("--arm"));
  expect_refused(dir, "estimate --arm online_200mm", HasSubstr("BAG"));
  expect_refused(dir, "simulate demo --seconds -1 --out " + dir / "x.bag", HasSubstr("--seconds"));
  expect_refused(dir, "simulate demo --colour blue --out " + dir / "x.bag", HasSubstr("--colour"));
  expect_refused(dir, "simulate " SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml --out " + dir / "x.bag",
                 HasSubstr("is an arm file; its arm, moving at random, is endless; --seconds"));
}

TEST(SoftarmErrors, HelpAndVersion) {
  EXPECT_EQ(softarm_program("--version").status, 0);
  EXPECT_THAT(softarm_program("--version").out, HasSubstr("softarm "));
  for (const std::string command : {"", "estimate ", "import ", "simulate "}) {
    const Outcome o = softarm_program(command + "--help");
    EXPECT_EQ(o.status, 0);
    EXPECT_THAT(o.out, HasSubstr("Usage"));
    if (!command.empty()) {
      EXPECT_THAT(o.out, HasSubstr("Examples:"));
    }
  }
}

/// No file may become longer than that: to a program it is as a disk that is full.
std::string disk_with(int bytes) {
  return "trap '' XFSZ; ulimit -f " + std::to_string(bytes / 512) + "; ";
}

/// A recording that kLayout describes: its bag has tens of kilobytes.
std::string long_csv() {
  std::string rows;
  for (int i = 0; i < 2000; ++i)
    rows += std::to_string(0.01 * i) + "," + std::to_string(1e-3 * i) + ",0.2,0.3,0,0,0,1\n";
  return rows;
}

TEST(SoftarmErrors, FullDisk) {
  const TestFolder dir;
  const std::string bag = dir / "trial.bag", out = " --out " + dir / "out";
  const std::string layout = dir.write("layout.yaml", kLayout), csv = dir.write("long.csv", long_csv());
  ASSERT_EQ(softarm_program("simulate demo --seconds 10 --seed 3 --out " + bag).status, 0);
  const std::string arm = " --arm online_200mm ";
  for (const std::string& arguments :
       {"simulate demo --seconds 10 --seed 3" + out + ".bag", "campaign development --cases 1 --seed 1" + out,
        "import " + layout + " " + csv + out + ".bag", "estimate" + arm + bag + out,
        "check --quiet" + arm + "--json " + dir / "out.json " + bag,
        "new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators 3 --bodies "
        "4" +
            out + ".yaml"}) {
    SCOPED_TRACE(arguments);
    const std::size_t before = dir.entries();
    const Outcome o = softarm_program(arguments, disk_with(1024));
    EXPECT_GT(o.status, 0);
    EXPECT_THAT(o.err, ContainsRegex("cannot be written: .*(File too large|No space left on device)"))
        << o.out;
    EXPECT_EQ(o.err.find("/."), std::string::npos) << "people know it by its own name: " << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(dir.entries(), before) << "something was left behind";
  }
}

TEST(SoftarmErrors, FullDiskTakesNoResultThatIsReadFromTheTerminal) {
  const TestFolder dir;
  const std::string bag = dir / "trial.bag", arm = " --arm online_200mm ";
  ASSERT_EQ(softarm_program("simulate demo --seconds 10 --seed 3 --out " + bag).status, 0);
  const auto expect_said = [&](const std::string& arguments, const std::vector<std::string>& words) {
    SCOPED_TRACE(arguments);
    const std::size_t before = dir.entries();
    const Outcome o = softarm_program(arguments, disk_with(8192));  // what is printed is a file here, too
    EXPECT_EQ(o.status, 1);
    EXPECT_THAT(o.err, ContainsRegex("cannot be written: .*(File too large|No space left on device)"));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    for (const std::string& word : words) EXPECT_THAT(o.out, HasSubstr(word));
    EXPECT_EQ(o.out.find("written:"), std::string::npos) << o.out;
    EXPECT_EQ(dir.entries(), before) << "something was left behind";
  };
  expect_said("estimate" + arm + bag + " --out " + dir / "out", {"frames ok:", "frames_per_s:"});
  expect_said("identify" + arm + bag + " --free segment_1.bending_stiffness.base --frames 40 --out " +
                  dir / "out.yaml",
              {"arm: ", "segment_1.bending_stiffness.base"});
  std::string trials;
  for (const std::string seed : {"1", "2", "3"}) {
    trials += " " + dir / ("trial_" + seed + ".bag");
    ASSERT_EQ(softarm_program("simulate demo --seconds 6 --seed " + seed + " --out " +
                              dir / ("trial_" + seed + ".bag"))
                  .status,
              0);
  }
  expect_said("diagnose --most-effects 1" + arm + trials + " --out " + dir / "report",
              {"On unseen trials", "candidate"});
}

TEST(SoftarmErrors, WhatIsNoFileIsWrittenToAndALinkStaysOne) {
  namespace fs = std::filesystem;
  const TestFolder dir;
  const std::string bag = dir / "trial.bag", check = "check --quiet --arm online_200mm " + bag + " --json ";
  ASSERT_EQ(softarm_program("simulate demo --seconds 2 --seed 3 --out " + bag).status, 0);
  ASSERT_EQ(mkfifo((dir / "pipe").c_str(), 0600), 0);
  const Outcome piped =
      softarm_program(check + dir / "pipe", "cat " + dir / "pipe" + " > " + dir / "read.json & ");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_TRUE(fs::is_fifo(dir / "pipe"));
  for (int i = 0; i < 500 && text_of(dir / "read.json").empty(); ++i) usleep(20000);
  EXPECT_THAT(text_of(dir / "read.json"), HasSubstr("\"recordings\""));

  fs::create_symlink("named.json", dir / "link.json");  // relative
  EXPECT_EQ(softarm_program(check + dir / "link.json").status, 0);
  EXPECT_TRUE(fs::is_symlink(dir / "link.json"));
  EXPECT_THAT(text_of(dir / "named.json"), HasSubstr("\"recordings\""));

  std::ofstream(dir / "named.json") << "another's";
  expect_refused(dir, check + dir / "link.json", HasSubstr("link.json: exists already"));
  EXPECT_EQ(text_of(dir / "named.json"), "another's");
  EXPECT_EQ(softarm_program(check + dir / "link.json --force").status, 0);
  EXPECT_TRUE(fs::is_symlink(dir / "link.json"));

  // As /dev/stderr is: what it names is open already.
  fs::create_symlink("/proc/self/fd/2", dir / "open.json");
  const Outcome straight = softarm_program(check + dir / "open.json");
  EXPECT_EQ(straight.status, 0);
  EXPECT_THAT(straight.err, HasSubstr("\"recordings\""));
  EXPECT_TRUE(fs::is_symlink(dir / "open.json"));
  EXPECT_THAT(softarm_program(check + "/dev/fd/2").err, HasSubstr("\"recordings\""));
}

TEST(SoftarmErrors, NumbersThatAreNone) {
  const TestFolder dir;
  const std::string out = " --out " + dir / "x.bag";
  expect_refused(dir, "simulate demo --seconds nan" + out, HasSubstr("--seconds: nan is no number"));
  expect_refused(dir, "simulate demo --seed -1" + out, HasSubstr("--seed: -1 must be 0 or more"));
  expect_refused(dir, "estimate --arm online_200mm --window nan x.bag",
                 HasSubstr("--window: nan is no number"));
}

TEST(SoftarmErrors, NotOneFrameThatCanBeEstimatedIsAFailureWithItsReason) {
  const TestFolder dir;
  const std::string bag = dir / "trial.bag";
  ASSERT_EQ(softarm_program("simulate demo --seconds 2 --seed 3 --out " + bag).status, 0);
  const Outcome o = softarm_program("estimate --arm online_200mm --payload 0 --method cc_endpoint " + bag +
                                    " --out " + dir / "a");
  EXPECT_EQ(o.status, 0) << o.err;
  const Outcome none = softarm_program("estimate --arm single_chamber_85mm " + bag + " --out " + dir / "b");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, AllOf(HasSubstr("not one of 241 frames could be estimated: missing_payload ("),
                              HasSubstr("samples were not used: ")));
  EXPECT_THAT(none.out, HasSubstr("frames ok:"));  // what there is is said and written all the same
  EXPECT_TRUE(std::filesystem::exists(dir / "b/trial/estimates.csv"));
}

TEST(SoftarmErrors, ControlCharactersInNamesAreShown) {
  const TestFolder dir;
  const std::string bag = dir / "a\x1b[31mred.bag";
  ASSERT_EQ(softarm_program("simulate demo --seconds 2 --seed 3 --out '" + bag + "'").status, 0);
  const Outcome o = softarm_program("check --quiet --arm online_200mm '" + bag + "'");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("a\\x1b[31mred.bag"));
  EXPECT_EQ(o.out.find('\x1b'), std::string::npos);
}

TEST(SoftarmErrors, StandardOutputThatIsFull) {
  const TestFolder dir;
  const std::string stem = dir / "said", bag = " --arm online_200mm " + dir / "trial.bag";
  ASSERT_EQ(softarm_program("simulate demo --seconds 2 --seed 3 --out " + dir / "trial.bag").status, 0);
  for (const std::string& arguments :
       std::vector<std::string>{"diagnose --effects", "--version", "check --help", "check" + bag,
                                "check --quiet" + bag, "estimate" + bag + " --out " + dir / "out"}) {
    SCOPED_TRACE(arguments);
    const int raw =
        std::system((SOFTARM_PROGRAM_DIR "/softarm " + arguments + " >/dev/full 2>" + stem).c_str());
    ASSERT_TRUE(WIFEXITED(raw));
    EXPECT_GT(WEXITSTATUS(raw), 0);
    EXPECT_THAT(text_of(stem),
                AnyOf(HasSubstr("standard output cannot be written"), HasSubstr("No space left on device")));
  }
  EXPECT_THAT(text_of(dir / "out/trial/estimates.csv"), HasSubstr("\n"));  // that went elsewhere
}

TEST(SoftarmErrors, WhatAKilledProcessLeftIsRemovedAndWhatALivingOneWritesIsNot) {
  const TestFolder dir;
  // No process has that number: it is beyond what the kernel gives.
  dir.write(".x.bag.2147483646.partial", "half a bag");
  dir.write(".x.bag.1.partial", "another's");
  dir.write(".x.bag.note.partial", "no process at all");
  ASSERT_EQ(softarm_program("simulate demo --seconds 1 --seed 3 --out " + dir / "x.bag").status, 0);
  EXPECT_FALSE(std::filesystem::exists(dir / ".x.bag.2147483646.partial"));
  EXPECT_TRUE(std::filesystem::exists(dir / ".x.bag.1.partial"));
  EXPECT_TRUE(std::filesystem::exists(dir / ".x.bag.note.partial"));
}

/// Started as from a shell that does something first; its files are awaited, then it gets a signal.
/// @return as of waitpid
int status_after(int signal, const std::string& arguments, const std::string& before,
                 const std::function<bool()>& writes) {
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string line =
        before + "exec " SOFTARM_PROGRAM_DIR "/softarm " + arguments + " >/dev/null 2>&1";
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  for (int i = 0; i < 3000 && !writes(); ++i) usleep(20000);
  EXPECT_TRUE(writes()) << arguments;
  ::kill(child, signal);
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(SoftarmErrors, ASignalThatEndsTheProgramLeavesNothingOfItsFiles) {
  const TestFolder dir;
  const std::string bag = dir / "trial.bag";
  ASSERT_EQ(softarm_program("simulate demo --seconds 60 --seed 3 --out " + bag).status, 0);
  const std::size_t before = dir.entries();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    SCOPED_TRACE(signal);
    const auto expect_ended = [&](const std::string& arguments, std::size_t files) {
      const int status = status_after(signal, arguments, "", [&] { return dir.entries() >= before + files; });
      EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << arguments << ": " << status;
      EXPECT_EQ(dir.entries(), before) << "something was left behind";
    };
    expect_ended("simulate demo --seconds 1000 --seed 3 --out " + dir / "x.bag", 1);
    // Two folders are made for them.
    expect_ended("estimate --arm online_200mm " + bag + " --out " + dir / "out", 3);
  }
}

TEST(SoftarmErrors, ASignalThatIsIgnoredEndsNothing) {
  const TestFolder dir;
  const int status = status_after(SIGINT, "simulate demo --seconds 100 --seed 3 --out " + dir / "x.bag",
                                  "trap '' INT; ", [&] { return dir.entries() >= 1; });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(std::filesystem::exists(dir / "x.bag"));
}

constexpr const char* kSmallCampaign = R"(format: 1
name: small
arms: [{scenario: demo, arm: online_200mm}]
effects: {count_weights: [1]}
trials: {count: 2, seconds: 6}
)";

TEST(SoftarmErrors, TwoCampaignsWithOneFolder) {
  const TestFolder dir;
  const std::string small = dir.write("small.yaml", kSmallCampaign);
  const std::string campaign = "campaign " + small + " --cases 6 --seed 1 --out " + dir / "out";
  const std::string first = SOFTARM_PROGRAM_DIR "/softarm " + campaign + " >/dev/null 2>&1 & ";
  const Outcome second =
      softarm_program(campaign, first + "first=$!; while ! [ -e " + dir / "out.partial/case_001" +
                                    " ]; do kill -0 $first || exit 9; sleep 0.01; done; ");
  EXPECT_EQ(second.status, 1) << second.err;
  EXPECT_THAT(second.err, HasSubstr("another campaign is being written there"));
  for (int i = 0; i < 3000 && std::filesystem::exists(dir / "out.partial"); ++i) usleep(20000);
  EXPECT_TRUE(std::filesystem::exists(dir / "out/campaign.json"));
  // Of one that was killed.
  std::filesystem::create_directories(dir / "late.partial/case_001");
  dir.write("late.partial/case_001/left.bag", "half");
  const Outcome late = softarm_program("campaign " + small + " --cases 1 --seed 1 --out " + dir / "late");
  EXPECT_EQ(late.status, 0) << late.err;
  EXPECT_FALSE(std::filesystem::exists(dir / "late/case_001/left.bag"));
}

TEST(SoftarmErrors, Estimate) {
  const TestFolder dir;
  const std::string out = " --out " + dir / "out";
  const std::string text = dir.write("text.bag", "this is not a bag\n");
  const std::string empty = dir.write("empty.bag", "");
  expect_refused(dir, "estimate --arm online_200mm /nonexistent.bag" + out, HasSubstr("/nonexistent.bag"));
  expect_refused(dir, "estimate --arm online_200mm " + text + out,
                 AllOf(HasSubstr("text.bag"), HasSubstr("bag")));
  expect_refused(dir, "estimate --arm online_200mm " + empty + out, HasSubstr("empty.bag"));
  expect_refused(dir, "estimate --arm no_such_arm " + text + out,
                 AllOf(HasSubstr("no_such_arm"), HasSubstr("online_200mm")));
  expect_refused(dir, "estimate --arm online_200mm --method guess " + text + out,
                 AllOf(HasSubstr("guess"), HasSubstr("end_orientation")));
  expect_refused(dir, "estimate --arm online_200mm --unknown shape " + text + out, HasSubstr("payload"));
  expect_refused(dir, "estimate --arm online_200mm --payload -3 " + text + out, HasSubstr("-3"));
  expect_refused(dir, "estimate --arm online_200mm --window -1 " + text + out,
                 AllOf(HasSubstr("--window"), HasSubstr("60")));
  expect_refused(dir, "estimate --arm online_200mm --prior maybe " + text + out,
                 AllOf(HasSubstr("--prior"), HasSubstr("maybe"), HasSubstr("off")));
  expect_refused(dir, "estimate --arm online_200mm " + text + " " + text + out, HasSubstr("another bag"));
}

TEST(SoftarmErrors, ABagOfAnotherArmNamesTheTopicsOfBoth) {
  const TestFolder dir;
  const std::string layout = dir.write("lab.yaml", kLayout);
  const std::string csv = dir.write("a.csv", "0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\n");
  ASSERT_EQ(softarm_program("import " + layout + " " + csv + " --out " + dir / "a.bag").status, 0);
  expect_refused(dir, "estimate --arm online_200mm " + dir / "a.bag" + " --out " + dir / "out",
                 AllOf(HasSubstr("a.bag"), HasSubstr("/mocap/ring_1/pose"), HasSubstr("/mocap/base/pose")));
}

TEST(SoftarmErrors, ADamagedBagIsRefused) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 2 --out " + dir / "a.bag").status, 0);
  const std::string bytes = text_of(dir / "a.bag");
  dir.write("cut.bag", bytes.substr(0, bytes.size() / 2));
  std::string wrong = bytes;
  for (std::size_t i = 6000; i < 9000; ++i) wrong[i] = static_cast<char>(~wrong[i]);
  dir.write("wrong.bag", wrong);
  const std::string out = " --out " + dir / "out";
  dir.write("unindexed.bag", bytes.substr(0, bytes.size() - 100));
  for (const std::string& bag : {dir / "cut.bag", dir / "unindexed.bag"}) {
    expect_refused(dir, "estimate --arm online_200mm " + bag + out, EndsWith("rosbag reindex " + bag + "\n"));
  }
  for (const std::string& command :
       {std::string("estimate"), std::string("diagnose"), "identify --plot " + dir / "plots/of_it"}) {
    expect_refused(dir, command + " --arm online_200mm " + dir / "wrong.bag" + out,
                   AllOf(HasSubstr("wrong.bag: damaged at byte"), HasSubstr("rosbag reindex")));
  }
}

TEST(SoftarmErrors, Import) {
  const TestFolder dir;
  const std::string layout = dir.write("lab.yaml", kLayout);
  const std::string csv = dir.write("a.csv", "0,0,0,0,0,0,0,1\n");
  const std::string out = " --out " + dir / "a.bag";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = kLayout;
    return dir.write("changed.yaml", text.replace(text.find(from), from.size(), to));
  };
  dir.write("changed.yaml", "");
  expect_refused(dir, "import " + layout + " " + dir / "none.csv" + out, HasSubstr("none.csv"));
  expect_refused(dir, "import " + dir / "none.yaml" + " " + csv + out,
                 AllOf(HasSubstr("none.yaml"), HasSubstr("pouch_arm_one_segment")));
  expect_refused(
      dir, "import " + changed("unit: m\n", "unit: feet\n") + " " + csv + out,
      AllOf(HasSubstr("changed.yaml"), HasSubstr("mocap.unit"), HasSubstr("feet"), HasSubstr("mm")));
  expect_refused(dir, "import " + changed("column: 1", "column: none") + " " + csv + out,
                 AllOf(HasSubstr("time.column"), HasSubstr("none")));
  expect_refused(dir, "import " + changed("time:", "tmie:") + " " + csv + out, HasSubstr("tmie"));
  expect_refused(dir, "import " + changed("[5, 6, 7, 8]", "[15, 16, 17, 18]") + " " + csv + out,
                 AllOf(HasSubstr("a.csv"), HasSubstr("column 15")));
  expect_refused(dir, "import " + layout + " " + csv + " --out /nonexistent/a.bag",
                 HasSubstr("/nonexistent"));
}

TEST(SoftarmErrors, Simulate) {
  const TestFolder dir;
  const std::string bad = dir.write("bad.yaml", "format: 1\nname: bad\nseed: many\n");
  expect_refused(dir, "simulate " + bad + " --out " + dir / "x.bag", HasSubstr("bad.yaml"));
  expect_refused(dir, "simulate nothing --out " + dir / "x.bag",
                 AllOf(HasSubstr("nothing"), HasSubstr("demo")));
  expect_refused(dir, "simulate demo --seconds 1 --out " + dir / "x.bag" + " --truth " + dir / "x.bag",
                 HasSubstr("--truth"));
  expect_refused(dir, "simulate demo --seconds 1 --out ''", HasSubstr("--out: ''"));
  expect_refused(dir, "simulate demo --seconds 1 --truth '' --out " + dir / "x.bag",
                 HasSubstr("--truth: ''"));
}

}  // namespace
}  // namespace softarm
