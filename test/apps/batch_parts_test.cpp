// What a batch is made of: lists of jobs, their folders, tables.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "apps/program.h"
#include "softarm/batch/child.h"
#include "softarm/batch/course.h"
#include "softarm/batch/figures.h"
#include "softarm/batch/job_folder.h"
#include "softarm/batch/job_list.h"
#include "softarm/batch/run_job.h"
#include "softarm/batch/slurm_commands.h"
#include "softarm/batch/table.h"
#include "softarm/batch/version.h"
#include "softarm/command.h"

namespace softarm::app::batch {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string failure_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

/// Folders with files that only have the names of bags.
class BatchList : public ::testing::Test {
 protected:
  BatchList() {
    for (const char* bag : {"monday/a.bag", "monday/b.bag", "monday/.c.bag.1.partial", "tuesday/a.bag",
                            "tuesday/deep/d.bag", "tuesday/notes.md"}) {
      fs::create_directories(fs::path(dir_ / bag).parent_path());
      dir_.write(bag, bag);
    }
    fs::create_directories(dir_ / "empty");
  }

  std::vector<Job> list(const std::string& work, const std::vector<std::string>& inputs,
                        const std::string& arm = "usual") const {
    return list_jobs({work,
                      arm,
                      {{"--window", "0.5"}},
                      inputs,
                      {{"--window", true}, {"--payload", true}, {"--hold", true}, {"--quiet", false}},
                      [](const std::string& name, const std::string&) { return "/arms/" + name; }});
  }
  std::string text_list(const std::string& text) const { return dir_.write("list.txt", text); }
  std::string yaml_list(const std::string& text) const { return dir_.write("list.yaml", text); }
  std::vector<std::string> bags(const Job& job) const {
    std::vector<std::string> names;
    for (const std::string& bag : job.bags)
      names.push_back(fs::path(bag).lexically_relative(dir_.path()).string());
    return names;
  }

  TestFolder dir_;
};

std::vector<std::string> names_of(const std::vector<Job>& jobs) {
  std::vector<std::string> names;
  for (const Job& job : jobs) names.push_back(job.wanted_name);
  return names;
}

std::string typed(const Job& job) {
  std::string text;
  for (const Word& word : job.options)
    text += (text.empty() ? "" : " ") + word.name + (word.value ? " " + *word.value : "");
  return text;
}

TEST_F(BatchList, AnEstimateIsOfABagADiagnosisOfAFolder) {
  const std::vector<Job> estimates = list("estimate", {dir_ / "monday", dir_ / "tuesday"});
  EXPECT_THAT(names_of(estimates), ElementsAre("monday_a", "monday_b", "tuesday_a", "deep_d"));
  EXPECT_EQ(estimates[0].arm, "/arms/usual");
  EXPECT_EQ(typed(estimates[0]), "--window 0.5");
  const std::vector<Job> diagnoses = list("diagnose", {dir_.path()});
  EXPECT_THAT(names_of(diagnoses), ElementsAre("monday", "tuesday", "deep"));
  EXPECT_THAT(bags(diagnoses[0]), ElementsAre("monday/a.bag", "monday/b.bag"));
}

TEST_F(BatchList, PatternsMatchAndNothingComesTwice) {
  EXPECT_THAT(names_of(list("check", {dir_ / "*/a.bag"})), ElementsAre("monday_a", "tuesday_a"));
  EXPECT_THAT(names_of(list("check", {dir_ / "*/a.bag", dir_ / "monday/a.bag", dir_ / "monday"})),
              ElementsAre("monday_a", "tuesday_a", "monday_b"));
  EXPECT_THAT(names_of(list("diagnose", {dir_ / "mon*", dir_ / "monday/a.bag"})), ElementsAre("monday"));
}

TEST_F(BatchList, ALineOfATextIsAJob) {
  const std::vector<Job> jobs =
      list("diagnose", {text_list("# of last week\n"
                                  "--arm one.yaml monday   # good ones\r\n"
                                  "\n"
                                  "monday/a.bag 'tuesday/a.bag' --payload=0.2 --window 2\n")});
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].arm, "/arms/one.yaml");
  EXPECT_EQ(typed(jobs[0]), "--window 0.5");
  EXPECT_EQ(jobs[1].arm, "/arms/usual");
  EXPECT_THAT(bags(jobs[1]), ElementsAre("monday/a.bag", "tuesday/a.bag"));
  EXPECT_EQ(typed(jobs[1]), "--payload 0.2 --window 2");
}

