#include "stg_agent/stations/station_channel.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "auv_pings.hpp"
#include "auv_usbl.hpp"

namespace stg::agent {
namespace {

using acoustics::Channel;
using acoustics::PacketFate;
using acoustics::PacketInfo;

/// Passes on events between AUVs only, because the observers do not know other members. AuvPings
/// gets all requests that leave and all results.
class AuvPackets : public acoustics::PacketObserver {
 public:
  AuvPackets(int auvs, AuvPings* pings) : auvs_(auvs), pings_(pings) {}
  void Pass(acoustics::PacketObserver* to) { to_ = to; }
  bool listens() const { return to_ != nullptr || pings_ != nullptr; }

  void OnQueued(const PacketInfo& p) override {
    if (Of(p)) to_->OnQueued(p);
  }
  void OnDiscarded(const PacketInfo& p, acoustics::DropReason reason, TimeNs t) override {
    if (Of(p)) to_->OnDiscarded(p, reason, t);
  }
  void OnSent(const PacketInfo& p) override {
    if (pings_ != nullptr) pings_->OnSent(p);
    if (Of(p)) to_->OnSent(p);
  }
  void OnSendEnd(const PacketInfo& p) override {
    if (Of(p)) to_->OnSendEnd(p);
  }
  void OnAcquired(const PacketInfo& p, int receiver, TimeNs begin) override {
    if (Of(p) && receiver < auvs_) to_->OnAcquired(p, receiver, begin);
  }
  void OnReceptionEnd(const PacketInfo& p, const acoustics::HeardEnd& end, TimeNs t) override {
    if (Of(p) && end.fate.receiver < auvs_) to_->OnReceptionEnd(p, end, t);
  }
  void OnFate(const PacketInfo& p, const PacketFate& fate) override {
    if (Of(p) && fate.receiver < auvs_) to_->OnFate(p, fate);
  }
  void OnPing(const acoustics::PingResult& ping) override {
    if (pings_ != nullptr) pings_->OnPing(ping);
    if (to_ != nullptr && ping.source < auvs_ && ping.destination >= 0 &&
        ping.destination < auvs_) {
      to_->OnPing(ping);
    }
  }

 private:
  bool Of(const PacketInfo& p) const {
    if (to_ == nullptr || p.source >= auvs_) return false;
    return p.kind == acoustics::PacketKind::kData || (p.destination >= 0 && p.destination < auvs_);
  }

  int auvs_;
  AuvPings* pings_;
  acoustics::PacketObserver* to_ = nullptr;
};

class StationChannel : public Channel {
 public:
  /// @param targets number of targets with transponders; 0: none is pinged
  StationChannel(const AgentModel& model, const dynamics::SensingConfig& sensing, int targets,
                 std::unique_ptr<Channel> water, StationObserver* observer)
      : auvs_(model.run.agents),
        targets_(targets),
        members_(model.members()),
        water_(std::move(water)),
        observer_(observer),
        pings_(targets > 0 || model.pings_members() ? std::make_unique<AuvPings>(model, sensing)
                                                    : nullptr),
        usbl_(model.measures_directions() ? std::make_unique<AuvUsbl>(model) : nullptr),
        packets_observer_(auvs_, pings_.get()) {
    const auto constants = std::make_shared<const AgentConstants>(model);
    for (int k = 0; k < model.stations.count(); ++k) stations_.emplace_back(constants, k);
    const auto members = static_cast<std::size_t>(members_ + targets_);
    positions_.resize(members);
    velocities_.resize(members);
    packets_.resize(stations_.size());
    offered_.reserve(members);
    received_.reserve(8 * members);
    if (packets_observer_.listens()) water_->Observe(&packets_observer_);
  }

  void Reset(std::uint64_t seed, std::uint32_t episode) override {
    water_->Reset(seed, episode);
    for (Station& s : stations_) s.Reset(seed, episode);
    if (pings_ != nullptr) pings_->Reset(seed, episode);
    if (usbl_ != nullptr) usbl_->Reset(seed, episode);
  }
  void Observe(acoustics::PacketObserver* observer) override {
    packets_observer_.Pass(observer);
    water_->Observe(packets_observer_.listens() ? &packets_observer_ : nullptr);
  }
  void SetPresent(int node, bool present) override { water_->SetPresent(node, present); }
  int nodes() const override { return auvs_; }
  int bodies() const override { return auvs_ + targets_; }
  std::size_t max_payload() const override { return water_->max_payload(); }
  bool Due(int node, TimeNs t) override { return water_->Due(node, t); }
  bool measures_directions() const override { return usbl_ != nullptr; }
  void SetAttitudes(const std::vector<Mat3<double>>& R_WB) override {
    if (usbl_ != nullptr) usbl_->Turn(R_WB);
  }

