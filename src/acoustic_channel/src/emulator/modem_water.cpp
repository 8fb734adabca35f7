#include "acoustic_channel/emulator/modem_water.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"
#include "acoustic_channel/network/water_medium.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

/// A modem sends when its host says so. Any other medium access would add a delay that no real
/// modem has.
const ChannelConfig& CheckedForModems(const ChannelConfig& config, const RunConfig& run) {
  const auto require = [](bool fits, const char* key, const char* what) {
    if (!fits) throw UserError(std::string(key) + ": emulated modems need " + what);
  };
  require(PropagationModels().Make(config.model, config.models, config)->has_modems(),
          "channel.model", "a model with modems, such as physical");
  const auto access = MakeMediumAccess(config, run);
  access->Reset(0, 0);
  Attempt again;
  again.sequence = 1;
  again.last_end = 1;
  for (const TimeNs t : {TimeNs{2}, TimeNs{1'234'567'891}}) {
    require(!access->listens() && access->Next(run.agents - 1, t, again) == t, "channel.access",
            "one that lets every packet leave at once: aloha, with channel.contention.rest_s 0");
  }
  require(config.physical.modem.queue == QueuePolicy::kFifo, "channel.physical.modem.queue",
          "fifo");
  return config;
}

}  // namespace

class ModemWater::Surroundings : public ModemSurroundings {
 public:
  Surroundings(ModemWater* water, int node) : water_(water), node_(node) {}

  void Write(const std::string& bytes) override { water_->hosts_->Write(node_, bytes); }
  void Announce(const std::string& notification) override {
    water_->hosts_->Announce(node_, notification);
  }
  void HangUp() override { water_->hosts_->HangUp(node_); }
  void Send(Transmission packet) override {
    packet.source = node_;
    packet.stamp = packet.generation = std::max<TimeNs>(water_->now(), 0);
    water_->network_.Offer(packet);
  }
  bool TakeBack(std::uint32_t tag) override { return water_->network_.Cancel(node_, tag); }
  void SetAddress(int address) override {
    for (std::size_t i = 0; i < water_->members_.size(); ++i) {
      const bool other = static_cast<int>(i) != node_;
      if (other && water_->members_[i].address == address) {
        water_->hosts_->OnSharedAddress(node_, address);
      }
    }
    water_->At(node_).address = address;
  }
  int NodeOf(int address) const override {
    const auto& members = water_->members_;
    const auto found = std::find_if(members.begin(), members.end(),
                                    [&](const Member& m) { return m.address == address; });
    return found == members.end() ? kToNone : static_cast<int>(found - members.begin());
  }
  int AddressOf(int node) const override { return water_->AddressOf(node); }
  const ModemProfile& profile() const override { return water_->network_.profile(node_); }
  void SetWaveforms(std::vector<std::string> waveforms) override {
    water_->network_.SetWaveforms(node_, std::move(waveforms));
  }
  double ClockS(TimeNs t) const override { return water_->network_.ClockS(node_, t); }
  TimeNs utc_start() const override { return water_->utc_start_; }
  double SoundSpeed() const override { return water_->network_.SoundSpeed(node_); }

 private:
  ModemWater* water_;
  int node_;
};

ModemWater::ModemWater(const ChannelConfig& config, const RunConfig& run,
                       std::unique_ptr<Medium> medium, ModemHosts* hosts)
    : hosts_(hosts),
      network_(CheckedForModems(config, run), run, std::move(medium)),
      members_(static_cast<std::size_t>(run.agents)) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    members_[i].surroundings = std::make_unique<Surroundings>(this, static_cast<int>(i));
    members_[i].address = static_cast<int>(i) + 1;
  }
  network_.Observe(this);
}
ModemWater::ModemWater(const ChannelConfig& config, const RunConfig& run, ModemHosts* hosts)
    : ModemWater(config, run, std::make_unique<WaterMedium>(config.physical, run.agents), hosts) {}
ModemWater::~ModemWater() = default;

void ModemWater::Attach(int node, int address, const MakeEngine& make) {
  Member& m = At(node);
  m.address = address;
  m.engine = make(m.surroundings.get());
}

int ModemWater::AddressOf(int node) const {
  return node < 0 ? 0 : members_[static_cast<std::size_t>(node)].address;
}

void ModemWater::Reset(std::uint64_t seed, std::uint32_t episode) {
  network_.Reset(seed, episode);
  events_.clear();
  network_.Advance(0);
  for (Member& m : members_) {
    if (m.engine) m.engine->Start(0);
  }
}

