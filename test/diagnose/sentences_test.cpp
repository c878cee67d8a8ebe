// Numbers and places in words.
#include "diagnose/sentences.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "diagnose/findings.h"
#include "diagnose/pictures.h"
#include "diagnose/unseen.h"

namespace softarm::diagnose {
namespace {

TEST(Words, LabelsGoOnFromTheSymbol) {
  const auto label_of = [](const std::string& symbol, const std::string& words) {
    return label({symbol, "", words, 0.0, 0.0, 0.0});
  };
  EXPECT_EQ(label_of("share", "of EI, by which it grows"), "share of EI, by which it grows");
  EXPECT_EQ(label_of("delay_s", "by which they are late"), "delay by which they are late");
  EXPECT_EQ(label_of("time_s", "time constant"), "time constant");
  EXPECT_EQ(label_of("body", "its number, from the base"), "body, its number, from the base");
  EXPECT_EQ(label_of("in_holds", "0: always; 1: during holds"), "in holds (0: always; 1: during holds)");
  EXPECT_EQ(label_of("compliance_rad_per_nm", ""), "compliance");
}

TEST(Words, NumbersHaveTheDigitsThatTheirIntervalIsWorth) {
  const auto text = [](double value, double low, double high, const std::string& unit) {
    return diagnose::with_interval({"x", unit, "", value, low, high});
  };
  EXPECT_EQ(text(0.1923, 0.17, 0.21, "rad/(N m)"), "0.192 rad/(N m) (90 % interval 0.170 to 0.210)");
  EXPECT_EQ(text(0.0012, 0.0002, 0.0022, "m"), "1.2 mm (90 % interval 0.2 to 2.2)");
  EXPECT_EQ(text(-0.0312, -0.05, -0.01, "1"), "-0.031 (90 % interval -0.050 to -0.010)");
  EXPECT_EQ(text(2.0, 2.0, 2.0, "1"), "2");
  EXPECT_EQ(text(3000.0, 3000.0, 3000.0, "Pa"), "3.00 kPa");
  EXPECT_EQ(text(1.0, -std::numeric_limits<double>::infinity(), 2.0, "s"), "1.00 s");
  EXPECT_EQ(text(4.2e-9, 4e-9, 4.4e-9, "N m/Pa"), "4.20e-09 N m/Pa (90 % interval 4.00e-09 to 4.40e-09)");
}

TEST(Words, ANumberThatWasHeldIsSaidNotToBeFitted) {
  EXPECT_EQ(diagnose::with_interval({"extent_m", "m", "", 0.08, 0.08, 0.08, false}),
            with_unit(0.08, "m") + " (not fitted)");
  NamedEffect contact;
  contact.id = "contact";
  contact.parameters = {{"extent_m", "m", "half of the stretch", 0.08, 0.08, 0.08, false}};
  EXPECT_NE(sentence_of(contact).find("half of the stretch: " + with_unit(0.08, "m") + " (not fitted);"),
            std::string::npos)
      << sentence_of(contact);
}

TEST(Words, ProbabilitiesAreNeverCertain) {
  EXPECT_EQ(diagnose::percent(0.999), "over 99 %");
  EXPECT_EQ(diagnose::percent(0.0004), "under 1 %");
  EXPECT_EQ(diagnose::percent(0.5), "50 %");
  EXPECT_EQ(diagnose::percent(std::numeric_limits<double>::quiet_NaN()), "not known");
}

TEST(Words, PlacesSayWhatIsKnown) {
  diagnose::Where where;
  EXPECT_EQ(place(where), "");
  where.s_from_m = 0.04;
  EXPECT_EQ(place(where), "from 40 mm from the base on");
  where.s_to_m = 0.0404;
  EXPECT_EQ(place(where), "40 mm from the base");
  where.s_to_m = 0.08;
  where.axis = "out_of_plane";
  where.when = "from 12.3 s on in trial_3";
  EXPECT_EQ(place(where),
            "40 to 80 mm from the base, across the plane of bending, from 12.3 s on in trial_3");
  EXPECT_EQ(diagnose::one_of({}), "");
  EXPECT_EQ(diagnose::one_of({"a", "b", "c"}), "a, b or c");
}

TEST(Words, WhatStandsOutIsNotCalledAbsent) {
  diagnose::Candidate candidate;
  EXPECT_EQ(diagnose::finding_description(candidate), "absent");
  candidate.z = 12.0;
  EXPECT_EQ(diagnose::finding_description(candidate),
            "stands out, but effects above or errors of the laws explain it as well");
  candidate.probability = 0.4;
  EXPECT_EQ(diagnose::finding_description(candidate), "possibly present");
  candidate.possible = false;
  EXPECT_EQ(diagnose::finding_description(candidate), "fits, but only with a size that no arm has");
  candidate = {};
  candidate.detectable = false;
  candidate.finding = diagnose::Finding::kCannotTell;
  EXPECT_EQ(diagnose::finding_description(candidate), "cannot tell: a usual size would not be seen");
  candidate.finding = diagnose::Finding::kPresent;
  EXPECT_EQ(diagnose::finding_description(candidate), "in the model, but improbable");
  candidate.probability = 0.4;
  EXPECT_EQ(diagnose::finding_description(candidate), "present");
}

TEST(Sentences, TheHeadlineIsWhatIsToBeSeenToFirst) {
  Diagnosis d;
  d.verdict = Verdict::kUnknown;
  EXPECT_EQ(headline(d), meaning(Verdict::kUnknown));
  d.narrow_range = true;
  EXPECT_EQ(headline(d), "A range in the arm file is too narrow");
  d.told_payloads = ToldPayloads{};
  EXPECT_EQ(headline(d), "Payloads are not as stated");
  d.exchanged_names = ExchangedNames{};
  EXPECT_EQ(headline(d), "Names of bodies are exchanged");
}

TEST(Sentences, WhatIsHardlyThereIsNotSaidToBeLeftOut) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kExplained;
  NamedEffect sure, hardly;
  sure.id = "payload_scale";
  sure.probability = 0.97;
  hardly.id = "pressure_lag";
  hardly.probability = 0.2;
  diagnosis.effects = {sure, hardly};
  const std::string both = summary_of(diagnosis, 4);
  EXPECT_EQ(
      both.rfind("The arm file leaves out payload_scale: with it, and with pressure_lag (20 %), which may "
                 "stand in for something else, the mean error",
                 0),
      0u)
      << both;
  diagnosis.effects = {hardly};
  EXPECT_EQ(
      summary_of(diagnosis, 4).rfind("The arm file leaves out pressure_lag (20 %): with it the mean", 0), 0u)
      << summary_of(diagnosis, 4);
  diagnosis.effects = {sure};
  const std::string of_many = summary_of(diagnosis, 4), of_one = summary_of(diagnosis, 1);
  EXPECT_EQ(
      of_many.rfind("The arm file leaves out payload_scale: with it the mean error on unseen trials ", 0), 0u)
      << of_many;
  EXPECT_EQ(of_one.rfind("The arm file leaves out payload_scale: with it the mean error ", 0), 0u) << of_one;
  EXPECT_EQ(of_one.find("unseen trials"), std::string::npos) << of_one;
}

TEST(Sentences, TrialsThatCannotTellSayWhatWouldExplainThem) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kCannotTell;
  EXPECT_NE(summary_of(diagnosis, 4).find("most effects would be collinear"), std::string::npos);
  NamedEffect bow, scale;
  bow.id = "camera_bow";
  bow.probability = 0.02;
  scale.id = "camera_scale";
  scale.probability = 0.3;
  diagnosis.stand_ins = {bow};
  EXPECT_NE(summary_of(diagnosis, 4).find("camera_bow (2 %) would explain it, but is probably not there."),
            std::string::npos)
      << summary_of(diagnosis, 4);
  diagnosis.effects = {scale};
  EXPECT_NE(
      summary_of(diagnosis, 4)
          .find("camera_scale (30 %) and camera_bow (2 %) would explain it, but are probably not there."),
      std::string::npos)
      << summary_of(diagnosis, 4);
}

