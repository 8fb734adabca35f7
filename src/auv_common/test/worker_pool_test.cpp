#include "auv_common/parallel/worker_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace stg {
namespace {

TEST(WorkerPool, RunsEverySliceOnceAndPassesExceptionsOn) {
  WorkerPool pool(3);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<std::atomic<int>> runs(17);
    pool.Run(17, [&](int slice, int worker) {
      EXPECT_EQ(worker, slice % 3);
      ++runs[static_cast<std::size_t>(slice)];
    });
    for (const auto& r : runs) ASSERT_EQ(r, 1);
  }
  EXPECT_THROW(pool.Run(4,
                        [](int slice, int) {
                          if (slice == 2) throw std::runtime_error("x");
                        }),
               std::runtime_error);
  int after = 0;
  pool.Run(1, [&](int, int) { ++after; });
  EXPECT_EQ(after, 1);
}

}  // namespace
}  // namespace stg