void ModemWater::Connect(int node, TimeNs t) {
  Advance(t);
  At(node).engine->Connect(t);
  Advance(t);
}
void ModemWater::Disconnect(int node, TimeNs t) {
  Advance(t);
  At(node).engine->Disconnect(t);
  Advance(t);
}
void ModemWater::Read(int node, TimeNs t, ByteView bytes) {
  Advance(t);
  At(node).engine->Read(t, bytes);
  Advance(t);
}

void ModemWater::Offer(const Transmission& packet, TimeNs t) {
  Advance(t);
  network_.Offer(packet);
}
void ModemWater::Move(int node, TimeNs t, const NodeMotion& motion) {
  Advance(t);
  network_.Move(node, t, motion.p_W, motion.v_W);
}
void ModemWater::SetPresent(int node, TimeNs t, bool present) {
  Advance(t);
  if (network_.present(node) == present) return;
  network_.SetPresent(node, t, present);
  Dispatch();
}

void ModemWater::Restart(int node, TimeNs t) {
  Advance(t);
  At(node).engine->Start(t);
  Dispatch();
}

TimeNs ModemWater::next() const {
  TimeNs first = network_.next();
  for (const Member& m : members_) {
    if (m.engine) first = std::min(first, m.engine->next());
  }
  return std::max(first, now());
}

void ModemWater::Advance(TimeNs t) {
  bool happened = false;
  for (;;) {
    Dispatch();
    const TimeNs first = next();
    if (first > t) break;
    happened = true;
    network_.Advance(first);
    Dispatch();
    for (Member& m : members_) {
      if (m.engine && m.engine->next() <= first) m.engine->Tick(first);
    }
  }
  if (t > now()) network_.Advance(t);
  if (happened) ForgetReceptions();
}

/// Modems have received them as events already.
void ModemWater::ForgetReceptions() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].engine) network_.Take(static_cast<int>(i), now(), &scratch_);
  }
  scratch_.clear();
  network_.Recycle();
}

/// Passes the events to the modems. Their answers may cause more events.
void ModemWater::Dispatch() {
  while (!events_.empty()) {
    Addressed a = std::move(events_.front());
    events_.pop_front();
    a.event.end.payload = ViewOf(a.event.payload);
    At(a.node).engine->Handle(a.event);
  }
}

void ModemWater::Add(ModemEvent::Kind kind, int node, TimeNs t, const PacketInfo& packet) {
  if (!At(node).engine) return;
  Addressed& a = events_.emplace_back();
  a.node = node;
  a.event.kind = kind;
  a.event.t = t;
  a.event.packet = packet;
}

void ModemWater::OnQueued(const PacketInfo& packet) {
  if (observer_ != nullptr) observer_->OnQueued(packet);
}
void ModemWater::OnDiscarded(const PacketInfo& packet, DropReason reason, TimeNs t) {
  Add(ModemEvent::Kind::kDiscarded, packet.source, t, packet);
  if (observer_ != nullptr) observer_->OnDiscarded(packet, reason, t);
}
void ModemWater::OnSent(const PacketInfo& packet) {
  Add(ModemEvent::Kind::kSent, packet.source, packet.transmit, packet);
  if (observer_ != nullptr) observer_->OnSent(packet);
}
void ModemWater::OnSendEnd(const PacketInfo& packet) {
  Add(ModemEvent::Kind::kSendEnd, packet.source, packet.transmit_end, packet);
  if (observer_ != nullptr) observer_->OnSendEnd(packet);
}
void ModemWater::OnAcquired(const PacketInfo& packet, int receiver, TimeNs begin) {
  Add(ModemEvent::Kind::kAcquired, receiver, begin, packet);
  if (observer_ != nullptr) observer_->OnAcquired(packet, receiver, begin);
}
void ModemWater::OnReceptionEnd(const PacketInfo& packet, const HeardEnd& end, TimeNs t) {
  const std::size_t before = events_.size();
  Add(ModemEvent::Kind::kReceptionEnd, end.fate.receiver, t, packet);
  if (events_.size() > before) {
    ModemEvent& event = events_.back().event;
    event.end = end;
    event.payload.assign(end.payload.data, end.payload.data + end.payload.size);
  }
  if (observer_ != nullptr) observer_->OnReceptionEnd(packet, end, t);
}
void ModemWater::OnFate(const PacketInfo& packet, const PacketFate& fate) {
  if (observer_ != nullptr) observer_->OnFate(packet, fate);
}
void ModemWater::OnPing(const PingResult& result) {
  if (observer_ != nullptr) observer_->OnPing(result);
}

}  // namespace stg::acoustics
