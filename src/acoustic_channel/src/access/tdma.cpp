#include "acoustic_channel/access/tdma.hpp"

#include <cmath>
#include <string>

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(SlotsConfig* c, config::Table* t) {
  t->Add("length_s", &c->length_s, config::Within(1e-3, 1e4), "s",
         "length of a slot: airtime and guard");
  t->Add("guard_s", &c->guard_s, config::NonNegative(1e4), "s",
         "last part of a slot, in which no modem sends: travel time to the farthest node");
}

void DescribeDraw(SlotsConfig* c, config::Table* t) {
  t->Add("send_probability", &c->send_probability, config::Within(1e-6, 1.0), "-",
         "probability that a waiting packet is sent in a slot");
}

std::optional<config::Violation> FindSlotConflict(const SlotsConfig& config, TimeNs airtime) {
  const double needed_s = Seconds(airtime) + config.guard_s;
  if (config.length_s >= needed_s * (1.0 - 1e-12)) return {};
  return config::Violation{
      {"channel.slots.length_s", "channel.slots.guard_s", "channel.physical.modem.packet_bytes"},
      "a slot of " + std::to_string(config.length_s) + " s cannot hold a packet of " +
          std::to_string(Seconds(airtime)) + " s and the guard"};
}

Tdma::Tdma(const SlotsConfig& config, int nodes)
    : config_(config), slot_(std::llround(config.length_s * 1e9)), frame_(slot_ * nodes) {}

TimeNs Tdma::Next(int node, TimeNs from, const Attempt& /*attempt*/) const {
  const TimeNs first = slot_ * node;
  if (from <= first) return first;
  return first + (from - first + frame_ - 1) / frame_ * frame_;
}

std::optional<config::Violation> Tdma::FindConflict(const PacketTime& packet) const {
  if (auto violation = FindSlotConflict(config_, packet.airtime)) return violation;
  const TimeNs busy = packet.airtime + packet.turnaround;
  if (busy <= frame_) return {};
  return config::Violation{
      {"channel.slots.length_s", "channel.physical.modem.profile"},
      "a modem is busy for " + std::to_string(Seconds(busy)) +
          " s with a packet, but a round of slots is shorter; use longer slots"};
}

std::unique_ptr<MediumAccess> MakeTdma(const ChannelConfig& config, const RunConfig& run) {
  return std::make_unique<Tdma>(config.slots, run.agents - run.transponders);
}

}  // namespace stg::acoustics