TEST_F(BatchList, AYamlListHasNamesArmsAndOptions) {
  const std::string text =
      "arm: lab.yaml\noptions: --payload 0.1\njobs:\n"
      "  - monday\n"
      "  - {name: second, arm: other.yaml, bags: [tuesday/a.bag, tuesday/deep], options: [--hold, 'a b', "
      "--payload, '0.3']}\n";
  const std::vector<Job> jobs = list("diagnose", {yaml_list(text)}, "");
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].arm, "/arms/lab.yaml");
  EXPECT_EQ(typed(jobs[0]), "--window 0.5 --payload 0.1");
  EXPECT_EQ(jobs[1].wanted_name, "second");
  EXPECT_EQ(jobs[1].arm, "/arms/other.yaml");
  EXPECT_THAT(bags(jobs[1]), ElementsAre("tuesday/a.bag", "tuesday/deep/d.bag"));
  EXPECT_EQ(typed(jobs[1]), "--window 0.5 --hold a b --payload 0.3");
  EXPECT_THAT(names_of(list("estimate", {yaml_list(text)}, "")),
              ElementsAre("monday_a", "monday_b", "second_a", "second_d"));
}

TEST_F(BatchList, WhatCannotBeIsSaidWithItsPlace) {
  const auto said = [&](const std::string& input, const std::string& arm = "usual") {
    return failure_of([&] { list("diagnose", {input}, arm); });
  };
  EXPECT_EQ(said(dir_ / "nothing.bag"), dir_ / "nothing.bag" + std::string(": no such bag or folder"));
  EXPECT_EQ(said(dir_ / "*.dat"), dir_ / "*.dat" + std::string(": nothing matches"));
  EXPECT_EQ(said(dir_ / "none.txt"), dir_ / "none.txt" + std::string(": no such list"));
  EXPECT_THAT(said(dir_ / "monday", ""), HasSubstr("no arm: give --arm"));
  const std::string list_name = dir_ / "list.txt", yaml_name = dir_ / "list.yaml";
  EXPECT_EQ(said(text_list("\n--arm a empty")),
            list_name + ":2: " + (dir_ / "empty") + ": there is no .bag in this folder");
  // All at once: a list of a thousand is mended in one go.
  EXPECT_EQ(said(text_list("--arm a no_1 monday\n--arm a monday/a.bag no_2\n")),
            list_name + ":1: no_1: no such bag or folder; " + list_name + ":2: no_2: no such bag or folder");
  std::string many = "--arm a";
  for (int i = 1; i <= 22; ++i) many += fmt::format(" n{}", i);
  EXPECT_THAT(said(text_list(many + "\n")), ::testing::EndsWith("n20: no such bag or folder; and 2 more"));
  EXPECT_EQ(said(text_list("--arm a 'monday")), list_name + ":1: a quote ' is not closed");
  EXPECT_THAT(said(text_list("--arm a --payloat 1 monday")),
              HasSubstr(list_name + ":1: no option '--payloat'; there are"));
  EXPECT_EQ(said(text_list("--arm a monday --payload")), list_name + ":1: --payload has no value");
  EXPECT_EQ(said(text_list("--arm a")), list_name + ":1: names no bag");
  EXPECT_EQ(said(text_list("# nothing")), list_name + ": names no job");
  EXPECT_EQ(said(yaml_list("arm: a\njobs:\n  - {bag: monday}\n")),
            yaml_name + ":3: unknown key 'bag', did you mean 'bags'?; there are arm, bags, name, options");
  EXPECT_EQ(said(yaml_list("arm: a\njobs: monday\n")), yaml_name + ": key 'jobs' must be a list of jobs");
  EXPECT_THAT(said(yaml_list("arm: [a\n")), HasSubstr(yaml_name + ":"));
}

