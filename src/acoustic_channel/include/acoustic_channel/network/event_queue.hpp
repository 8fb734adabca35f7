#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "auv_common/time.hpp"

namespace stg::acoustics {

/// Kinds of events in a network. At one time, smaller kinds come first.
enum class EventKind : std::uint8_t {
  kPresence,      ///< a node joins or leaves
  kMove,          ///< a position becomes known
  kArrivalEnd,    ///< the last sound of a packet at a receiver
  kSendEnd,       ///< the last sound of a packet at its sender
  kOffer,         ///< a packet for a modem
  kReply,         ///< a modem answers a ping
  kSend,          ///< a modem wants to send
  kArrivalBegin,  ///< the first sound of a packet at a receiver
  kAcquire,       ///< the receiver chooses an arrival to lock onto
  kNoise,         ///< noise at a receiver changes
  kTimeout,       ///< a ping has timed out
};

struct Event {
  TimeNs t;
  std::uint64_t order;   ///< kind, source, receiver: decides at one time
  std::uint32_t serial;  ///< order of insertion, for otherwise equal events
  std::int32_t index;    ///< index of the object of the event, by kind

  EventKind kind() const { return static_cast<EventKind>(order >> 56); }
  int source() const { return static_cast<int>(order >> 28 & 0xfffffff); }
  int receiver() const { return static_cast<int>(order & 0xfffffff); }
};

/// Events by time, a binary heap. Allocates only when it exceeds its earlier maximum.
class EventQueue {
 public:
  explicit EventQueue(std::size_t reserve) { heap_.reserve(reserve); }

  void Clear() {
    heap_.clear();
    serial_ = 0;
  }
  bool Has(TimeNs until) const { return !heap_.empty() && heap_.front().t <= until; }

  /// Of the earliest event; there must be one.
  TimeNs first() const { return heap_.front().t; }
  bool empty() const { return heap_.empty(); }

  /// @param source, receiver nodes; 0 if there is none
  void Push(TimeNs t, EventKind kind, int source, int receiver, int index) {
    const auto order = static_cast<std::uint64_t>(kind) << 56 |
                       static_cast<std::uint64_t>(source) << 28 |
                       static_cast<std::uint64_t>(receiver);
    heap_.push_back({t, order, serial_++, index});
    std::push_heap(heap_.begin(), heap_.end(), Later);
  }
  Event Pop() {
    std::pop_heap(heap_.begin(), heap_.end(), Later);
    const Event event = heap_.back();
    heap_.pop_back();
    return event;
  }

 private:
  static bool Later(const Event& a, const Event& b) {
    if (a.t != b.t) return a.t > b.t;
    if (a.order != b.order) return a.order > b.order;
    return a.serial > b.serial;
  }

  std::vector<Event> heap_;
  std::uint32_t serial_ = 0;
};

/// Reusable slots for objects of one kind, addressed by their index.
template <class T>
class Pool {
 public:
  void Reserve(std::size_t count) {
    items_.reserve(count);
    free_.reserve(count);
  }
  void Clear() {
    items_.clear();
    free_.clear();
  }
  int Add(const T& item) {
    if (free_.empty()) {
      items_.push_back(item);
      free_.reserve(items_.size());
      return static_cast<int>(items_.size()) - 1;
    }
    const int index = free_.back();
    free_.pop_back();
    (*this)[index] = item;
    return index;
  }
  void Remove(int index) { free_.push_back(index); }
  T& operator[](int index) { return items_[static_cast<std::size_t>(index)]; }
  const T& operator[](int index) const { return items_[static_cast<std::size_t>(index)]; }

 private:
  std::vector<T> items_;
  std::vector<int> free_;
};

}  // namespace stg::acoustics
