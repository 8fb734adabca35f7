#include "marl_trainer/learn/nn/moments_of_ranks.hpp"

#include <utility>

namespace stg::learn {

std::vector<RunningMoments> OfAllRanks(Communicator* ranks, const std::vector<RunningMoments>& own,
                                       std::size_t kinds) {
  std::vector<double> numbers;
  for (const RunningMoments& moments : own) {
    const std::vector<double> saved = moments.Save();
    numbers.insert(numbers.end(), saved.begin(), saved.end());
  }
  const std::vector<double> gathered = ranks->Gather(numbers);
  std::vector<RunningMoments> all;
  for (auto from = gathered.begin(); from != gathered.end();) {
    RunningMoments moments(own[all.size() % kinds].size());
    const auto end = from + static_cast<std::ptrdiff_t>(moments.Save().size());
    moments.Load({from, end});
    all.push_back(std::move(moments));
    from = end;
  }
  return all;
}

}  // namespace stg::learn
