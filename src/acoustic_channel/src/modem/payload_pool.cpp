#include "acoustic_channel/modem/payload_pool.hpp"

#include <cassert>

namespace stg::acoustics {

int PayloadPool::Store(const ByteView& payload) {
  if (payload.size > largest_) {
    largest_ = payload.size;
    for (Slot& slot : slots_) slot.bytes.reserve(largest_);
  }
  if (free_.empty()) {
    const std::size_t count = slots_.size() + 1;
    slots_.resize(count);
    slots_.back().bytes.reserve(largest_);
    free_.reserve(count);
    released_.reserve(count);
    free_.push_back(static_cast<int>(count) - 1);
  }
  const int handle = free_.back();
  free_.pop_back();
  Slot& slot = slots_[static_cast<std::size_t>(handle)];
  slot.bytes.assign(payload.data, payload.data + payload.size);
  slot.holders = 0;
  return handle;
}

void PayloadPool::Release(int handle) {
  Slot& slot = slots_[static_cast<std::size_t>(handle)];
  assert(slot.holders > 0);
  if (--slot.holders == 0) released_.push_back(handle);
}

void PayloadPool::Recycle() {
  free_.insert(free_.end(), released_.begin(), released_.end());
  released_.clear();
}

void PayloadPool::Clear() {
  free_.clear();
  released_.clear();
  for (std::size_t k = 0; k < slots_.size(); ++k) free_.push_back(static_cast<int>(k));
}

}  // namespace stg::acoustics
