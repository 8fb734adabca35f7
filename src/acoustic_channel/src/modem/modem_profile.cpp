#include "acoustic_channel/modem/modem_profile.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

using Profile = std::unique_ptr<ModemProfile>;

double SpreadingDb(const ModemProfile& p) {
  const double bits_per_s = 8.0 * static_cast<double>(p.frame_bytes) / p.frame_s;
  return 10.0 * std::log10(1e3 * p.bandwidth_khz / bits_per_s);
}

/// Instant and lossless; only medium access and queues have an effect.
Profile Ideal() {
  ModemProfile p;
  p.name = p.waveform = "ideal";
  p.ideal = true;
  p.centre_khz = 25.0;
  p.bandwidth_khz = 5.0;
  p.max_frames = 2048;
  p.errors.kind = ErrorCurve::Kind::kNone;
  return std::make_unique<ModemProfile>(p);
}

/// Noncoherent FSK. Its only gain is from spreading.
void DetectNoncoherently(ModemProfile* p) {
  p->errors.kind = ErrorCurve::Kind::kNoncoherentFsk;
  p->errors.processing_gain_db = p->spreading_db = SpreadingDb(*p);
}

/// Properties of a WHOI Micromodem at any rate.
ModemProfile Micromodem(const std::string& waveform, int rate) {
  ModemProfile p;
  p.waveform = "micromodem_" + waveform;
  p.name = p.waveform + "_r" + std::to_string(rate);
  p.source_level_db = 185.0;
  p.acquisition_db = -10.0;
  p.implementation_db = 3.0;
  p.turnaround_s = 0.05;
  p.transmit_w = 50.0;
  p.idle_w = 0.1;
  return p;
}

/// FSK with frequency hopping at 80 bit/s: one frame of 32 bytes.
Profile MicromodemFsk() {
  ModemProfile p = Micromodem("fsk", 0);
  p.centre_khz = 22.0;
  p.bandwidth_khz = 4.0;
  p.frame_s = 3.2;
  p.frame_bytes = 32;
  DetectNoncoherently(&p);
  p.receive_w = 0.2;
  return std::make_unique<ModemProfile>(p);
}

/// A mini-packet of 13 bits: pings, their replies, acknowledgements and starts of cycles. No public
/// document states its duration; recordings sound like 0.9 s.
Profile MicromodemMini() {
  ModemProfile p = Micromodem("fsk", 0);
  p.name = "micromodem_mini";
  p.centre_khz = 22.0;
  p.bandwidth_khz = 4.0;
  p.frame_s = 0.9;
  p.frame_bytes = 2;
  DetectNoncoherently(&p);
  p.receive_w = 0.2;
  return std::make_unique<ModemProfile>(p);
}

/// Coded PSK at 5 kHz. A full set of frames takes the published time, and fewer frames their share
/// of it.
Profile MicromodemPsk(int rate, std::size_t frames, std::size_t frame_bytes, double set_s) {
  ModemProfile p = Micromodem("psk", rate);
  p.centre_khz = 25.0;
  p.bandwidth_khz = 5.0;
  p.frame_s = set_s / static_cast<double>(frames);
  p.frame_bytes = frame_bytes;
  p.max_frames = frames;
  p.spreading_db = SpreadingDb(p);
  if (rate % 2 == 1) {
    p.errors = CodedPskCurve(rate);
  } else {
    // No curve of the even rates is published. The assumption is: they lose half of their frames at
    // the same ratio of energy to noise per bit as the other rates, 3.5 dB on average.
    p.errors.kind = ErrorCurve::Kind::kCoded;
    p.errors.half_db = 3.5 - p.spreading_db;
    p.errors.frame_bits = 8.0 * static_cast<double>(frame_bytes);
  }
  p.receive_w = 2.0;
  return std::make_unique<ModemProfile>(p);
}

