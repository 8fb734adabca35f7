#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "acoustic_channel/network/network.hpp"

namespace stg::acoustics {

inline constexpr TimeNs kSecond = 1'000'000'000;
inline TimeNs Ns(double s) { return std::llround(s * 1e9); }

/// A medium in which the test sets every link and all noise.
class StatedMedium : public Medium {
 public:
  explicit StatedMedium(int nodes)
      : noise_db(static_cast<std::size_t>(nodes), 0.0), nodes_(static_cast<std::size_t>(nodes)) {
    Hearing audible;
    audible.level_db = audible.steady_level_db = audible.clear_level_db = 60.0;
    links_.assign(nodes_ * nodes_, audible);
  }
  Hearing& link(int source, int receiver) {
    return links_[static_cast<std::size_t>(source) * nodes_ + static_cast<std::size_t>(receiver)];
  }
  void SetLevel(int source, int receiver, double db) {
    Hearing& h = link(source, receiver);
    h.level_db = h.steady_level_db = h.clear_level_db = db;
  }
  void SetDelay(int a, int b, double s) {
    for (Hearing* h : {&link(a, b), &link(b, a)}) {
      h->travel_time_s = s;
      h->distance_m = 1500.0 * s;
    }
  }

  void Reset(std::uint64_t, std::uint32_t) override {}
  Hearing Hear(const PacketKey& key, const NodeMotion&, const NodeMotion&,
               const ModemProfile&) override {
    return link(key.source, key.receiver);
  }
  NoiseSpan Noise(int node, TimeNs t, double, const ModemProfile&) override {
    NoiseSpan span;
    span.quiet_level_db = span.level_db = noise_db[static_cast<std::size_t>(node)];
    span.until = std::numeric_limits<TimeNs>::max();
    if (t < burst_begin) {
      span.until = burst_begin;
    } else if (t < burst_end) {
      span.level_db = burst_db;
      span.until = burst_end;
    }
    return span;
  }
  Hearing Expect(const NodeMotion&, const NodeMotion&, const ModemProfile&) const override {
    return links_[1];
  }
  double SoundSpeed(const Vec3<double>&) const override { return 1500.0; }

  std::vector<double> noise_db;
  TimeNs burst_begin = std::numeric_limits<TimeNs>::max(), burst_end = 0;
  double burst_db = 0.0;

 private:
  std::size_t nodes_;
  std::vector<Hearing> links_;
};

/// Keeps everything that the network reports.
struct Log : PacketObserver {
  struct Discarded {
    PacketInfo packet;
    DropReason reason;
    TimeNs t;
  };
  struct Fate {
    PacketInfo packet;
    PacketFate fate;
  };
  void OnQueued(const PacketInfo& p) override { queued.push_back(p); }
  void OnDiscarded(const PacketInfo& p, DropReason r, TimeNs t) override {
    discarded.push_back({p, r, t});
  }
  void OnSent(const PacketInfo& p) override { sent.push_back(p); }
  void OnFate(const PacketInfo& p, const PacketFate& f) override { fates.push_back({p, f}); }
  void OnPing(const PingResult& r) override { pings.push_back(r); }

  /// The fate of a packet of `source` at `receiver`. The test fails unless it is reported once.
  PacketFate Of(int source, int receiver, std::uint32_t sequence = 0) const {
    PacketFate found;
    int times = 0;
    for (const Fate& f : fates) {
      if (f.packet.source != source || f.fate.receiver != receiver ||
          f.packet.sequence != sequence || f.packet.kind != PacketKind::kData) {
        continue;
      }
      found = f.fate;
      ++times;
    }
    EXPECT_EQ(times, 1) << "from " << source << " to " << receiver;
    return found;
  }

  std::vector<PacketInfo> queued, sent;
  std::vector<Discarded> discarded;
  std::vector<Fate> fates;
  std::vector<PingResult> pings;
};

/// A modem whose packets take a second. It acquires at 3 dB. Half of the whole packets are lost at
/// 10 dB: 2^-x of them survive, with x = 10^((10 - SINR) / 1.5).
inline const char* SecondModem() {
  static const bool added = [] {
    ModemProfiles().Add("second", [] {
      auto p = std::make_unique<ModemProfile>();
      p->name = p->waveform = "second";
      p->centre_khz = 25.0;
      p->bandwidth_khz = 5.0;
      p->frame_s = 1.0;
      p->frame_bytes = 100;
      p->max_frames = 3;
      p->acquisition_db = 3.0;
      p->errors.kind = ErrorCurve::Kind::kCoded;
      p->errors.half_db = 10.0;
      p->errors.frame_bits = 800.0;
      p->errors.decade_db = 1.5;
      p->turnaround_s = 0.25;
      p->transmit_w = 50.0;
      p->receive_w = 2.0;
      p->idle_w = 0.5;
      return p;
    });
    return true;
  }();
  (void)added;
  return "second";
}

/// A network of these modems in a medium that the test sets. Access is ALOHA unless a test sets
/// another.
struct Bench {
  explicit Bench(int nodes) {
    run.agents = nodes;
    config.model = "physical";
    config.access = "aloha";
    config.physical.modem.profile = SecondModem();
    auto stated = std::make_unique<StatedMedium>(nodes);
    medium = stated.get();
    medium_ = std::move(stated);
  }
  /// Builds the network. The configuration must be complete.
  Network& Start(std::uint64_t seed = 1) {
    network = std::make_unique<Network>(config, run, std::move(medium_));
    network->Reset(seed, 0);
    network->Observe(&log);
    return *network;
  }
  void Offer(int source, double t_s, int destination = kToAll, std::uint32_t tag = 0) const {
    static const std::uint8_t bytes[100] = {};
    Transmission packet;
    packet.source = source;
    packet.destination = destination;
    packet.stamp = packet.generation = Ns(t_s);
    packet.tag = tag;
    packet.payload = {bytes, std::min(sizeof(bytes), network->max_payload())};
    network->Offer(packet);
  }

  /// Starts, offers packets (source, time [s]) and lets 20 s pass.
  void Play(const std::vector<std::pair<int, double>>& offers) {
    Start();
    for (const auto& [source, t_s] : offers) Offer(source, t_s);
    network->Advance(Ns(20.0));
  }

  RunConfig run;
  ChannelConfig config;
  StatedMedium* medium;
  std::unique_ptr<Network> network;
  Log log;

 private:
  std::unique_ptr<Medium> medium_;
};

}  // namespace stg::acoustics
