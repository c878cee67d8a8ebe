// The order of bodies along the arm, by their distances.
#include "arm/body_order.h"

#include <gtest/gtest.h>

#include <cmath>

namespace softarm::arm {
namespace {

/// On an arc of 1 rad.
std::vector<Eigen::Vector3d> on_an_arc(const std::vector<double>& arclength_m) {
  std::vector<Eigen::Vector3d> places;
  const double radius_m = 0.2;
  for (const double s_m : arclength_m)
    places.emplace_back(radius_m * (1.0 - std::cos(s_m / radius_m)), 0.0,
                        radius_m * std::sin(s_m / radius_m));
  return places;
}

TEST(BodyOrder, BodiesThatStandAsTheyShouldHaveNoOther) {
  const std::vector<double> arclength_m{0.05, 0.1, 0.15, 0.2};
  EXPECT_FALSE(other_order(on_an_arc(arclength_m), arclength_m));
  EXPECT_FALSE(other_order({Eigen::Vector3d(0.0, 0.0, 0.1)}, {0.05})) << "one body has one order";
}

TEST(BodyOrder, TwoThatAreExchangedAreFound) {
  const std::vector<double> arclength_m{0.05, 0.1, 0.2};
  std::vector<Eigen::Vector3d> places = on_an_arc(arclength_m);
  std::swap(places[1], places[2]);
  const auto other = other_order(places, arclength_m);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->order, (std::vector<std::size_t>{0, 2, 1}));
  EXPECT_GT(other->as_is_m, 0.03);
  EXPECT_LT(other->least_m, 0.005);
}

TEST(BodyOrder, BodiesThatFitInNoOrderHaveNone) {
  const std::vector<double> arclength_m{0.05, 0.1, 0.2};
  std::vector<Eigen::Vector3d> places = on_an_arc(arclength_m);
  for (Eigen::Vector3d& place : places) place *= 3.0;  // in another unit, say
  EXPECT_FALSE(other_order(places, arclength_m));
}

}  // namespace
}  // namespace softarm::arm