/// A folder of jobs, and jobs over real files.
class BatchFolders : public ::testing::Test {
 protected:
  BatchFolders() { dir_.write("arm.yaml", "an arm"); }

  Job job(const std::string& name, const std::vector<std::string>& bags) const {
    Job job{"estimate", dir_ / "arm.yaml", {}, {}, name};
    for (const std::string& bag : bags) job.bags.push_back(dir_.write(bag, bag));
    return job;
  }
  std::vector<std::string> names(const std::vector<Job>& jobs, bool force = false) const {
    std::vector<std::string> names;
    const std::vector<JobFolder> folders = find_folders(dir_ / "jobs", jobs, force);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      names.push_back(folders[i].name());
      folders[i].write_order(jobs[i]);
    }
    return names;
  }
  JobFolder done(const Job& job) const {
    const JobFolder folder(dir_ / "jobs/done");
    folder.write_order(job);
    fs::create_directories(folder.result());
    std::ofstream(folder.result() / "estimates.csv") << "a result";
    Outcome outcome;
    outcome.done = true;
    outcome.version = program_version();
    outcome.order_sha256 = digest_of(job);
    outcome.inputs = note_inputs(job);
    folder.write_outcome(outcome);
    return folder;
  }

  TestFolder dir_;
};

TEST_F(BatchFolders, AJobKeepsItsFolderWhenTheListGrows) {
  const Job a = job("day_t", {"a.bag"}), b = job("day_t", {"b.bag"}), c = job("day_t", {"c.bag"});
  EXPECT_THAT(names({a}), ElementsAre("day_t"));
  EXPECT_THAT(names({b, a}), ElementsAre("day_t_2", "day_t"));
  EXPECT_THAT(names({c, b}), ElementsAre("day_t_3", "day_t_2"));  // that of a stays
  EXPECT_THAT(names({job("../o dd:ü", {"d.bag"})}), ElementsAre("_._o_dd___"));
}

TEST_F(BatchFolders, AFolderOfAnotherCommandIsNotTakenUnasked) {
  Job a = job("day", {"a.bag", "b.bag"});
  EXPECT_THAT(names({a}), ElementsAre("day"));
  EXPECT_THAT(names({job("day", {"a.bag", "b.bag", "c.bag"})}), ElementsAre("day"));  // one more trial
  Job other = a;
  other.options.push_back({"--payload", "0.2"});
  EXPECT_THAT(
      failure_of([&] { names({other}); }),
      HasSubstr("jobs/day: exists already, with another arm file or other options; --force repeats it"));
  EXPECT_THAT(names({other}, true), ElementsAre("day"));
  EXPECT_THAT(names({other, a}), ElementsAre("day", "day_2"));  // both are asked for
}

TEST_F(BatchFolders, WhatIsDoneHoldsWhileItsFilesDo) {
  const Job a = job("a", {"a.bag"});
  const JobFolder folder = done(a);
  EXPECT_EQ(folder.standing(a), Standing::kDone);
  fs::last_write_time(a.bags[0], fs::last_write_time(a.bags[0]) + std::chrono::hours(1));
  EXPECT_EQ(folder.standing(a), Standing::kDone) << "the same bytes";
  dir_.write("a.bag", "A.BAG");
  EXPECT_EQ(folder.standing(a), Standing::kChanged) << "as many bytes, but others";
  dir_.write("a.bag", "a.bag");
  EXPECT_EQ(folder.standing(a), Standing::kDone);
  dir_.write("arm.yaml", "a mended arm");
  EXPECT_EQ(folder.standing(a), Standing::kChanged);
  dir_.write("arm.yaml", "an arm");
  Job other = a;
  other.options.push_back({"--quiet", std::nullopt});
  EXPECT_EQ(folder.standing(other), Standing::kChanged);
  fs::remove(a.bags[0]);
  EXPECT_EQ(folder.standing(a), Standing::kChanged);
}

