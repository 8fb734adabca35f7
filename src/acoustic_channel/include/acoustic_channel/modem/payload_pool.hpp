#pragma once

#include <cstdint>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"

namespace stg::acoustics {

/// Payloads under way: one copy of each, however many receivers it is on its way to. A slot is
/// used again when its last receiver has the payload and Recycle was called. Allocates only while
/// the number or the size of payloads under way reaches a new maximum.
class PayloadPool {
 public:
  /// Copies a payload that has no holder yet; returns the handle of the copy.
  int Store(const ByteView& payload);
  /// Valid until the next Store.
  ByteView at(int handle) const { return ViewOf(slots_[static_cast<std::size_t>(handle)].bytes); }

  /// One more receiver to go.
  void Hold(int handle) { ++slots_[static_cast<std::size_t>(handle)].holders; }
  /// One receiver has it; also the last one may read it until Recycle.
  void Release(int handle);
  /// Payloads without a holder are forgotten.
  void Recycle();
  /// Forgets all payloads.
  void Clear();

 private:
  struct Slot {
    std::vector<std::uint8_t> bytes;
    int holders = 0;
  };
  std::vector<Slot> slots_;
  std::size_t largest_ = 0;  ///< payload so far; every slot has room for it
  std::vector<int> free_, released_;
};

}  // namespace stg::acoustics
