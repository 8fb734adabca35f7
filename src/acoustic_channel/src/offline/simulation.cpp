#include "acoustic_channel/offline/simulation.hpp"

#include <algorithm>
#include <cmath>

namespace stg::acoustics {

/// Counts the reported events and passes them on.
class Simulation::Tally : public PacketObserver {
 public:
  Tally(int nodes, PacketObserver* next) : nodes_(nodes), next_(next) {
    counts_.receivers.resize(static_cast<std::size_t>(nodes));
    received_.resize(static_cast<std::size_t>(nodes));
  }

  void OnQueued(const PacketInfo& packet) override {
    if (next_ != nullptr) next_->OnQueued(packet);
  }
  void OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs t) override {
    counts_.drops[static_cast<std::size_t>(reason)] += Receivers(packet);
    if (next_ != nullptr) next_->OnDiscarded(packet, reason, t);
  }
  void OnSent(const PacketInfo& packet) override {
    ++counts_.transmitted;
    counts_.expected += Receivers(packet);
    if (next_ != nullptr) next_->OnSent(packet);
  }
  void OnFate(const PacketInfo& packet, const PacketFate& fate) override {
    ++decided_;
    if (fate.reason == DropReason::kNone) {
      ++counts_.delivered;
      ++counts_.receivers[static_cast<std::size_t>(fate.receiver)].delivered;
      received_[static_cast<std::size_t>(fate.receiver)] += fate.arrival - fate.begin;
    } else {
      ++counts_.drops[static_cast<std::size_t>(fate.reason)];
    }
    if (next_ != nullptr) next_->OnFate(packet, fate);
  }
  void Offered() { ++counts_.offered; }

  SimulationSummary At(TimeNs now) const {
    SimulationSummary summary = counts_;
    summary.duration_s = Seconds(now);
    summary.in_flight = counts_.expected - decided_;
    for (std::size_t i = 0; i < received_.size() && now > 0; ++i) {
      summary.receivers[i].throughput =
          static_cast<double>(received_[i]) / static_cast<double>(now);
    }
    return summary;
  }

 private:
  std::uint64_t Receivers(const PacketInfo& packet) const {
    return packet.destination == kToAll ? static_cast<std::uint64_t>(nodes_ - 1) : 1;
  }

  int nodes_;
  PacketObserver* next_;
  SimulationSummary counts_;
  std::uint64_t decided_ = 0;
  std::vector<TimeNs> received_;  ///< airtime of delivered packets, by receiver
};

Simulation::Simulation(const SimulationFile& file, PacketObserver* log)
    : file_(file),
      tally_(std::make_unique<Tally>(static_cast<int>(file.nodes.size()), log)),
      channel_(MakeChannel(file.channel, file.Run())),
      traffic_(file.traffic, file.seed),
      end_(std::llround(file.duration_s * 1e9)),
      step_period_(file.Run().decision_period()),
      p_W_(file.nodes.size()),
      v_W_(file.nodes.size()),
      present_(file.nodes.size(), 1),
      payload_(channel_->max_payload(), 0) {
  channel_->Reset(file.seed, 0);
  channel_->Observe(tally_.get());
}

Simulation::~Simulation() = default;

void Simulation::Place() {
  const double t_s = Seconds(now_);
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const SimulatedNode& node = file_.nodes[i];
    node.track.At(t_s, &p_W_[i], &v_W_[i]);
    const bool present = t_s >= node.joins_s && (node.leaves_s == 0.0 || t_s < node.leaves_s);
    if (present != (present_[i] != 0)) {
      present_[i] = present ? 1 : 0;
      channel_->SetPresent(static_cast<int>(i), present);
    }
  }
}

void Simulation::Offer() {
  offers_.clear();
  // The end time itself is not part of the run.
  traffic_.Take(now_ == end_ ? end_ - 1 : now_, &offers_);
  transmissions_.clear();
  for (std::size_t k = 0; k < offers_.size(); ++k) {
    const acoustics::Offer& offer = offers_[k];
    tally_->Offered();
    if (!channel_->continuous()) {
      const bool replaced =
          std::any_of(offers_.begin() + static_cast<std::ptrdiff_t>(k) + 1, offers_.end(),
                      [&](const acoustics::Offer& later) { return later.source == offer.source; });
      if (replaced) {
        PacketInfo info;
        info.source = offer.source;
        info.destination = offer.destination;
        info.bytes = offer.bytes;
        info.offered = info.generation = offer.t;
        tally_->OnDiscarded(info, DropReason::kQueue, now_);
        continue;
      }
    }
    Transmission packet;
    packet.source = offer.source;
    packet.destination = offer.destination;
    packet.stamp = channel_->continuous() ? offer.t : now_;
    packet.generation = offer.t;
    packet.payload = {payload_.data(), offer.bytes};
    transmissions_.push_back(packet);
  }
}

bool Simulation::Step() {
  if (now_ >= end_) return false;
  now_ = now_ < 0 ? 0 : std::min(now_ + step_period_, end_);
  const auto deliver = [this] {
    receptions_.clear();
    for (int i = 0; i < channel_->nodes(); ++i) channel_->Deliver(i, now_, &receptions_);
  };
  // A model without its own clock delivers the arrived packets before it takes the next ones.
  if (!channel_->continuous() && step_ > 0) deliver();
  Place();
  Offer();
  channel_->Step(now_, step_++, p_W_, v_W_, transmissions_);
  if (channel_->continuous() || now_ == end_) deliver();
  return now_ < end_;
}

SimulationSummary Simulation::Summary() const {
  SimulationSummary summary = tally_->At(now_);
  const int nodes = channel_->nodes();
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < nodes; ++j) {
      if (i == j) continue;
      const LinkStatistics link = channel_->Link(i, j, now_);
      summary.links.push_back({i, j, link.delivered, link.average_age_s, link.peak_age_s});
    }
    summary.energy_j.push_back(channel_->EnergyJ(i, now_));
  }
  return summary;
}

}  // namespace stg::acoustics