TEST_F(BatchFolders, AResultThatIsGoneOrCutOffIsDoneAgain) {
  const Job a = job("a", {"a.bag"});
  const JobFolder folder = done(a);
  std::ofstream(folder.result() / "estimates.csv") << "a";
  EXPECT_EQ(folder.standing(a), Standing::kChanged);
  const JobFolder again = done(a);
  EXPECT_EQ(again.standing(a), Standing::kDone);
  fs::remove_all(again.result());
  EXPECT_EQ(again.standing(a), Standing::kChanged);
  std::ofstream(again.path() / "outcome.json")
      << R"({"format": 1, "status": "do)";  // a machine that lost its power
  EXPECT_EQ(again.standing(a), Standing::kNew);
}

TEST_F(BatchFolders, AFailureStaysUntilItsFilesChange) {
  const Job a = job("a", {"a.bag"});
  const JobFolder folder = done(a);
  Outcome outcome = *folder.outcome();
  outcome.done = false;
  outcome.reason = "no frame";
  folder.write_outcome(outcome);
  EXPECT_EQ(folder.standing(a), Standing::kFailed);
  EXPECT_EQ(folder.outcome()->reason, "no frame");
  outcome.version = "0.0.1";
  folder.write_outcome(outcome);
  EXPECT_EQ(folder.standing(a), Standing::kChanged) << "another version may know better";
}

TEST_F(BatchFolders, ARunWritesWhatBecameOfIt) {
  const Job a = job("a", {"a.bag"});
  const JobFolder folder(dir_ / "jobs/run");
  folder.write_order(a);
  const auto program = [&](const std::string& text) {
    const std::string path = dir_.write("program", "#!/bin/sh\n" + text);
    fs::permissions(path, fs::perms::owner_all);
    return path;
  };
  const auto run = [&](const std::string& text, bool stop = false) {
    return run_job(folder, program(text), 3, [=] { return stop; });
  };
  const std::optional<Outcome> good = run("echo \"$@\" > " + (folder.result() / "said").string());
  ASSERT_TRUE(good && good->done);
  EXPECT_EQ(text_of(folder.result() / "said"), "estimate --arm " + a.arm + " --jobs 3 --out " +
                                                   folder.result().string() + " " + a.bags[0] + "\n");
  EXPECT_EQ(folder.standing(a), Standing::kDone);
  const std::optional<Outcome> bad = run("echo softarm: no frame >&2; echo softarm: note: else >&2; exit 1");
  ASSERT_TRUE(bad);
  EXPECT_FALSE(bad->done);
  EXPECT_EQ(bad->reason, "no frame");
  EXPECT_FALSE(fs::exists(folder.result() / "said")) << "of the run before";
  EXPECT_EQ(run("kill -9 $$")->reason, "ended by signal 9 (killed; was there enough memory?)");
  EXPECT_EQ(run("exit 3")->reason, "exit status 3, without a message");
  EXPECT_FALSE(run("sleep 60", true).has_value());
  int asked = 0;  // the whole job is ended, the child before it is known
  EXPECT_FALSE(run_job(folder, program("kill -15 $$"), 1, [&] {
                 return ++asked > 3 && fs::exists(folder.log());
               }).has_value());
  EXPECT_EQ(folder.standing(a), Standing::kNew);
  fs::remove(a.bags[0]);
  EXPECT_EQ(run("exit 0")->reason, a.bags[0] + ": no such file");
}

TEST(BatchReason, IsTheErrorLineOfALog) {
  EXPECT_EQ(reason_in("softarm: warning: dark\n[##] 3 %\rsoftarm: a.bag: cut off\nsoftarm: note: x\n"),
            "a.bag: cut off");
  EXPECT_EQ(reason_in("begun\nterminate called\n"), "terminate called");
  EXPECT_EQ(reason_in("softarm: a\x1b[31mb\n"), "a [31mb");
  EXPECT_EQ(reason_in("softarm: " + std::string(299, 'x') + "\xC3\xBC\n"), std::string(299, 'x') + "...");
}

