// What a node leaves out that cannot keep up.
#include "ros/overload.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace softarm {
namespace {

struct Answers {
  std::size_t sent = 0, answered = 0;
  double worst_s = 0.0;  // latency
};

/// Frames come at a steady rate, each takes so long; the node takes what is at hand, round by round.
Answers at_rate(Overload& overload, double rate_hz, double frame_s, double from_s, double to_s) {
  Answers run;
  std::size_t taken = 0;
  for (double now_s = from_s; now_s < to_s;) {
    const auto there = static_cast<std::size_t>((now_s - from_s) * rate_hz);
    const std::size_t stride = overload.stride(there - taken, now_s);
    if (there == taken) now_s += 1e-4;
    for (; taken < there; ++taken) {
      ++run.sent;
      if ((there - 1 - taken) % stride != 0) continue;
      overload.took(frame_s);
      now_s += frame_s;
      ++run.answered;
      run.worst_s = std::max(run.worst_s, now_s - from_s - static_cast<double>(taken) / rate_hz);
    }
  }
  return run;
}

TEST(Overload, ANodeThatKeepsUpAnswersAll) {
  Overload overload(0.02);
  const Answers run = at_rate(overload, 1000.0, 0.9e-3, 0.0, 5.0);
  EXPECT_EQ(run.answered, run.sent);
  EXPECT_FALSE(overload.lasts());
}

TEST(Overload, ABurstIsAnsweredInFull) {
  Overload overload(0.02);
  at_rate(overload, 240.0, 0.4e-3, 0.0, 1.0);
  EXPECT_EQ(overload.stride(240, 2.0), 1u);  // it was elsewhere for a second
  EXPECT_EQ(overload.stride(40, 2.1), 1u);   // and has those that came meanwhile
  const Answers after = at_rate(overload, 240.0, 0.4e-3, 2.12, 4.0);
  EXPECT_EQ(after.answered, after.sent);
}

TEST(Overload, WhatLastsIsThinnedOutAndTheLatencyBounded) {
  Overload overload(0.02);
  at_rate(overload, 2400.0, 1e-3, 0.0, 1.0);  // it builds up, and is noticed
  EXPECT_TRUE(overload.lasts());
  const Answers run = at_rate(overload, 2400.0, 1e-3, 1.0, 5.0);
  EXPECT_LT(run.answered, run.sent / 2);
  EXPECT_GT(run.answered, run.sent / 4);  // what it can do, it does
  EXPECT_LE(run.worst_s, 0.025);
}

TEST(Overload, ItEndsWhenTheNodeKeepsUpAgain) {
  Overload overload(0.02);
  at_rate(overload, 2400.0, 1e-3, 0.0, 1.0);
  at_rate(overload, 240.0, 1e-3, 1.0, 3.0);
  EXPECT_FALSE(overload.lasts());
  EXPECT_EQ(overload.stride(60, 3.0), 1u);
}

TEST(Overload, ZeroNeverLeavesOut) {
  Overload overload(0.0);
  const Answers run = at_rate(overload, 2400.0, 1e-3, 0.0, 3.0);
  EXPECT_EQ(run.answered, run.sent);
}

}  // namespace
}  // namespace softarm
