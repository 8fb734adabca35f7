#pragma once

#include <cstdint>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"

namespace stg::acoustics {

/// Payloads in transmission: one copy of each for all its receivers. A slot is free again when the
/// last receiver has the payload and Recycle was called. Allocates only while the number or the
/// size of these payloads reaches a new maximum.
class PayloadPool {
 public:
  /// Copies a payload that has no holder yet; returns the handle of the copy.
  int Store(const ByteView& payload);
  /// Valid until the next Store.
  ByteView at(int handle) const { return ViewOf(slots_[static_cast<std::size_t>(handle)].bytes); }

  /// Adds a receiver.
  void Hold(int handle) { ++slots_[static_cast<std::size_t>(handle)].holders; }
  /// Removes a receiver; the last one, too, may read the payload until Recycle.
  void Release(int handle);
  /// Frees payloads without a receiver.
  void Recycle();
  /// Frees all payloads.
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
