#include "auv_pings.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::agent {
namespace {

/// Limit for an answer; the next ping of the AUV ends the wait sooner.
constexpr TimeNs kTimeout = 300'000'000'000;
constexpr double kSlowestSound_mps = 1400.0;
constexpr double kFarMember_m = 3000.0;

TimeNs PeriodOf(double seconds) { return std::max<TimeNs>(std::llround(seconds * 1e9), 1); }

/// Largest distance to anything that AUVs ping.
double ReachOf(const AgentModel& model, const dynamics::SensingConfig& sensing) {
  return std::max(sensing.pings() ? sensing.range_m : 0.0,
                  model.pings_members() ? kFarMember_m : 0.0);
}

/// Time from the request to the answer at the edge of the reach.
TimeNs ExchangeOf(const acoustics::ChannelConfig& channel, int nodes, double reach_m) {
  double longest_s = 0.0;
  for (const acoustics::ModemProfile& p : acoustics::MakeProfiles(channel.physical.modem, nodes)) {
    longest_s = std::max(longest_s, 2.0 * p.airtime_s(1) + p.turnaround_s);
  }
  return std::llround((longest_s + 2.0 * reach_m / kSlowestSound_mps) * 1e9);
}

}  // namespace

AuvPings::AuvPings(const AgentModel& model, const dynamics::SensingConfig& sensing)
    : run_(model.run),
      fleet_(model.fleet),
      target_(model.target),
      free_(model.task.free()),
      sensing_(sensing),
      options_(sensing.relative()),
      first_target_(model.members()),
      look_period_(sensing.pings() ? PeriodOf(sensing.period_s) : 0),
      member_period_(model.pings_members() ? PeriodOf(model.localization.ping_period_s) : 0),
      exchange_(ExchangeOf(model.channel, model.run.agents, ReachOf(model, sensing))),
      pingers_(static_cast<std::size_t>(model.run.agents)) {}

void AuvPings::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  std::fill(pingers_.begin(), pingers_.end(), Pinger());
  totals_ = {};
}

/// If the AUV may choose its target, it ranges all of them in turn.
int AuvPings::TargetOf(int auv) const {
  if (!free_) return target_.of(auv);
  const auto asked = static_cast<int>(pingers_[static_cast<std::size_t>(auv)].asked);
  return (target_.of(auv) + asked) % target_.count;
}

int AuvPings::NextMember(int auv) const {
  const int last = pingers_[static_cast<std::size_t>(auv)].last_member;
  const int next = ((last < 0 ? auv : last) + 1) % first_target_;
  return next == auv ? (next + 1) % first_target_ : next;
}

int AuvPings::AskTarget(int auv, std::uint32_t step, const std::vector<Vec3<double>>& p_W) {
  Pinger& p = pingers_[static_cast<std::size_t>(auv)];
  const int node = first_target_ + TargetOf(auv);
  const double range =
      Norm(p_W[static_cast<std::size_t>(node)] - p_W[static_cast<std::size_t>(auv)]);
  Random random(seed_, Stream::kPing, episode_, step, static_cast<std::uint32_t>(auv));
  const double luck = random.Uniform();
  p.error = random.Normal();
  const double share = range / sensing_.range_m;
  const bool answers =
      share <= 1.0 && luck < options_.chance(sensing_.detection_probability, share);
  return answers ? node : acoustics::kToNone;
}

void AuvPings::Ask(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
                   acoustics::Channel* water) {
  for (int i = 0; i < run_.agents; ++i) {
    Pinger& p = pingers_[static_cast<std::size_t>(i)];
    if (look_period_ > 0 && t % look_period_ == 0) p.look_due = true;
    if (member_period_ > 0 && t % member_period_ == 0) p.member_due = first_target_ > 1;
    if (!(p.look_due || p.member_due) || !fleet_.present(i, Seconds(t))) continue;
    // One exchange after the other.
    if (p.waits || (p.sent >= 0 && t - p.sent < exchange_)) continue;
    int node = 0;
    if (p.look_due) {
      node = AskTarget(i, step, p_W);
      p.look_due = false;
    } else {
      node = p.last_member = NextMember(i);
      p.member_due = false;
    }
    ++p.asked;
    p.waits = true;
    p.tag = step;
    water->Ping(i, node, t, kTimeout, step);
  }
}

