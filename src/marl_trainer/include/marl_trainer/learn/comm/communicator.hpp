#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace stg::learn {

/// The processes ("ranks") that train one policy together. Each has a share of the environments.
/// All ranks make each call at the same point of the run, in one thread, and it returns the same
/// bits in all of them. If one rank is lost, the run of all ranks ends.
class Communicator {
 public:
  virtual ~Communicator() = default;

  /// 0 <= rank < size; the number of ranks is a power of two.
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Bytes of every rank, in the order of the ranks. Their sizes may differ.
  virtual std::vector<char> GatherBytes(const std::vector<char>& mine) = 0;
  /// Adds x [count] over the ranks: first neighbours (0 + 1, 2 + 3, ...), then neighbouring pairs,
  /// and so on.
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

  /// Bytes that this rank has sent, and time that its calls took, including waits for others [s].
  struct Traffic {
    std::int64_t bytes = 0, calls = 0;
    double seconds = 0.0;
  };
  const Traffic& traffic() const { return traffic_; }

 protected:
  Traffic traffic_;
};

/// A process that trains alone: the only rank.
class OneRank : public Communicator {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<char> GatherBytes(const std::vector<char>& mine) override { return mine; }
  void Sum(float*, std::size_t) override {}
};
/// The communicator of a process that trains alone.
Communicator* Alone();

/// Adds arrays in the order of a sum over ranks: neighbours, then neighbouring pairs, and so on.
/// The result is parts[0].
/// @param count number of arrays [size], a power of two
void SumInPairs(std::vector<std::vector<float>>* parts, std::size_t count, std::size_t begin,
                std::size_t end);

}  // namespace stg::learn
