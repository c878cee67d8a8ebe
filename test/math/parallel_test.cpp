// Parallel loops, and how they are ended.
#include "math/parallel.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>

#include "math/stop.h"

namespace softarm::math {
namespace {

TEST(Parallel, EveryPieceOnce) {
  std::vector<std::atomic<int>> done(100);
  in_parallel(done.size(), 4, [&](std::size_t i) { ++done[i]; });
  for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST(Parallel, EndsWhereItIsAskedTo) {
  std::atomic<int> pieces{0}, asked{0};
  const std::function<void()> ask = [&] {
    if (++asked > 10) throw std::runtime_error("enough");
  };
  const StopScope scope(&ask);
  // Nested, on threads of their own: all of them are asked.
  EXPECT_THROW(in_parallel(4, 4, [&](std::size_t) { in_parallel(100, 2, [&](std::size_t) { ++pieces; }); }),
               std::runtime_error);
  EXPECT_LT(pieces, 40);
}

TEST(Parallel, IsAskedByItsOwnScopeAlone) {
  EXPECT_EQ(StopScope::asked(), nullptr);
  const std::function<void()> outer = [] { throw std::runtime_error("outer"); }, inner = [] {};
  int pieces = 0;
  {
    const StopScope scope(&outer);
    {
      const StopScope of_inner(&inner);
      in_parallel(3, 1, [&](std::size_t) { ++pieces; });
    }
    EXPECT_EQ(pieces, 3);
    EXPECT_THROW(in_parallel(3, 1, [&](std::size_t) { ++pieces; }), std::runtime_error);
  }
  in_parallel(3, 1, [&](std::size_t) { ++pieces; });
  EXPECT_EQ(pieces, 6);
}

}  // namespace
}  // namespace softarm::math
