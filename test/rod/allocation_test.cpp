// The solver allocates in its constructor only.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "rods.h"
#include "softarm/rod/solver.h"

namespace {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  if (void* p = std::aligned_alloc(static_cast<std::size_t>(alignment), size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace softarm::rod {
namespace {

TEST(Allocation, NoneWhileSolving) {
  rod::Rod rod = testing::complicated_rod();
  rod::Solver solver(rod, {0.1, 0.2, 0.32},
                     {{rod::ParameterKind::kBendingCompliance, 0, 0}, {rod::ParameterKind::kLength, 1, 0}});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const rod::Rod before = rod;
  rod.segments[0].moment_nm.y() += 0.1;
  const long at_start = allocations;
  const rod::SolveStatus cold = solver.solve(rod);
  const rod::SolveStatus warm = solver.solve(rod, Eigen::Quaterniond(solver.q_tip()));
  const rod::SolveStatus from = solver.solve(rod, Eigen::Quaterniond(solver.q_tip()), &before);
  const rod::RodState middle = solver.at(0.17);
  const long at_end = allocations;
  EXPECT_EQ(at_end - at_start, 0);
  EXPECT_EQ(cold, rod::SolveStatus::kConverged);
  EXPECT_EQ(warm, rod::SolveStatus::kConverged);
  EXPECT_EQ(from, rod::SolveStatus::kConverged);
  EXPECT_GT(middle.p.norm(), 0.0);
  EXPECT_GT(at_end, 0);  // the counter counts
}

}  // namespace
}  // namespace softarm::rod
