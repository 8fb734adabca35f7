#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace stg {

/// Persistent threads for data-parallel work in fixed slices. The thread of a slice is fixed, too
/// (slice modulo workers), so the memory of the slice stays in its cache.
class WorkerPool {
 public:
  /// @param workers >= 1; the calling thread is one of them.
  explicit WorkerPool(int workers);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Runs task(slice, worker) for the slices 0 .. slices-1 and waits until all have ended. If a
  /// task throws, its exception is rethrown here after the others have ended.
  void Run(int slices, const std::function<void(int slice, int worker)>& task);

  int workers() const { return static_cast<int>(threads_.size()) + 1; }

 private:
  void Loop(int worker);
  void RunShare(int worker);

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(int, int)>* task_ = nullptr;
  int slices_ = 0;
  std::uint64_t generation_ = 0;
  int running_ = 0;
  bool stop_ = false;
  std::exception_ptr error_;
};

}  // namespace stg
