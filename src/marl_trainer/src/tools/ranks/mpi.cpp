#include "mpi.hpp"

#define OMPI_SKIP_MPICXX 1  // only the C interface
#include <mpi.h>

#include <algorithm>
#include <string>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/stopwatch.hpp"
#include "started_by_mpi.hpp"

namespace stg::learn {
namespace {

/// Larger messages are sent in parts, because of MPI's limit for counts.
constexpr std::size_t kLargestMessage = 1u << 30;

class MpiRanks : public Communicator {
 public:
  MpiRanks(int* argc, char*** argv) {
    int provided = 0;
    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiRanks() override { MPI_Finalize(); }

  int rank() const override { return rank_; }
  int size() const override { return size_; }

  std::vector<char> GatherBytes(const std::vector<char>& mine) override {
    const Stopwatch watch;
    if (mine.size() > kLargestMessage / static_cast<std::size_t>(size_)) {
      throw UserError("a message between ranks is too large: " + std::to_string(mine.size()));
    }
    const int count = static_cast<int>(mine.size());
    std::vector<int> counts(static_cast<std::size_t>(size_)), places(counts.size());
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
    int total = 0;
    for (std::size_t r = 0; r < counts.size(); ++r) {
      places[r] = total;
      total += counts[r];
    }
    std::vector<char> all(static_cast<std::size_t>(total));
    MPI_Allgatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), places.data(), MPI_BYTE,
                   MPI_COMM_WORLD);
    Count(static_cast<std::int64_t>(count + static_cast<int>(sizeof count)) * (size_ - 1), watch);
    return all;
  }

  void Sum(float* x, std::size_t count) override {
    const Stopwatch watch;
    other_.resize(count);
    std::int64_t sent = 0;
    for (int stride = 1; stride < size_; stride *= 2) {
      const int partner = rank_ ^ stride;
      for (std::size_t from = 0; from < count; from += kLargestMessage / sizeof(float)) {
        const int n = static_cast<int>(std::min(kLargestMessage / sizeof(float), count - from));
        MPI_Sendrecv(x + from, n, MPI_FLOAT, partner, 0, other_.data() + from, n, MPI_FLOAT,
                     partner, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      }
      // A sum of two numbers does not depend on their order, so both ranks have the same bits.
      for (std::size_t i = 0; i < count; ++i) x[i] += other_[i];
      sent += static_cast<std::int64_t>(count * sizeof(float));
    }
    Count(sent, watch);
  }

 private:
  void Count(std::int64_t bytes, const Stopwatch& watch) {
    traffic_.bytes += bytes;
    ++traffic_.calls;
    traffic_.seconds += watch.seconds();
  }

  int rank_ = 0, size_ = 1;
  std::vector<float> other_;
};

}  // namespace

std::unique_ptr<Communicator> JoinRanks(int* argc, char*** argv) {
  if (!StartedByMpi()) return std::make_unique<OneRank>();
  return std::make_unique<MpiRanks>(argc, argv);
}

void AbortRanks(int status) {
  int started = 0, ended = 0;
  MPI_Initialized(&started);
  MPI_Finalized(&ended);
  if (started != 0 && ended == 0) MPI_Abort(MPI_COMM_WORLD, status);
}

}  // namespace stg::learn
