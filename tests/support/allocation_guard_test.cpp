#include "tests/support/allocation_guard.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include <Eigen/Dense>

#include "core/base/sanitizer.hpp"

namespace slamd::support {
namespace {

// Keeps the compiler from removing an allocation that nobody uses.
void use(const void* memory) {
  asm volatile("" : : "r"(memory) : "memory");
}

struct alignas(64) OverAligned {
  char bytes[64];
};

TEST(AllocationGuard, CountsMalloc) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t count = count_allocations([] {
    void* memory = std::malloc(16);
    use(memory);
    std::free(memory);
  });

  EXPECT_EQ(count, 1U);
}

TEST(AllocationGuard, CountsCallocReallocAndTheAlignedOnes) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t count = count_allocations([] {
    void* memory = std::calloc(4, 4);
    use(memory);
    memory = std::realloc(memory, 64);
    use(memory);
    std::free(memory);
    memory = std::aligned_alloc(64, 64);
    use(memory);
    std::free(memory);
    ASSERT_EQ(posix_memalign(&memory, 64, 64), 0);
    use(memory);
    std::free(memory);
  });

  EXPECT_EQ(count, 4U);
}

TEST(AllocationGuard, CountsNew) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t count = count_allocations([] { use(std::make_unique<int>(1).get()); });

  EXPECT_EQ(count, 1U);
}

TEST(AllocationGuard, CountsOverAlignedNew) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t count = count_allocations([] { use(std::make_unique<OverAligned>().get()); });

  EXPECT_EQ(count, 1U);
}

TEST(AllocationGuard, CountsAGrowingVector) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::vector<int> values(1);

  const std::size_t count = count_allocations([&values] { values.resize(values.capacity() + 1); });

  EXPECT_EQ(count, 1U);
}

TEST(AllocationGuard, CountsADynamicEigenProduct) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(6, 6);

  const std::size_t count = count_allocations([&a] {
    const Eigen::MatrixXd product = a * a;
    use(product.data());
  });

  EXPECT_GE(count, 1U);
}

TEST(AllocationGuard, SeesNoneInAFixedEigenSolve) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Eigen::Matrix<double, 6, 6> a = 2.0 * Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Matrix<double, 6, 1> x = Eigen::Matrix<double, 6, 1>::Ones();

  const std::size_t count = count_allocations([&] { x = a.ldlt().solve(x).eval(); });

  EXPECT_EQ(count, 0U);
  EXPECT_DOUBLE_EQ(x[0], 0.5);
}

TEST(AllocationGuard, NestsAndForgetsWhatHappenedOutside) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  use(std::make_unique<int>(1).get());
  std::size_t inner = 0;

  const std::size_t outer = count_allocations([&inner] {
    use(std::make_unique<int>(1).get());
    inner = count_allocations([] { use(std::make_unique<int>(1).get()); });
  });

  EXPECT_EQ(inner, 1U);
  EXPECT_EQ(outer, 2U);
}

TEST(AllocationGuard, CountsItsOwnThreadOnly) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::size_t in_thread = 0;
  std::thread other;

  // The thread object itself allocates here; what the other thread does must not appear.
  const std::size_t here = count_allocations([&] {
    other = std::thread([&in_thread] {
      in_thread = count_allocations([] {
        for (int i = 0; i < 1000; ++i) {
          use(std::make_unique<int>(i).get());
        }
      });
    });
    other.join();
  });

  EXPECT_EQ(in_thread, 1000U);
  EXPECT_LT(here, 20U);
}

TEST(AllocationGuard, IsAbsentUnderASanitizerOnly) {
  EXPECT_EQ(allocation_guard_available(), SLAMD_SANITIZED == 0);
}

}  // namespace
}  // namespace slamd::support