  void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
            const std::vector<Vec3<double>>& v_W,
            const std::vector<acoustics::Transmission>& offered) override {
    offered_ = offered;
    now_ = t;
    for (int i = 0; i < auvs_; ++i) {
      positions_[At(i)] = p_W[At(i)];
      velocities_[At(i)] = v_W[At(i)];
    }
    for (int k = 0; k < targets_; ++k) {
      positions_[At(members_ + k)] = p_W[At(auvs_ + k)];
      velocities_[At(members_ + k)] = v_W[At(auvs_ + k)];
    }
    for (std::size_t k = 0; k < stations_.size(); ++k) {
      Station& station = stations_[k];
      if (step > 0) {
        received_.clear();
        water_->Deliver(station.member(), t, &received_);
        for (const acoustics::Reception& r : received_) {
          const Vec3<double> sender =
              positions_[At(r.source)] - velocities_[At(r.source)] * Seconds(t - r.transmit);
          station.Receive(r, sender - station.At(r.transmit));
        }
      }
      station.Advance(t, step);
      positions_[At(station.member())] = station.p_W();
      velocities_[At(station.member())] = station.v_W();
      if (observer_ != nullptr) observer_->OnStation(static_cast<int>(k), t, station);
      if (!water_->Due(station.member(), t)) continue;
      packets_[k] = station.MakePacket();
      acoustics::Transmission& packet = offered_.emplace_back();
      packet.source = station.member();
      packet.stamp = packet.generation = t;
      packet.payload = acoustics::ViewOf(packets_[k]);
    }
    if (pings_ != nullptr) pings_->Ask(t, step, positions_, water_.get());
    water_->Step(t, step, positions_, velocities_, offered_);
  }

  void Deliver(int receiver, TimeNs until, std::vector<acoustics::Reception>* out) override {
    const std::size_t before = out->size();
    water_->Deliver(receiver, until, out);
    if (pings_ != nullptr) pings_->Take(receiver, until, before, out);
    if (usbl_ != nullptr) {
      usbl_->Measure(receiver, now_, positions_, velocities_, before, out);
    }
  }
  acoustics::LinkStatistics Link(int source, int destination, TimeNs now) const override {
    return water_->Link(source, destination, now);
  }
  const acoustics::ChannelTotals& totals() const override { return water_->totals(); }
  double EnergyJ(int node, TimeNs now) const override { return water_->EnergyJ(node, now); }
  double SentS(int node, TimeNs now) const override { return water_->SentS(node, now); }
  acoustics::PingTotals pings() const override {
    return pings_ != nullptr ? pings_->totals() : acoustics::PingTotals();
  }

 private:
  static std::size_t At(int i) { return static_cast<std::size_t>(i); }

  int auvs_, targets_, members_;
  std::unique_ptr<Channel> water_;
  StationObserver* observer_;
  std::unique_ptr<AuvPings> pings_;  // null: there are no pings
  std::unique_ptr<AuvUsbl> usbl_;    // null: AUVs measure no directions
  AuvPackets packets_observer_;
  std::vector<Station> stations_;
  std::vector<Packet> packets_;  // [stations]
  TimeNs now_ = 0;               // of the next two
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<acoustics::Transmission> offered_;
  std::vector<acoustics::Reception> received_;
};

}  // namespace

std::unique_ptr<Channel> MakeStationChannel(const AgentModel& model,
                                            const acoustics::ChannelConfig& channel,
                                            const dynamics::SensingConfig& sensing,
                                            const acoustics::LineOfSight& line_of_sight,
                                            StationObserver* observer) {
  const int targets = sensing.pings() ? model.target.count : 0;
  auto water = acoustics::MakeChannel(channel, NetworkRun(model.run, model.stations, targets),
                                      line_of_sight);
  const bool bare = model.stations.count() + targets == 0 && !model.pings_members();
  if (bare && !model.measures_directions()) return water;
  return std::make_unique<StationChannel>(model, sensing, targets, std::move(water), observer);
}

}  // namespace stg::agent
