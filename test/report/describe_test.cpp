// What the terminal says.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "diagnose/pictures.h"
#include "example_diagnosis.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Without line breaks and indents: what is said, not how it is laid out.
std::string flowing(const std::string& text) {
  std::istringstream words(text);
  std::string all, word;
  while (words >> word) all += (all.empty() ? "" : " ") + word;
  return all;
}

TEST(Describe, SaysWhereWhatHowLargeAndHowSure) {
  const std::string text = flowing(report::describe(testing::example_diagnosis()));
  EXPECT_THAT(text, StartsWith("EXPLAINED: The base yields under load"));
  EXPECT_THAT(text, HasSubstr("where at the base, in the plane of bending, always, goes with payload"));
  EXPECT_THAT(text, HasSubstr("what the base yields under load (base_compliance)"));
  EXPECT_THAT(
      text, HasSubstr("how large rotational stiffness of the base: 5.2 N m/rad (90 % interval 4.6 to 5.9)"));
  EXPECT_THAT(text, HasSubstr("how sure 93 %"));
  EXPECT_THAT(text, HasSubstr("mistaken for rigid_ends or shear"));
  EXPECT_THAT(text, HasSubstr("how large half width of the loop: 2.48 kPa (90 % interval 2.21 to 2.76)"));
  EXPECT_THAT(text, HasSubstr("where 30 to 170 mm from the base"));
  EXPECT_THAT(text,
              HasSubstr("Small departures, as every arm has them: - marker_slip: A ring sits elsewhere than "
                        "the arm file says, 100 mm from the base; offset along the arm: 0.31 mm (90 % "
                        "interval 0.22 to 0.40); probability over 99 %."));
  EXPECT_THAT(text,
              HasSubstr("In the model too, and likely to stand in for something else: - axial_memory: The "
                        "arm keeps lengthening or shortening while its inputs are held, along the arm; time "
                        "constant: 2.7 s (90 % interval 1.2 to 4.2); probability under 1 %."));
}

TEST(Describe, SaysWhatWasLearntOfTheRest) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  EXPECT_THAT(
      flowing(report::describe(d)),
      HasSubstr("A law that was learnt from what is left (learned_moment in arm_extended.yaml): - What no "
                "effect of the catalogue explains goes with chamber_2 minus its first-order lag"));
  EXPECT_THAT(
      flowing(report::describe(d)),
      HasSubstr("law M = (-1.20, 2.10) mN m (u - w) / (-14.1 kPa); u: chamber_2; w follows it: 1.00 s dw/dt "
                "= u - w source line of first order; pneumatics of a soft arm: A. D. Marchese"));
  EXPECT_THAT(flowing(report::describe(d)),
              HasSubstr("method stability selection: N. Meinshausen, P. Buhlmann, J. R. Stat. Soc. B 72, "
                        "2010, doi:10.1111/j.1467-9868.2010.00740.x"));
  d.discovered_law->terms[1].source = d.discovered_law->terms[0].source;  // which is said once
  EXPECT_THAT(flowing(report::describe(d)),
              HasSubstr("1.00 s dw/dt = u - w law M = (-1.20 k + 2.10 R k) mN m"));
  d.discovered_law.reset();
  EXPECT_THAT(flowing(report::describe(d)), Not(HasSubstr("learnt")));
}

TEST(Describe, SaysHowMuchBetterAndWhatNext) {
  const std::string text = flowing(report::describe(testing::example_diagnosis()));
  EXPECT_THAT(text,
              HasSubstr("On unseen trials the bodies are 0.70 mm off on average, 1.00 mm at most; without "
                        "these effects 1.95 mm off on average, 3.00 mm at most; noise alone makes 0.80 mm."));
  EXPECT_THAT(text, HasSubstr("and 98 % of what could be explained is explained."));
  EXPECT_THAT(text, Not(HasSubstr("WORSE")));
  EXPECT_THAT(text, HasSubstr("Measure next: Hang the arm sideways"));
  EXPECT_THAT(text, HasSubstr("It would separate base_compliance, rigid_ends and shear from one another by "
                              "7.4 standard deviations; the present trials do so by 0.8."));
  EXPECT_THAT(text, HasSubstr("it hides in the variation of the parameters."));
  diagnose::Diagnosis brief = testing::example_diagnosis();
  brief.next_experiment->sentence.clear();
  EXPECT_THAT(flowing(report::describe(brief)),
              HasSubstr("It would separate base_compliance, rigid_ends and shear by about 7.4 standard"));
  EXPECT_THAT(text, HasSubstr("EI 0.0341 +- 0.0004 -> 0.0379 +- 0.0006 N m^2 +11.1 %"));
  EXPECT_THAT(text, HasSubstr("payload 57.1 +- 2.1 -> 50.2 +- 1.4 g -12.1 %"));
  EXPECT_THAT(text, HasSubstr("and has no pattern left"));
}

