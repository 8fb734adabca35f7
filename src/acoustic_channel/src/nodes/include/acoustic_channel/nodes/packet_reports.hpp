#pragma once

#include <auv_msgs/PacketEvents.h>

#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"

namespace stg::nodes {

/// Collects the channel's events about packets in the message for observers.
class PacketReports : public acoustics::PacketObserver {
 public:
  /// @param ids of the nodes in messages
  explicit PacketReports(std::vector<int> ids);

  /// Sets the time from which the channel's times count [ns].
  void Begin(TimeNs start) { start_ = start; }
  /// The events since Clear.
  auv_msgs::PacketEvents& message() { return message_; }
  void Clear() { message_.events.clear(); }

  void OnQueued(const acoustics::PacketInfo& packet) override;
  void OnDiscarded(const acoustics::PacketInfo& packet, acoustics::DropReason reason,
                   TimeNs t) override;
  void OnSent(const acoustics::PacketInfo& packet) override;
  void OnFate(const acoustics::PacketInfo& packet, const acoustics::PacketFate& fate) override;

  /// The id of a node in messages; kToAll stays kToAll.
  int IdOf(int node) const { return node < 0 ? node : ids_[static_cast<std::size_t>(node)]; }

 private:
  auv_msgs::PacketEvent& Add(std::uint8_t kind, const acoustics::PacketInfo& packet);

  std::vector<int> ids_;
  TimeNs start_ = 0;
  auv_msgs::PacketEvents message_;
};

}  // namespace stg::nodes
