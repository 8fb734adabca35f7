#include "acoustic_channel/driver/modem_channel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acoustic_channel/models/propagation_model.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

/// Period in which the thread looks for packets to send. Bytes of modems wake it at once.
constexpr TimeNs kLook = 5'000'000;

}  // namespace

ModemChannel::ModemChannel(const ChannelConfig& config, const RunConfig& run,
                           const ModemChannelConfig& modems)
    : turns_(config, run),
      max_payload_(PropagationModels()
                       .Make(config.model, config.models, config)
                       ->max_payload(config, run.agents)),
      freshness_s_(config.physical.modem.freshness_s),
      addresses_(modems.addresses),
      table_(run.agents),
      sequences_(static_cast<std::size_t>(run.agents) * static_cast<std::size_t>(run.agents)),
      given_(static_cast<std::size_t>(run.agents)),
      outgoing_(given_.size()),
      received_(given_.size()),
      health_(given_.size()) {
  if (modems.ports.size() != given_.size()) {
    throw UserError("parameter ports: " + std::to_string(modems.ports.size()) + " modems for " +
                    std::to_string(run.agents) + " agents");
  }
  for (int i = 0; addresses_.size() < given_.size(); ++i) addresses_.push_back(i + 1);
  for (std::size_t i = 0; i < modems.ports.size(); ++i) {
    DriverOptions options;
    options.address = addresses_[i];
    options.broadcast = modems.broadcast;
    options.rssi_offset_db = modems.rssi_offset_db;
    ports_.push_back(
        std::make_unique<ModemPort>(modems.protocol, options, modems.ports[i], modems.baud));
  }
  thread_ = std::thread([this] { Run(); });
}

ModemChannel::~ModemChannel() {
  ends_ = true;
  thread_.join();
}

void ModemChannel::Run() {
  std::vector<ModemPort*> ports;
  for (const auto& port : ports_) ports.push_back(port.get());
  while (!ends_) {
    ModemPort::Serve(ports, SteadyNow() + kLook);
    Exchange();
  }
}

void ModemChannel::Exchange() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const TimeNs now = SteadyNow();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    std::optional<Outgoing>& out = outgoing_[i];
    if (out && now >= out->start) {
      ports_[i]->driver().Send(out->packet, now);
      out.reset();
    }
    for (DriverReception& r : ports_[i]->TakeReceptions()) received_[i].push_back(std::move(r));
    ports_[i]->TakeEvents();
    ports_[i]->TakeRanges();
    const ModemDriver& driver = ports_[i]->driver();
    health_[i] = {ports_[i]->name(), driver.firmware(), driver.ready(), driver.counts()};
  }
}

void ModemChannel::Reset(std::uint64_t seed, std::uint32_t episode) {
  turns_.Reset(seed, episode);
  table_.Reset(0);
  std::fill(sequences_.begin(), sequences_.end(), 0);
  stepped_ = 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& out : outgoing_) out.reset();
  for (auto& in : received_) in.clear();
}

void ModemChannel::Step(TimeNs t, std::uint32_t /*step*/, const std::vector<Vec3<double>>& /*p_W*/,
                        const std::vector<Vec3<double>>& /*v_W*/,
                        const std::vector<Transmission>& offered) {
  const TimeNs now = SteadyNow();
  offset_ = now - t;
  stepped_ = t;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Transmission& packet : offered) {
    const TimeNs start = turns_.Start(packet.source, t);
    if (start == kNever) continue;
    Outgoing out;
    out.start = start + offset_;
    out.packet.tag = packet.tag;
    out.packet.destination = packet.destination == kToAll ? kToAll : AddressOf(packet.destination);
    out.packet.payload.assign(packet.payload.data, packet.payload.data + packet.payload.size);
    outgoing_[static_cast<std::size_t>(packet.source)] = std::move(out);
  }
}

int ModemChannel::NodeOf(int address) const {
  const auto found = std::find(addresses_.begin(), addresses_.end(), address);
  return found == addresses_.end() ? kToNone : static_cast<int>(found - addresses_.begin());
}

void ModemChannel::Deliver(int receiver, TimeNs /*until*/, std::vector<Reception>* out) {
  const auto node = static_cast<std::size_t>(receiver);
  std::vector<DriverReception> received;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    received = std::exchange(received_[node], {});
  }
  given_[node].clear();
  for (DriverReception& heard : received) {
    const int source = NodeOf(heard.source);
    if (source == kToNone || heard.payload.size() > max_payload_) continue;
    Incoming& in = given_[node].emplace_back();
    in.payload = std::move(heard.payload);
    Reception& r = in.reception;
    r.source = source;
    r.receiver = receiver;
    r.destination = heard.destination == kToAll ? kToAll : receiver;
    // Counted for each link, because a gap would be taken for a loss.
    r.sequence = sequences_[static_cast<std::size_t>(source) * given_.size() + node]++;
    // The packet is delivered in this step, and a step may only contain packets that arrive before
    // its end.
    r.arrival = std::clamp<TimeNs>(heard.arrival - offset_, 0, stepped_);
    const TimeNs airtime = static_cast<TimeNs>(heard.airtime_s * 1e9);
    r.transmit = r.generation = std::max<TimeNs>(0, r.arrival - airtime);
    r.received_level_db = heard.received_level_db;
    r.noise_level_db = heard.noise_level_db;
    r.sinr_db = heard.sinr_db;
    r.doppler_mps = heard.doppler_mps;
    r.link_quality = std::exp(-Seconds(r.arrival - r.generation) / freshness_s_);
    table_.Deliver(source, receiver, r.generation, r.transmit, r.arrival);
  }
  for (const Incoming& in : given_[node]) {
    out->push_back(in.reception);
    out->back().payload = {reinterpret_cast<const std::uint8_t*>(in.payload.data()),
                           in.payload.size()};
  }
}

LinkStatistics ModemChannel::Link(int source, int destination, TimeNs now) const {
  if (source == destination) return {};
  LinkStatistics s = table_.At(source, destination, now);
  if (s.delivered > 0) s.quality = std::exp(-s.age_s / freshness_s_);
  return s;
}

ModemChannel::PortHealth ModemChannel::health(int node) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return health_[static_cast<std::size_t>(node)];
}

}  // namespace stg::acoustics