void AuvPings::OnSent(const acoustics::PacketInfo& packet) {
  if (packet.kind != acoustics::PacketKind::kPing || packet.source >= run_.agents) return;
  Pinger& p = pingers_[static_cast<std::size_t>(packet.source)];
  p.sent = packet.transmit;
  p.waits = false;
  ++totals_.sent;
}

void AuvPings::OnPing(const acoustics::PingResult& ping) {
  if (ping.source >= run_.agents) return;
  Pinger& p = pingers_[static_cast<std::size_t>(ping.source)];
  if (ping.tag != p.tag) return;  // it was given up for the ping that waits
  const TimeNs sent = p.sent;
  p.sent = -1;
  p.waits = false;
  if (!ping.answered) return;
  ++totals_.answered;
  acoustics::Reception& r = p.answer;
  r = acoustics::Reception();
  r.source = ping.destination;
  r.receiver = r.destination = ping.source;
  r.sequence = p.asked;
  r.generation = ping.middle;
  r.transmit = sent;
  r.arrival = ping.ended;
  r.travel_time_s = 0.5 * ping.round_trip_s;
  if (ping.destination >= first_target_ && ping.range_m > 0.0) {
    const double error_m = options_.range_std(ping.range_m) * p.error;
    r.travel_time_s *= std::abs(1.0 + error_m / ping.range_m);
  }
  p.answered = true;
}

void AuvPings::Take(int receiver, TimeNs until, std::size_t first,
                    std::vector<acoustics::Reception>* out) {
  Pinger& p = pingers_[static_cast<std::size_t>(receiver)];
  if (!p.answered || p.answer.arrival > until) return;
  p.answered = false;
  auto at = out->begin() + static_cast<std::ptrdiff_t>(first);
  while (at != out->end() && at->arrival <= p.answer.arrival) ++at;
  out->insert(at, p.answer);
}

std::optional<config::Violation> FindPingConflict(const AgentModel& s,
                                                  const dynamics::SensingConfig& sensing) {
  const bool looks = sensing.pings(), members = s.pings_members();
  if (!looks && !members) return {};
  const auto water =
      acoustics::PropagationModels().Make(s.channel.model, s.channel.models, s.channel);
  if (!water->has_modems()) {
    return config::Violation{{"sensing.ranging", "channel.model"},
                             "only modems can ping: set channel.model to physical"};
  }
  const double dt_s = s.run.decision_dt_s(), member_period_s = s.localization.ping_period_s;
  if (members && !IsWholeDecisions(member_period_s, dt_s)) {
    return config::Violation{{"localization.ranges.ping_period_s", "time.decision_steps"},
                             "the period must be a whole number of decisions"};
  }
  const RunConfig network = NetworkRun(s.run, s.stations, looks ? s.target.count : 0);
  if (auto violation = acoustics::FindConflict(s.channel, network)) return violation;
  const double each_s = Seconds(acoustics::RoundOf(s.channel, network) +
                                ExchangeOf(s.channel, network.agents, ReachOf(s, sensing)));
  double taken = 0.0;
  if (looks) taken += each_s / std::max(sensing.period_s, dt_s);
  if (members) taken += each_s / member_period_s;
  if (taken <= 1.0) return {};
  config::Violation violation;
  if (looks) violation.keys = {"sensing.period_s", "sensing.ranging"};
  if (members) {
    violation.keys.insert(violation.keys.end(),
                          {"localization.ranges.ping_period_s", "localization.ranges.by"});
  }
  violation.keys.emplace_back("channel.access");
  violation.message =
      "a ping takes an AUV up to " + std::to_string(each_s) +
      " s, with the wait for its turn and the answer; pings are due more often than that";
  return violation;
}

}  // namespace stg::agent