TEST(BatchFigures, OfADiagnosis) {
  const std::vector<Figure> figures = figures_of_diagnosis(
      R"({"verdict": "explained", "noise_floor_m": 2e-4, "baseline": {"held_out_rms_m": 0.002},
          "extended": {"held_out_rms_m": 0.0003}, "left_out_share": 0.2,
          "effects": [{"name": "torsion", "probability": 0.98}, {"name": "creep", "probability": 0.9}],
          "ranking": [{"name": "torsion", "probability": 0.98}]})");
  EXPECT_EQ(headline(figures), "explained, torsion creep");
  const std::string csv =
      to_csv({{{"diagnose", "/a.yaml", {"/b 1.bag", "/c.bag"}, {}, ""}, "day", "done", "", "", "", figures}});
  EXPECT_EQ(
      csv,
      "job,state,verdict,effects,probability_of_first,likeliest,probability_of_likeliest,held_out_rms_m,"
      "held_out_rms_extended_m,noise_floor_m,left_out_share,discrepancy_share,reason,arm,bags,options,"
      "result\n"
      "day,done,explained,torsion creep,0.98,torsion,0.98,0.002,0.0003,0.0002,0.2,,,/a.yaml,/b 1.bag /c.bag,,"
      "jobs/day/result\n");
  EXPECT_THAT(failure_of([] { figures_of_diagnosis("{\"verd"); }), HasSubstr("no JSON"));
}

TEST(BatchFigures, OfACheck) {
  EXPECT_EQ(headline(figures_of_check(
                R"({"recordings": [{"worst": "serious", "duration_s": 3, "findings": [
                    {"id": "units", "severity": "serious"}, {"id": "gap", "severity": "warning"},
                    {"id": "units", "severity": "serious"}]}]})")),
            "serious, units");
  EXPECT_EQ(headline(figures_of_check(R"({"recordings": [{"worst": "information", "findings": []}]})")),
            "nothing wrong");
}

TEST(BatchFigures, OfAnEstimateOfTwoSegments) {
  const std::vector<Figure> figures = figures_of_estimate(
      "bag:                        t.bag\nduration:                   6.000 s\nframes:                     "
      "721\n"
      "rms residual, median:       0.6991 mm\nsegment 1 EI, median:       0.03 N m^2\n"
      "  identifiable in:          318 frames (44.1 %)\n  median where identifiable:0.034 N m^2\n"
      "segment 2 EI, median:       -\npayload, median:            0.15 kg (known)\n");
  std::string text;
  for (const Figure& figure : figures)
    text += figure.column + (figure.number ? fmt::format("={:.6g} ", *figure.number) : "=- ");
  EXPECT_EQ(text,
            "duration_s=6 frames=721 rms_residual_m=0.0006991 segment_1_EI_nm2=0.03 "
            "segment_1_EI_identifiable_frames=318 "
            "segment_1_EI_where_identifiable_nm2=0.034 segment_2_EI_nm2=- payload_kg=0.15 ");
}

/// Jobs of these durations, `at_a_time` of them; at each second from a fifth of the way on: the time left
/// that a bar would say against what it is.
double worst_ratio(const std::vector<double>& durations_s, const std::vector<double>& weights,
                   std::size_t at_a_time) {
  Course course(weights);
  std::vector<double> ends_s;  // of the jobs that run, by the place in which they run
  double whole_s = 0.0;
  {
    std::vector<double> free_s(at_a_time, 0.0);
    for (const double duration_s : durations_s) {
      const auto first = std::min_element(free_s.begin(), free_s.end());
      ends_s.push_back(*first += duration_s);
      whole_s = std::max(whole_s, *first);
    }
  }
  double all = 0.0, worst = 1.0;
  for (const double weight : weights) all += weight;
  for (double now_s = 0.5; now_s < whole_s - 0.5; now_s += 1.0) {
    for (std::size_t i = 0; i < durations_s.size(); ++i) {
      if (ends_s[i] - durations_s[i] <= now_s && ends_s[i] - durations_s[i] > now_s - 1.0)
        course.begin(i, ends_s[i] - durations_s[i]);
      if (ends_s[i] <= now_s && ends_s[i] > now_s - 1.0) course.end(i, ends_s[i]);
    }
    const double share = course.done(now_s) / all;
    EXPECT_LT(share, 1.0);
    if (now_s < 0.2 * whole_s) continue;
    const double shortly_s = 0.02 * whole_s;  // the last seconds are no matter
    const double ratio = (now_s * (1.0 - share) / share + shortly_s) / (whole_s - now_s + shortly_s);
    worst = std::max({worst, ratio, 1.0 / ratio});
  }
  return worst;
}

