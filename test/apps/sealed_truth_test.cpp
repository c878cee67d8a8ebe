// What is hidden in a trial stands in the sealed truth and nowhere in the recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "program.h"
#include "rig/hidden.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kSealedScenario[] = R"(format: 1
name: whispered_name
seed: 987654321
duration_s: 4
arm:
  length_m: 0.2
  mass_kg: 0.2
  bending_stiffness: {base_nm2: 0.0271828}
  chambers: [{bending_direction_deg: 0, moment_gain_nm_per_pa: 6.1e-6}]
mount: {attitude: horizontal}
pressures: {settle_s: 0.2, ramp_s: 0.5, random: {max_pa: 30000}}
payload: {schedule: [{t_s: 0, kg: 0.05}]}
hidden:
  - {effect: base_compliance, stiffness_nm_per_rad: 6.789123}
  - {effect: gain_nonlinearity, form: saturating, share: 0.123456}
)";

/// As it stands in memory.
std::string bytes_of(double value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

TEST(SealedTruth, ASearchOfTheBagFindsNothing) {
  const TestFolder folder;
  const std::string scenario = folder.write("whispered_name.yaml", kSealedScenario);
  const Outcome done = softarm_program("simulate " + scenario + " --out " + (folder / "trial.bag"));
  ASSERT_EQ(done.status, 0) << done.err;
  const std::string bag = text_of(folder / "trial.bag"), truth = text_of(folder / "trial.truth.yaml");
  ASSERT_THAT(bag, HasSubstr("/mocap/ring_1/pose"));       // the bag is not compressed: the search can find
  ASSERT_NE(bag.find(bytes_of(0.05)), std::string::npos);  // the known payload, as a number
  std::vector<std::string> secrets{"whispered", "987654321", "base_nm2", "hidden", folder.path()};
  // Ids are words, and some stand in the definitions of messages: not those that a trial without secrets has
  // too.
  std::string open_text = kSealedScenario;
  open_text.erase(open_text.find("hidden:"));
  const Outcome open =
      softarm_program("simulate " + folder.write("open.yaml", open_text) + " --out " + (folder / "open.bag"));
  ASSERT_EQ(open.status, 0) << open.err;
  const std::string open_bag = text_of(folder / "open.bag");
  std::size_t ids = 0;
  for (const rig::HiddenEffect& effect : rig::hidden_effects()) {
    if (open_bag.find(effect.id) != std::string::npos) continue;
    secrets.push_back(effect.id);
    ++ids;
  }
  EXPECT_GE(ids + 3, rig::hidden_effects().size());
  for (const std::string& secret : secrets) EXPECT_EQ(bag.find(secret), std::string::npos) << secret;
  for (const double number : {6.789123, 0.123456, 0.0271828, 6.1e-6})
    EXPECT_EQ(bag.find(bytes_of(number)), std::string::npos) << number;
  for (const char* known : {"base_compliance", "6.789123", "gain_nonlinearity", "saturating", "0.123456",
                            "987654321", "0.0271828"})
    EXPECT_THAT(truth, HasSubstr(known));
}

TEST(SealedTruth, TheDigestsArePrintedKeptAndNoticeAChange) {
  const TestFolder folder;
  const std::string scenario = folder.write("scenario.yaml", kSealedScenario);
  const Outcome done = softarm_program("simulate " + scenario + " --out " + (folder / "trial.bag"));
  ASSERT_EQ(done.status, 0) << done.err;
  const std::string seal = text_of(folder / "trial.truth.sha256");
  ASSERT_GE(seal.size(), 64u);
  EXPECT_THAT(done.out, HasSubstr(seal.substr(0, 64)));
  const std::string check = "cd '" + folder.path() + "' && sha256sum --check --status trial.truth.sha256";
  EXPECT_EQ(std::system(check.c_str()), 0);
  folder.write("trial.truth.yaml", text_of(folder / "trial.truth.yaml") + "\n");
  EXPECT_NE(std::system(check.c_str()), 0);
}

TEST(SealedTruth, NothingIsWrittenByATrialThatFails) {
  const TestFolder folder;
  std::string text = kSealedScenario;
  // Stiffer by pressure than by nothing at all: negative at the first one.
  text.replace(text.find("base_nm2: 0.0271828"), 19,
               "base_nm2: 0.0271828, per_min_pressure_nm2_per_pa: -1e-5");
  const std::string scenario = folder.write("scenario.yaml", text);
  const Outcome done = softarm_program("simulate " + scenario + " --out " + (folder / "trial.bag"));
  EXPECT_NE(done.status, 0);
  EXPECT_THAT(done.err, HasSubstr("the laws give EI"));
  EXPECT_EQ(folder.entries(), 1u);  // the scenario alone
}

TEST(SoftarmCampaign, TellsTheLaboratoryNothingAndIsTheSameAgain) {
  const TestFolder folder;
  folder.write("small.yaml", kSealedScenario);
  const std::string campaign =
      folder.write("secret_campaign.yaml",
                   "format: 1\nname: secret_campaign\narms: [{scenario: " + (folder / "small.yaml") +
                       ", arm: online_200mm}]\n"
                       "effects: {count_weights: [0, 1], from: [pressure_lag, tip_mass]}\n"
                       "trials: {count: 2, seconds: 3}\n");
  const auto run = [&](const std::string& out, const std::string& jobs) {
    return softarm_program("campaign " + campaign + " --cases 3 --seed 424242 --jobs " + jobs + " --out " +
                           (folder / out));
  };
  const Outcome first = run("first", "1"), second = run("second", "2");
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(second.status, 0) << second.err;
  const std::string known = text_of(folder / "first/campaign.json"),
                    truth = text_of(folder / "first/truth/cases.json");
  EXPECT_THAT(known, HasSubstr("case_003/trial_02.bag"));
  EXPECT_THAT(known, HasSubstr("online_200mm"));
  for (const char* secret : {"secret", "424242", "pressure_lag", "tip_mass", "seed"}) {
    EXPECT_THAT(known, Not(HasSubstr(secret)));
    EXPECT_EQ(text_of(folder / "first/case_003/trial_02.bag").find(secret), std::string::npos);
  }
  EXPECT_THAT(truth, HasSubstr("424242"));
  for (const char* file : {"campaign.json", "truth/SHA256SUMS", "truth/cases.json", "case_001/trial_01.bag"})
    EXPECT_EQ(text_of((folder / "first/") + file), text_of((folder / "second/") + file)) << file;
  EXPECT_EQ(
      std::system(("cd '" + (folder / "first/truth") + "' && sha256sum --check --status SHA256SUMS").c_str()),
      0);
  // Into a folder that holds something: refused, and what is there stays.
  const Outcome again = run("first", "1");
  EXPECT_NE(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("exists already"));
  EXPECT_EQ(text_of(folder / "first/campaign.json"), known);
}

}  // namespace
}  // namespace softarm
