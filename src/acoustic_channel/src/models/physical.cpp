#include "acoustic_channel/models/physical.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "acoustic_channel/link/received_links.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"

namespace stg::acoustics {
namespace {

class PhysicalModel : public PropagationModel {
 public:
  std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                       LineOfSight line_of_sight) const override {
    return std::make_unique<PhysicalChannel>(config, run, std::move(line_of_sight));
  }
  std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config,
                                                   int nodes) const override {
    return std::make_unique<ReceivedLinks>(config.physical.modem, nodes);
  }
  bool has_modems() const override { return true; }
  PacketTime packet_time(const ChannelConfig& config, int nodes) const override {
    return {LongestAirtime(config.physical.modem, nodes),
            LongestTurnaround(config.physical.modem, nodes)};
  }
  std::size_t max_payload(const ChannelConfig& config, int nodes) const override {
    return LongestPayload(config.physical.modem, nodes);
  }
  std::optional<config::Violation> FindConflict(const ChannelConfig& config,
                                                int nodes) const override {
    if (auto violation = acoustics::FindConflict(config.physical.modem, nodes)) return violation;
    return acoustics::FindConflict(config.physical.water);
  }
};

}  // namespace

void Describe(PhysicalConfig* c, config::Table* t) {
  Describe(&c->modem, t);
  Describe(&c->water, t);
  Describe(&c->noise, t);
  Describe(&c->propagation, t);
  // An ideal modem receives each packet, whatever its level and the noise.
  const std::string section = "channel.physical.", modem = section + "modem.";
  config::Owner real{"modem profile",
                     Without(ModemProfiles().Names(), {"ideal"}),
                     modem + "profile",
                     [c] {
                       const ModemConfig& m = c->modem;
                       return m.profiles.empty() ? std::vector<std::string>{m.profile} : m.profiles;
                     },
                     {modem + "profiles"}};
  real.refusal =
      "ideal modems receive each packet, whatever its level and the noise; choose another " +
      modem + "profile";
  for (const char* key :
       {"noise", "propagation", "water.absorption", "modem.source_level_offset_db"}) {
    t->Own(section + key, real);
  }
}

PhysicalChannel::PhysicalChannel(const ChannelConfig& config, const RunConfig& run,
                                 LineOfSight line_of_sight)
    : network_(config, run, std::move(line_of_sight)),
      turns_(config, run),
      freshness_s_(config.physical.modem.freshness_s),
      present_(static_cast<std::size_t>(run.agents), 1) {}

void PhysicalChannel::Reset(std::uint64_t seed, std::uint32_t episode) {
  network_.Reset(seed, episode);
  turns_.Reset(seed, episode);
  started_ = changed_ = false;
  stepped_ = 0;
  std::fill(present_.begin(), present_.end(), 1);
}

void PhysicalChannel::SetPresent(int node, bool present) {
  present_[static_cast<std::size_t>(node)] = present ? 1 : 0;
  changed_ = true;
}

void PhysicalChannel::Step(TimeNs t, std::uint32_t /*step*/, const std::vector<Vec3<double>>& p_W,
                           const std::vector<Vec3<double>>& v_W,
                           const std::vector<Transmission>& offered) {
  const int n = nodes();
  assert(static_cast<int>(p_W.size()) == n && static_cast<int>(v_W.size()) == n);
  if (!started_) network_.StartStatistics(t);
  started_ = true;
  stepped_ = t;
  network_.Recycle();
  for (int i = 0; changed_ && i < n; ++i) {
    network_.SetPresent(i, t, present_[static_cast<std::size_t>(i)] != 0);
  }
  changed_ = false;
  for (int i = 0; i < n; ++i) {
    const auto u = static_cast<std::size_t>(i);
    if (present_[u] != 0) network_.Move(i, t, p_W[u], v_W[u]);
  }
  for (const Transmission& packet : offered) network_.Offer(packet);
}

void PhysicalChannel::Deliver(int receiver, TimeNs until, std::vector<Reception>* out) {
  if (until > network_.now()) network_.Advance(until);
  network_.Take(receiver, until, out);
}

LinkStatistics PhysicalChannel::Link(int source, int destination, TimeNs now) const {
  assert(source >= 0 && source < nodes() && destination >= 0 && destination < nodes());
  if (source == destination) return {};
  LinkStatistics s = network_.table().At(source, destination, now);
  if (!started_) return s;
  const Hearing link = network_.Expect(source, destination, stepped_);
  s.distance_m = link.distance_m;
  s.delay_s = link.travel_time_s;
  s.loss_probability = network_.ExpectedLoss(source, destination, stepped_);
  s.quality =
      s.delivered > 0 ? (1.0 - s.loss_probability) * std::exp(-s.age_s / freshness_s_) : 0.0;
  return s;
}

void PhysicalChannel::Ping(int source, int destination, TimeNs t, TimeNs timeout,
                           std::uint32_t tag) {
  const auto exists = [this](int node) { return node >= 0 && node < nodes(); };
  const bool to_any = destination == kToNone || exists(destination);
  if (!exists(source) || !to_any || source == destination) {
    throw UserError("ping: no link from " + std::to_string(source) + " to " +
                    std::to_string(destination));
  }
  network_.Ping(source, destination, t, timeout, tag);
}

std::unique_ptr<PropagationModel> MakePhysicalModel(const ChannelConfig& /*config*/) {
  return std::make_unique<PhysicalModel>();
}

}  // namespace stg::acoustics
