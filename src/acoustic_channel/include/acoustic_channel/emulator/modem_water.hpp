#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/engine/modem_engine.hpp"
#include "acoustic_channel/network/network.hpp"

namespace stg::acoustics {

/// The hosts of the emulated modems.
class ModemHosts {
 public:
  virtual ~ModemHosts() = default;
  virtual void Write(int node, const std::string& bytes) = 0;
  virtual void HangUp(int node) = 0;
  /// For other clients that read along; see ModemSurroundings.
  virtual void Announce(int /*node*/, const std::string& /*notification*/) {}
  /// Two modems share an address; it is allowed.
  virtual void OnSharedAddress(int /*node*/, int /*address*/) {}
};

/// Emulated modems and ordinary vehicles in one water. Its owner passes the hosts' bytes and the
/// vehicles' motion, and advances the time. It has no thread, socket or clock: the same input at
/// the same times gives the same output, bit for bit. Times as in Network.
class ModemWater : private PacketObserver {
 public:
  /// Makes the modem of a node, which uses the surroundings during its life.
  using MakeEngine = std::function<std::unique_ptr<ModemEngine>(ModemSurroundings*)>;

  /// Throws UserError unless the section is a network that emulated modems can be in: the model
  /// `physical`, access `aloha` without rest, queue `fifo`.
  /// @param hosts must live as long as this object
  ModemWater(const ChannelConfig& config, const RunConfig& run, std::unique_ptr<Medium> medium,
             ModemHosts* hosts);
  ModemWater(const ChannelConfig& config, const RunConfig& run, ModemHosts* hosts);
  ~ModemWater() override;

  /// Before the first Advance. A node without an engine is an ordinary vehicle.
  void Attach(int node, int address, const MakeEngine& make);
  /// Adds an observer of all reports.
  void Observe(PacketObserver* observer) { observer_ = observer; }
  void SetUtcStart(TimeNs utc) { utc_start_ = utc; }
  /// Starts an episode: every modem is switched on at time 0.
  void Reset(std::uint64_t seed, std::uint32_t episode);

  // Hosts; at time t >= now(), which passes first.
  void Connect(int node, TimeNs t);
  void Disconnect(int node, TimeNs t);
  void Read(int node, TimeNs t, ByteView bytes);

  /// Of ordinary vehicles and of all.
  void Offer(const Transmission& packet, TimeNs t);
  void Move(int node, TimeNs t, const NodeMotion& motion);
  void SetPresent(int node, TimeNs t, bool present);
  /// The modem of a node loses its power for a moment.
  void Restart(int node, TimeNs t);

  /// Time of the next event without further input.
  TimeNs next() const;
  void Advance(TimeNs t);
  TimeNs now() const { return network_.now(); }
  Network& network() { return network_; }
  const Network& network() const { return network_; }
  int AddressOf(int node) const;

 private:
  class Surroundings;
  struct Member {
    std::unique_ptr<Surroundings> surroundings;
    std::unique_ptr<ModemEngine> engine;
    int address = 0;
  };

  void Add(ModemEvent::Kind kind, int node, TimeNs t, const PacketInfo& packet);
  void Dispatch();
  void ForgetReceptions();
  Member& At(int node) { return members_[static_cast<std::size_t>(node)]; }

  void OnQueued(const PacketInfo& packet) override;
  void OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs t) override;
  void OnSent(const PacketInfo& packet) override;
  void OnSendEnd(const PacketInfo& packet) override;
  void OnAcquired(const PacketInfo& packet, int receiver, TimeNs begin) override;
  void OnReceptionEnd(const PacketInfo& packet, const HeardEnd& end, TimeNs t) override;
  void OnFate(const PacketInfo& packet, const PacketFate& fate) override;
  void OnPing(const PingResult& result) override;

  struct Addressed {
    int node;
    ModemEvent event;
  };

  ModemHosts* hosts_;
  PacketObserver* observer_ = nullptr;
  Network network_;
  std::vector<Member> members_;
  std::deque<Addressed> events_;
  std::vector<Reception> scratch_;
  TimeNs utc_start_ = 0;
};

}  // namespace stg::acoustics
