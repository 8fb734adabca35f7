#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/driver/modem_port.hpp"

namespace stg::acoustics {

/// The modems of a swarm.
struct ModemChannelConfig {
  std::string protocol = "s2c";
  std::vector<std::string> ports;  ///< one per node: tcp://HOST:PORT or a serial device
  std::vector<int> addresses;      ///< of the modems; empty: the nodes and one
  int broadcast = -1;              ///< address of all; -1: the protocol's
  double rssi_offset_db = -190.0;  ///< of s2c
  int baud = 19200;
};

/// The channel of a swarm whose modems have ports of their own, in real time. A packet that is
/// offered at a step goes to its modem when the section's medium access allows it. Received packets
/// are delivered in the next step. Source, level and time of a packet are the modem's statements.
/// The distance of a link and the number of lost packets are unknown: the distance is 0, and the
/// quality of a link is its freshness.
class ModemChannel : public Channel {
 public:
  /// Opens the ports and starts the thread that serves them. Throws UserError.
  ModemChannel(const ChannelConfig& config, const RunConfig& run, const ModemChannelConfig& modems);
  ~ModemChannel() override;

  void Reset(std::uint64_t seed, std::uint32_t episode) override;
  /// There is no observer, because a modem does not know the fate of its packets.
  void Observe(PacketObserver* /*observer*/) override {}
  void SetPresent(int /*node*/, bool /*present*/) override {}
  int nodes() const override { return static_cast<int>(ports_.size()); }
  std::size_t max_payload() const override { return max_payload_; }
  bool Due(int node, TimeNs t) override { return turns_.Due(node, t); }
  void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
            const std::vector<Vec3<double>>& v_W,
            const std::vector<Transmission>& offered) override;
  void Deliver(int receiver, TimeNs until, std::vector<Reception>* out) override;
  LinkStatistics Link(int source, int destination, TimeNs now) const override;
  const ChannelTotals& totals() const override { return table_.totals(); }

  /// Of a node, for diagnostics.
  struct PortHealth {
    std::string port, firmware;
    bool ready = false;
    ModemDriver::Counts counts;
  };
  PortHealth health(int node) const;

 private:
  struct Outgoing {
    TimeNs start;  ///< by the steady clock
    DriverPacket packet;
  };
  struct Incoming {
    Reception reception;
    std::string payload;
  };
  void Run();
  void Exchange();
  int NodeOf(int address) const;
  int AddressOf(int node) const { return addresses_[static_cast<std::size_t>(node)]; }

  Turns turns_;
  std::size_t max_payload_;
  double freshness_s_;
  std::vector<int> addresses_;
  std::vector<std::unique_ptr<ModemPort>> ports_;  ///< of the thread
  LinkTable table_;
  std::vector<std::uint32_t> sequences_;      ///< [source * nodes + receiver], of packets received
  std::vector<std::vector<Incoming>> given_;  ///< [nodes], last result of Deliver
  TimeNs offset_ = 0;  ///< difference between the channel's time and the steady clock
  TimeNs stepped_ = 0;

  mutable std::mutex mutex_;                       ///< protects the members below
  std::vector<std::optional<Outgoing>> outgoing_;  ///< [nodes]
  std::vector<std::vector<DriverReception>> received_;
  std::vector<PortHealth> health_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace stg::acoustics