TEST(Sentences, UnderUnknownOnlyWhatIsLikelyIsListedWithItsOwnShare) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kUnknown;
  diagnosis.explained_share = 0.4;
  NamedEffect sure, hardly;
  sure.id = "skin_marker";
  sure.probability = 0.97;
  sure.share = 0.3;
  hardly.id = "hysteresis";
  hardly.probability = 0.004;
  hardly.share = 0.7;
  diagnosis.effects = {hardly, sure};
  set_stand_ins_apart(diagnosis);
  const std::string text = summary_of(diagnosis, 4);
  EXPECT_NE(text.find(" skin_marker (97 %) explains 12 % of it: with all that was fitted the mean"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("hysteresis"), std::string::npos) << text;
  diagnosis.effects.clear();
  EXPECT_EQ(summary_of(diagnosis, 4).find(" explains 28 %"), std::string::npos) << summary_of(diagnosis, 4);
  EXPECT_EQ(summary_of(diagnosis, 4).find("hysteresis"), std::string::npos) << summary_of(diagnosis, 4);
}

TEST(Sentences, OfOneSequenceInThreeSessionsOthersSessionsPredict) {
  const double hour = 3600.0;
  const auto said = [](const std::vector<std::size_t>& sequence, const std::vector<double>& session_s) {
    return predicted_from(sequence, predicted_without(sequence, session_s));
  };
  const std::string same =
      "All trials were driven by the same commands: an unseen trial has another payload or attitude, and "
      "says nothing about other commands.";
  EXPECT_EQ(said({0, 0, 0, 0}, {0.0, 60.0, 2 * hour, 4 * hour}),
            same +
                " Each unseen trial is predicted from 2 to 3 of the 4 trials: those of the same session are "
                "left out.");
  EXPECT_EQ(said({0, 0, 0, 0}, {0.0, 60.0, 120.0, 2 * hour}), same) << "two sessions are none";
  EXPECT_EQ(said({0, 0, 0}, {0.0, 2 * hour, 4 * hour}), same) << "each is a session";
  EXPECT_EQ(said({0}, {0.0}), "");
  EXPECT_EQ(said({0, 1, 2}, {0.0, 60.0, 120.0}), "") << "from all others";
  EXPECT_EQ(said({0, 1, 0, 1}, {0.0, 60.0, 120.0, 180.0}),
            "Each unseen trial is predicted from 2 of the 4 trials: those driven by the same commands or of "
            "the same session are left out.");
}

TEST(Sentences, WhatIsLeftOutStandsInTheVerdictsLine) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kConsistent;
  diagnosis.left_out_share = 0.42;
  EXPECT_NE(summary_of(diagnosis, 4).find("based on 58 % of the recordings"), std::string::npos)
      << summary_of(diagnosis, 4);
  diagnosis.left_out_share = 0.05;
  EXPECT_EQ(summary_of(diagnosis, 4).find("of the recordings"), std::string::npos)
      << summary_of(diagnosis, 4);
}

}  // namespace
}  // namespace softarm::diagnose