/// JANUS baseline packet (NATO STANAG 4748): a preamble of 32 chips, then 144 chips of 64 coded
/// bits, at 160 chips per second. The standard does not set the source level; this one is usual for
/// transducers.
Profile Janus() {
  ModemProfile p;
  p.name = p.waveform = "janus";
  p.centre_khz = 11.52;
  p.bandwidth_khz = 4.16;
  p.source_level_db = 183.0;
  p.preamble_s = 32.0 / 160.0;
  p.frame_s = 144.0 / 160.0;
  p.frame_bytes = 8;
  p.acquisition_db = -8.0;
  p.implementation_db = 3.0;
  DetectNoncoherently(&p);
  p.turnaround_s = 0.1;
  p.transmit_w = 40.0;
  p.receive_w = 0.5;
  p.idle_w = 0.1;
  return std::make_unique<ModemProfile>(p);
}

/// Similar to an EvoLogics S2C R 18/34 with instant messages. Preamble and rate are a straight line
/// through the published airtimes of 16, 32 and 39 bytes, within 1 %. No error curve is published;
/// this one loses half of the frames of 32 bytes at Eb/N0 = 4 dB, like convolutional codes.
Profile Evologics() {
  ModemProfile p;
  p.name = p.waveform = "evologics_s2c";
  p.centre_khz = 26.0;
  p.bandwidth_khz = 16.0;
  p.source_level_db = 184.0;
  p.preamble_s = 0.1515;
  p.frame_s = 0.011;
  p.max_frames = 64;
  p.acquisition_db = -8.0;
  p.implementation_db = 3.0;
  p.spreading_db = SpreadingDb(p);
  p.errors.kind = ErrorCurve::Kind::kCoded;
  p.errors.frame_bits = 256.0;
  p.errors.half_db = 4.0 - p.spreading_db;
  p.turnaround_s = 0.02;
  p.transmit_w = 35.0;
  p.receive_w = 1.1;
  p.idle_w = 0.01;
  return std::make_unique<ModemProfile>(p);
}

}  // namespace

void Describe(ModemConfig* c, config::Table* t) {
  t->Section("modem");
  t->Add("profile", config::Name(&c->profile, ModemProfiles().Names()), config::kNone, "-",
         "modem of every node");
  t->Add("profiles", config::NamesRef{&c->profiles, ModemProfiles().Names()}, config::kNone, "-",
         "modem of each node of a mixed fleet; empty: every node has the modem of the key profile");
  t->Add("packet_bytes", &c->packet_bytes, config::Within(0.0, 2048.0), "bytes",
         "longest payload in the network, which must fit into a slot; 0: the longest payload of "
         "the modems");
  t->AddOptional("queue", config::Enum(&c->queue, {"newest", "fifo"}), "newest", config::kNone, "-",
                 "newest: a new packet replaces the waiting one; fifo: it waits behind the others");
  t->Add("queue_length", &c->queue_length, config::Within(1.0, 1000.0), "packets",
         "fifo: largest number of waiting packets; a modem refuses any more");
  t->Add("clock_offset_std_s", &c->clock_offset_std_s, config::NonNegative(1e3), "s",
         "standard deviation of a modem's clock at the start of an episode");
  t->Add("clock_drift_std_ppm", &c->clock_drift_std_ppm, config::NonNegative(1e3), "1e-6",
         "standard deviation of the rate of a modem's clock");
  t->AddOptional("timing_std_s", &c->timing_std_s, "0.0", config::NonNegative(10), "s",
                 "standard deviation of a travel time that a modem measures");
  t->AddOptional(
      "late_probability", &c->late_probability, "0.0", config::kFraction, "-",
      "probability that a modem measures the travel time of a later arrival, not of the first");
  t->AddOptional("late_max_s", &c->late_max_s, "0.1", config::NonNegative(10), "s",
                 "largest delay of such a later arrival after the first");
  t->Add("freshness_s", &c->freshness_s, config::Positive(1e5), "s",
         "decay time of link quality with the age of the information");
  t->AddOptional(
      "source_level_offset_db", &c->source_level_offset_db, "0.0", config::Within(-60.0, 60.0),
      "dB",
      "added to the source level of every profile; the energy of a transmission does not change");
  const std::string section = "channel.physical.modem.";
  ModemProfiles().Describe(
      "modem", section + "profile",
      [c] { return c->profiles.empty() ? std::vector<std::string>{c->profile} : c->profiles; },
      &c->kinds, t);
  t->Own(section + "profile",
         {"fleet", {"alike"}, section + "profiles", [c] {
            return std::vector<std::string>{c->profiles.empty() ? "alike" : "mixed"};
          }});
  t->Own(section + "queue_length",
         {"queue", {"fifo"}, section + "queue", [c] {
            return std::vector<std::string>{c->queue == QueuePolicy::kFifo ? "fifo" : "newest"};
          }});
  t->Own(section + "late_max_s",
         {"late arrivals", {"on"}, section + "late_probability", [c] {
            return std::vector<std::string>{c->late_probability > 0.0 ? "on" : "off"};
          }});
}

