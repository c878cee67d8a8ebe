#include "math/parse_number.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

namespace softarm::math {
namespace {

TEST(ParseNumber, ReadsWholeNumbersOnly) {
  EXPECT_EQ(parse_number("12.5"), 12.5);
  EXPECT_EQ(parse_number("-1e-3"), -1e-3);
  EXPECT_EQ(parse_number("+.5E1"), 5.0);
  EXPECT_EQ(parse_number("1e999"), HUGE_VAL);
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "1e", "1.2.3", "five", "--1", "1;"})
    EXPECT_FALSE(parse_number(text)) << text;
}

TEST(ParseNumber, WhateverTheLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  if (std::setlocale(LC_NUMERIC, "de_DE.UTF-8") == nullptr)
    GTEST_SKIP() << "no locale with a decimal comma here";
  EXPECT_EQ(parse_number("12.5"), 12.5);
  std::setlocale(LC_NUMERIC, before.c_str());
}

}  // namespace
}  // namespace softarm::math
