#include <algorithm>

#include "marl_trainer/learn/buffers/replay_buffer.hpp"

namespace stg::learn {

std::vector<std::vector<float>*> ReplayBuffer::Numbers(Block* b) {
  return {&b->observations, &b->states,           &b->actions,   &b->rewards,
          &b->own_rewards,  &b->end_observations, &b->end_states};
}

void ReplayBuffer::Exchange(Communicator* ranks, std::size_t first, std::size_t count) {
  Chunk& chunk = chunks_[newest_];
  std::vector<float> numbers;
  std::vector<std::int64_t> ends;
  for (std::size_t s = first; s < first + count; ++s) {
    for (const std::vector<float>* x : Numbers(&chunk[s])) {
      numbers.insert(numbers.end(), x->begin(), x->end());
    }
    ends.insert(ends.end(), chunk[s].end.begin(), chunk[s].end.end());
  }
  numbers = ranks->Gather(numbers);
  ends = ranks->Gather(ends);
  auto number = numbers.begin();
  auto end = ends.begin();
  for (Block& b : chunk) {
    std::copy_n(end, b.end.size(), b.end.begin());
    end += static_cast<std::ptrdiff_t>(b.end.size());
    const auto segments = std::count_if(b.end.begin(), b.end.end(), [](auto e) { return e >= 0; });
    b.end_observations.resize(static_cast<std::size_t>(segments * observation_row_));
    b.end_states.resize(static_cast<std::size_t>(segments * state_row_));
    for (std::vector<float>* x : Numbers(&b)) {
      std::copy_n(number, x->size(), x->begin());
      number += static_cast<std::ptrdiff_t>(x->size());
    }
  }
}

}  // namespace stg::learn
