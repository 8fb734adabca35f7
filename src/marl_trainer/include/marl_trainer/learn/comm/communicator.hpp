#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace stg::learn {

/// The processes ("ranks") that train one policy together, each with a share of the environments.
/// Every call is made by all ranks at the same point of the run, by one thread, and returns the
/// same bits in all of them. A rank that is lost ends the run of all.
class Communicator {
 public:
  virtual ~Communicator() = default;

  /// 0 <= rank < size; the number of ranks is a power of two.
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// What every rank brings, one after the other by rank; sizes may differ.
  virtual std::vector<char> GatherBytes(const std::vector<char>& mine) = 0;
  /// Adds up x [count] over the ranks: neighbours first (0 + 1, 2 + 3, ...), then neighbouring
  /// pairs, and so on.
  virtual void Sum(float* x, std::size_t count) = 0;

  template <class T>
  std::vector<T> Gather(const std::vector<T>& mine) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<char> bytes(mine.size() * sizeof(T));
    if (!mine.empty()) std::memcpy(bytes.data(), mine.data(), bytes.size());
    const std::vector<char> all = GatherBytes(bytes);
    std::vector<T> values(all.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), all.data(), all.size());
    return values;
  }

  /// What this rank has sent, and how long its calls took [s], waiting for others included.
  struct Traffic {
    std::int64_t bytes = 0, calls = 0;
    double seconds = 0.0;
  };
  const Traffic& traffic() const { return traffic_; }

 protected:
  Traffic traffic_;
};

/// A process that trains by itself: the only rank of one.
class OneRank : public Communicator {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<char> GatherBytes(const std::vector<char>& mine) override { return mine; }
  void Sum(float*, std::size_t) override {}
};
/// The communicator of a process alone.
Communicator* Alone();

/// As a sum over ranks: neighbours, then neighbouring pairs, and so on, into parts[0].
/// @param count a power of two of arrays [size] each
void SumInPairs(std::vector<std::vector<float>>* parts, std::size_t count, std::size_t begin,
                std::size_t end);

}  // namespace stg::learn
