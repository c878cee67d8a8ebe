#include "math/parse_number.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace softarm::math