/// Whatever the errors weighted by precision do: what people read are plain ones, and what got worse is said.
TEST(Describe, NoHeadlineImprovesWhileThePlainErrorGrows) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.extended.held_out_mean_m = 1.2 * d.baseline.held_out_mean_m;
  d.trials[1].mean_after_m = 2.0 * d.trials[1].mean_before_m;
  d.trials[4].mean_after_m = 3.0 * d.trials[4].mean_before_m;
  EXPECT_LT(d.extended.held_out_rms_m, d.baseline.held_out_rms_m);
  for (const auto verdict : {diagnose::Verdict::kExplained, diagnose::Verdict::kPartlyExplained}) {
    d.verdict = verdict;
    d.summary = diagnose::summary_of(d, 4);
    EXPECT_THAT(flowing(report::describe(d)),
                HasSubstr("the mean error on unseen trials GROWS from 1.95 mm to "));
    EXPECT_THAT(d.summary, Not(HasSubstr("falls")));
  }
  const std::string text = flowing(report::describe(d));
  EXPECT_THAT(text, HasSubstr("WORSE in 2 of 9 trials: middle_side ("));
  EXPECT_THAT(text, HasSubstr(" and slow_side ("));
}

TEST(Describe, ListsWhatIsLeft) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.verdict = diagnose::Verdict::kUnknown;
  d.effects.clear();
  d.after = d.before;
  d.extended = d.baseline;
  const std::string text = flowing(report::describe(d));
  EXPECT_THAT(text, StartsWith("UNKNOWN: "));
  EXPECT_THAT(text, HasSubstr("still depends on: time (p < 0.0001)"));
  EXPECT_THAT(text, HasSubstr("payload (p < 0.0001)"));
  EXPECT_THAT(text, Not(HasSubstr("chamber_2 (p")));
  EXPECT_THAT(text,
              HasSubstr("It sits 0 to 50 mm from the base, in the plane of bending, goes with payload."));
  EXPECT_THAT(text, HasSubstr("On unseen trials the bodies are 1.95 mm off on average, 3.00 mm at most;"));
  EXPECT_THAT(text, Not(HasSubstr("what could be explained")));
  d.trials.resize(1);
  EXPECT_THAT(flowing(report::describe(d)),
              HasSubstr("On the only trial the bodies are 1.95 mm off on average, 3.00 mm at most;"));
}

TEST(Describe, RankingHidesWhatTheArmCannotHaveAndIsShort) {
  const std::string text = report::describe(testing::example_diagnosis());
  EXPECT_THAT(text, Not(HasSubstr("tendon_friction")));
  EXPECT_THAT(flowing(text), HasSubstr("1. base_compliance 93 % 88 % 41.2 2.10 mm present"));
  EXPECT_THAT(text, HasSubstr("and 2 more in the report"));
}

TEST(Describe, FitsTheTerminalAndKeepsItClean) {
  diagnose::Diagnosis d = testing::example_diagnosis();
  d.notes.push_back("evil\x1b[31m name\r\n" + std::string(300, 'x') + " end");
  const std::string text = report::describe(d);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\x1b'), 0);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 0);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("xxx") != std::string::npos) continue;
    EXPECT_LE(line.size(), 110U) << line;
  }
}

TEST(Describe, OfNothingIsReadable) {
  diagnose::Diagnosis d;
  d.baseline.held_out_rms_m = std::numeric_limits<double>::quiet_NaN();
  const std::string text = report::describe(d);
  EXPECT_THAT(text, StartsWith("CANNOT TELL: These recordings cannot tell."));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace softarm::diagnose