TimeNs ModemProfile::airtime(std::size_t bytes) const {
  return std::llround(airtime_s(bytes) * 1e9);
}
TimeNs ModemProfile::turnaround() const { return std::llround(turnaround_s * 1e9); }

ModemProfileRegistry& ModemProfiles() {
  // clang-format off
  static ModemProfileRegistry registry("modem", {
      {"ideal", Ideal},
      {"micromodem_fsk_r0", MicromodemFsk},
      {"micromodem_psk_r1", [] { return MicromodemPsk(1, 3, 64, 3.07); }},
      {"micromodem_psk_r2", [] { return MicromodemPsk(2, 3, 64, 3.07); }},
      {"micromodem_psk_r3", [] { return MicromodemPsk(3, 2, 256, 3.07); }},
      {"micromodem_psk_r4", [] { return MicromodemPsk(4, 2, 256, 3.15); }},
      {"micromodem_psk_r5", [] { return MicromodemPsk(5, 8, 256, 3.0); }},
      {"micromodem_psk_r6", [] { return MicromodemPsk(6, 6, 32, 2.95); }},
      {"micromodem_mini", MicromodemMini},
      {"janus", Janus},
      {"evologics_s2c", Evologics},
  });
  // clang-format on
  return registry;
}

std::vector<ModemProfile> MakeProfiles(const ModemConfig& config, int nodes) {
  const std::vector<std::string>& names = config.profiles;
  if (!names.empty() && names.size() != static_cast<std::size_t>(nodes)) {
    throw UserError("channel.physical.modem.profiles: " + std::to_string(names.size()) +
                    " modems for " + std::to_string(nodes) + " nodes");
  }
  std::vector<ModemProfile> fleet;
  for (int i = 0; i < nodes; ++i) {
    const std::string& name = names.empty() ? config.profile : names[static_cast<std::size_t>(i)];
    fleet.push_back(*ModemProfiles().Make(name, config.kinds));
    fleet.back().source_level_db += config.source_level_offset_db;
  }
  return fleet;
}

std::optional<config::Violation> FindConflict(const ModemConfig& c, int nodes) {
  const std::vector<std::string>& names = c.profiles;
  if (!names.empty() && names.size() != static_cast<std::size_t>(nodes)) {
    return config::Violation{
        {"channel.physical.modem.profiles", "agents"},
        std::to_string(names.size()) + " modems for " + std::to_string(nodes) + " nodes"};
  }
  for (const ModemProfile& p : MakeProfiles(c, nodes)) {
    if (static_cast<std::size_t>(c.packet_bytes) <= p.max_payload()) continue;
    return config::Violation{
        {"channel.physical.modem.packet_bytes",
         names.empty() ? "channel.physical.modem.profile" : "channel.physical.modem.profiles"},
        "a packet of " + p.name + " takes " + std::to_string(p.max_payload()) + " bytes at most"};
  }
  return {};
}

std::size_t LongestPayload(const ModemConfig& config, int nodes) {
  std::size_t least = kLargestFrame;
  for (const ModemProfile& p : MakeProfiles(config, nodes))
    least = std::min(least, p.max_payload());
  return config.packet_bytes > 0 ? static_cast<std::size_t>(config.packet_bytes) : least;
}

TimeNs LongestAirtime(const ModemConfig& config, int nodes) {
  const std::size_t bytes = LongestPayload(config, nodes);
  TimeNs longest = 0;
  for (const ModemProfile& p : MakeProfiles(config, nodes))
    longest = std::max(longest, p.airtime(bytes));
  return longest;
}

TimeNs LongestTurnaround(const ModemConfig& config, int nodes) {
  TimeNs longest = 0;
  for (const ModemProfile& p : MakeProfiles(config, nodes))
    longest = std::max(longest, p.turnaround());
  return longest;
}

}  // namespace stg::acoustics
