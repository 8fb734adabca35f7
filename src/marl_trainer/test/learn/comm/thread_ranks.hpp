#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// Ranks that are threads of one process. They test the logic of several ranks.
class ThreadRanks {
 public:
  explicit ThreadRanks(int size) : brought_(static_cast<std::size_t>(size)) {}

  /// Runs `work` in one thread for every rank, and waits for all.
  void Run(const std::function<void(Communicator*)>& work) {
    std::vector<std::thread> threads;
    for (int rank = 0; rank < static_cast<int>(brought_.size()); ++rank) {
      threads.emplace_back([this, rank, &work] {
        Rank self(this, rank);
        work(&self);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

 private:
  class Rank : public Communicator {
   public:
    Rank(ThreadRanks* all, int rank) : all_(all), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return static_cast<int>(all_->brought_.size()); }

    std::vector<char> GatherBytes(const std::vector<char>& mine) override {
      std::vector<char> gathered;
      for (const std::vector<char>& part : all_->Meet(rank_, mine)) {
        gathered.insert(gathered.end(), part.begin(), part.end());
      }
      return gathered;
    }
    void Sum(float* x, std::size_t count) override {
      const std::vector<float> numbers = Gather(std::vector<float>(x, x + count));
      std::vector<std::vector<float>> parts;
      for (std::size_t from = 0; from < numbers.size(); from += count) {
        const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(from);
        parts.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
      }
      SumInPairs(&parts, parts.size(), 0, count);
      std::copy(parts[0].begin(), parts[0].end(), x);
    }

   private:
    ThreadRanks* all_;
    const int rank_;
  };

  /// Waits until all ranks have come. Returns what each of them brings.
  std::vector<std::vector<char>> Meet(int rank, const std::vector<char>& mine) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return leaving_ == 0; });
    brought_[static_cast<std::size_t>(rank)] = mine;
    if (++come_ == static_cast<int>(brought_.size())) {
      leaving_ = come_;
      come_ = 0;
      changed_.notify_all();
    } else {
      changed_.wait(lock, [&] { return leaving_ > 0; });
    }
    std::vector<std::vector<char>> all = brought_;
    if (--leaving_ == 0) changed_.notify_all();
    return all;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<char>> brought_;  // index: rank
  int come_ = 0, leaving_ = 0;
};

}  // namespace stg::learn
