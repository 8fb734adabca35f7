#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"

namespace stg::acoustics {

/// The packet log as CSV: one row per packet and receiver, written when its fate is known. Units
/// are in the names of the columns, levels in dB re 1 uPa. A packet that never left its modem has a
/// row for each of its receivers, with empty fields from `sequence` on.
class PacketLog : public PacketObserver {
 public:
  /// Writes the header.
  /// @param out must live as long as this object
  /// @param names of the nodes in the log, by index; empty: their indices
  /// @param offset added to all times [ns]
  PacketLog(std::ostream* out, int nodes, std::vector<std::string> names = {}, TimeNs offset = 0);

  void OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs t) override;
  void OnFate(const PacketInfo& packet, const PacketFate& fate) override;

  std::size_t rows() const { return rows_; }

 private:
  void Row(const PacketInfo& packet, const PacketFate* fate, int receiver, DropReason reason);
  void Node(int node);
  void Time(TimeNs t);
  void Number(double value, int decimals);
  void Integer(long long value);
  void Comma() { row_ += ','; }

  std::ostream* out_;
  int nodes_;
  std::vector<std::string> names_;
  TimeNs offset_;
  std::string row_;
  std::size_t rows_ = 0;
};

}  // namespace stg::acoustics