TEST(BatchCourse, TheTimeLeftIsRightFromAFifthOn) {
  EXPECT_LT(worst_ratio(std::vector<double>(12, 100.0), std::vector<double>(12, 1.0), 2), 1.3);
  EXPECT_LT(worst_ratio(std::vector<double>(40, 30.0), std::vector<double>(40, 5.0), 4), 1.2);
  std::vector<double> durations_s, weights;
  for (int i = 0; i < 30; ++i) {  // of which a third are three times as long, as their bags say
    weights.push_back(i % 3 == 0 ? 3.0 : 1.0);
    durations_s.push_back(20.0 * weights.back() * (i % 2 == 0 ? 1.15 : 0.85));
  }
  EXPECT_LT(worst_ratio(durations_s, weights, 2), 1.5);
}

TEST(BatchTable, QuotesWhatIsInTheWayAndKeepsFailures) {
  TableRow bad{{"estimate", "/a.yaml", {"/x.bag"}, {{"--window", "1"}}, ""},
               "x",
               "failed",
               "a \"b\", c",
               "",
               "jobs/x/log.txt",
               {}};
  TableRow good{{"estimate", "/a.yaml", {"/y.bag"}, {}, ""},
                "y",
                "done",
                "",
                "jobs/y/s.txt",
                "",
                {{"frames", "frames", 3.0, ""}}};
  good.seconds = 2.0;
  EXPECT_EQ(to_csv({bad, good}),
            "job,state,frames,reason,arm,bags,options,result\n"
            "x,failed,,\"a \"\"b\"\", c\",/a.yaml,/x.bag,--window 1,\n"
            "y,done,3,,/a.yaml,/y.bag,,jobs/y/result\n");
  const report::TablePage page = table_page("estimate", {bad, good}, "");
  EXPECT_EQ(page.verdict, "1 of 2 done");
  EXPECT_FALSE(page.whole);
  EXPECT_TRUE(page.rows[0].marked);
  EXPECT_EQ(page.rows[1].cells[0].link, "jobs/y/s.txt");
  ASSERT_EQ(page.columns.size(), page.rows[0].cells.size());
  EXPECT_EQ(page.rows[0].cells[2].text, "a \"b\", c");
  EXPECT_EQ(page.columns[3].kind, report::TablePage::Column::kNumbers);
}

TEST(BatchSlurm, ReadsWhatItsCommandsSay) {
  const std::vector<SlurmTask> tasks = parse_queue(
      "softarm_1|12|0|R|None\nslurm_load_jobs error\nother|13|N/A|PD|Resources\n"
      "softarm_1|12|40|PD|Nodes required for job are DOWN\n");
  ASSERT_EQ(tasks.size(), 2U);
  EXPECT_EQ(tasks[1].array_id, "12");
  EXPECT_EQ(tasks[1].index, 40U);
  EXPECT_EQ(tasks[1].reason, "Nodes required for job are DOWN");
  EXPECT_EQ(parse_end("JobId=3 JobState=TIMEOUT Reason=TimeLimit Dependency=(null) ExitCode=0:15"),
            "TIMEOUT (TimeLimit), exit code 0:15");
  EXPECT_EQ(parse_end("JobId=3 JobState=COMPLETED Reason=None ExitCode=0:0"), "COMPLETED");
  EXPECT_THAT(parse_end("Job 1_2 not found"), IsEmpty());
}

}  // namespace
}  // namespace softarm::app::batch
