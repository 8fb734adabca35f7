// Long because: everything that an AUV receives for its position meets here, from packets and pings
// to the filter.
#include <algorithm>
#include <cmath>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/water/sound_speed.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "fixes.hpp"
#include "localizers.hpp"
#include "member_models.hpp"
#include "ping_ranges.hpp"
#include "sent_ways.hpp"
#include "stg_agent/localization/joint_filter.hpp"
#include "stg_agent/localization/measured_ranges.hpp"
#include "stg_agent/localization/own_way.hpp"

namespace stg::agent {
namespace {

constexpr std::size_t kMostPending = 128;
constexpr std::size_t kMostTaken = 256;  ///< identities of readings that were used already
constexpr TimeNs kOldest = 60'000'000'000;
/// The own log has no bottom if the own deviation grows by more than this share of the current's.
/// This is only decided once the deviation has grown by the other factor, because the growth is
/// slow at first.
constexpr double kDriftShare = 0.5, kGrown = 1.3;
constexpr TimeNs kJudged = 10'000'000'000;

/// Identity of a reading: the packet, and the member that received it.
struct Taken {
  int receiver = -1, source = -1;
  TimeNs at = 0;
};

/// How long packets contain a fix: three packets in a row, if they leave within a minute.
TimeNs TellingOf(const AgentModel& s) {
  const TimeNs round = acoustics::RoundOf(s.channel, NetworkRun(s.run, s.stations));
  return round > 0 ? std::min(3 * round, kOldest) : kOldest / 3;
}

/// Joint filter of the own readings and the readings that others send.
class RangeLocalizer : public Localizer {
 public:
  RangeLocalizer(const AgentModel& s, int self)
      : auvs_(s.run.agents),
        self_(self),
        current_std_mps_(s.navigation.current_std_mps),
        tolerance_(s.run.decision_period() / 8),
        sound_(s.channel.physical.water),
        surface_z_m_(s.channel.physical.water.surface_z_m),
        chart_(ChartOf(s)),
        clocks_(ClocksOf(s)),
        filter_(s.localization, s.navigation.start_std_m, s.run.agents, AnchorsOf(s), self, clocks_,
                HeadingOf(s, self)),
        ways_(static_cast<std::size_t>(s.run.agents + s.stations.count())),
        measured_(s.run.agents, s.run.agents + s.stations.count()),
        own_way_(s.run),
        taken_(kMostTaken),
        pings_(s.pings_members()),
        by_ping_(self),
        bearing_std_rad_(s.stations.usbl_std_deg * kPi / 180.0),
        direction_std_rad_(s.measures_directions() ? s.localization.usbl_std_deg * kPi / 180.0
                                                   : 0.0),
        fixes_(s.run.agents, self, TellingOf(s), s.run.decision_period() / 4) {
    pending_.reserve(kMostPending);
  }

  void Reset() override {
    filter_.Clear();
    for (SentWay& way : ways_) way.Clear();
    measured_.Clear();
    std::fill(taken_.begin(), taken_.end(), Taken());
    pending_.clear();
    by_ping_.Clear();
    next_taken_ = 0;
    own_way_.Clear();
    fixes_.Clear();
    own_ = OwnReckoning();
    adrift_ = true;
    start_std_m_ = -1.0;
  }

  void Hear(const NeighbourState& packet, const acoustics::Reception& reception) override {
    const int id = packet.source;
    if (id == self_ || pending_.size() == kMostPending) return;
    const double travel_s = reception.travel_time_s;
    if (!pings_ && (clocks_.estimated ? travel_s == 0.0 : travel_s <= 0.0)) return;
    Letter letter;
    letter.id = id;
    letter.adrift = packet.adrift;
    letter.way = {packet.generation, reception.transmit, packet.p_W, packet.v_W};
    letter.travel_time_s = travel_s;
    letter.ranges = packet.ranges;
    letter.has_bearing = packet.has_bearing;
    letter.bearing = packet.bearing;
    letter.has_fix = packet.has_fix;
    letter.fix = packet.fix;
    letter.has_direction = HasDirection(reception);
    letter.azimuth_rad = reception.azimuth_rad;
    letter.elevation_rad = reception.elevation_rad;
    letter.arrival = reception.arrival;
    pending_.push_back(letter);
  }

  void HearAnswer(const acoustics::Reception& r) override {
    const int members = static_cast<int>(ways_.size());
    if (!pings_ || r.source < 0 || r.source >= members || r.source == self_) return;
    DirectionReading from;
    const bool known = HasDirection(r) && Face(r.arrival, r.azimuth_rad, r.elevation_rad, &from);
    by_ping_.AddOwn(r, known ? &from : nullptr);
  }

  void Advance(TimeNs now, const OwnReckoning& own) override {
    const bool goes_on = start_std_m_ >= 0.0;
    const Vec3<double> way = own.p_WB - own_.p_WB;
    FollowOwn(now, own);
    filter_.Predict(now);
    if (self_ < auvs_) {
      if (goes_on) filter_.Turn(self_, way);
      filter_.SetAdrift(self_, adrift_);
      filter_.SetDepth(self_, -own.p_WB.z);
      FixReading fix;
      if (fixes_.TakeOwn(now, own, own_way_, &fix)) filter_.Take(fix);
    }
    // Sorted by their content, so that the order of arrival has no effect.
    std::sort(pending_.begin(), pending_.end(), [](const Letter& a, const Letter& b) {
      return a.way.transmit != b.way.transmit ? a.way.transmit < b.way.transmit : a.id < b.id;
    });
    for (const Letter& letter : pending_) Read(now, letter);
    pending_.clear();
    by_ping_.Give(now - kOldest, own_way_, ways_, sound_, surface_z_m_,
                  [this, now](const RangeReading& z, const DirectionReading* from) {
                    if (z.receiver == self_) measured_.Add({z.source, z.at, z.range_m});
                    Take(now, z);
                    if (from != nullptr) Take(now, *from);
                  });
  }

  PlaneError own() const override { return filter_.Error(self_, filter_.now()); }
  PlaneError ahead(double ahead_s) const override { return filter_.Ahead(self_, ahead_s); }
  int fixes() const override { return fixes_.count(); }
  TimeNs fixed() const override { return fixes_.newest(self_); }
  PlaneError relative(int id, TimeNs at) const override {
    if (!filter_.knows(id)) {
      PlaneError e;
      e.xx = e.yy = filter_.Error(self_, filter_.now()).xx;
      return e;
    }
    return filter_.Relative(id, self_, at);
  }
  PlaneError current() const override { return filter_.Current(); }

  Vec3<double> NearTo(int id) const override {
    const SentWay& way = ways_[static_cast<std::size_t>(id)];
    if (!way.empty()) return way.newest().p;
    // A station may be so far away that the own position cannot resolve it: packets contain it
    // modulo a distance.
    if (id >= auvs_) return chart_[static_cast<std::size_t>(id - auvs_)];
    // No AUV is far from a place where it can be received, so this is the own position in the
    // other's frame.
    const PlaneError e = filter_.knows(id) ? relative(id, filter_.now()) : PlaneError();
    return {own_.p_WB.x + e.x, own_.p_WB.y + e.y, own_.p_WB.z};
  }

  void Tell(NeighbourState* packet) const override {
    packet->adrift = adrift_;
    packet->ranges.clear();
    if (fixes_.Tell(packet)) return;  // a fix uses the space of the ranges
    measured_.Tell(packet);
  }

 private:
  struct Letter {
    int id = 0;
    bool adrift = false;
    SentWay::Point way;
    double travel_time_s = 0.0;
    ShortList<SentRange, kSentRanges> ranges;
    bool has_bearing = false;
    SentBearing bearing;
    bool has_fix = false;
    SentFix fix;
    bool has_direction = false;
    double azimuth_rad = 0.0, elevation_rad = 0.0;
    TimeNs arrival = 0;
  };

  const SentWay& Way(int id) const { return ways_[static_cast<std::size_t>(id)]; }

  void FollowOwn(TimeNs now, const OwnReckoning& own) {
    if (start_std_m_ < 0.0) {
      start_std_m_ = own.position_std_m;
      stated_ = now;
    } else if (own.position_std_m != own_.position_std_m && now > stated_) {
      // The deviation changes with each ping of the log.
      const bool judged = own.position_std_m > kGrown * start_std_m_ || now > kJudged;
      const double growth = (own.position_std_m - own_.position_std_m) / Seconds(now - stated_);
      if (judged) adrift_ = growth > kDriftShare * current_std_mps_;
      stated_ = now;
    } else if (now - stated_ > kJudged) {
      adrift_ = false;
    }
    if (self_ >= auvs_) adrift_ = false;
    own_ = own;
    own_way_.Add(now, own);
  }

  void Read(TimeNs now, const Letter& letter) {
    filter_.Admit(letter.id, letter.way.generation);
    SentWay& way = ways_[static_cast<std::size_t>(letter.id)];
    const Vec3<double> before = way.empty() ? letter.way.p : way.newest().p;
    if (!way.Add(letter.way)) return;
    if (letter.id < auvs_) {
      filter_.Turn(letter.id, letter.way.p - before);
      filter_.SetAdrift(letter.id, letter.adrift);
      filter_.SetDepth(letter.id, -letter.way.p.z);
    }
    RangeReading z;
    z.receiver = self_;
    z.source = letter.id;
    if (!pings_ && way.AtPacket(letter.way.transmit, 0, &z.at, &z.p_source) &&
        own_way_.At(z.at, &z.p_receiver)) {
      z.sound_mps = SoundBetween(z);
      z.range_m = letter.travel_time_s * z.sound_mps;
      measured_.Add({letter.id, z.at, z.range_m});
      Take(now, z);
    }
    if (letter.has_direction) ReadDirection(now, letter);
    if (letter.has_bearing) ReadBearing(now, letter);
    FixReading fix;
    if (letter.has_fix && now - letter.fix.stamp <= kOldest && filter_.knows(letter.id) &&
        fixes_.TakeSent(letter.id, letter.fix, &fix)) {
      filter_.Take(fix);
    }
    for (const SentRange& sent : letter.ranges) {
      if (sent.source == letter.id) continue;
      z.receiver = letter.id;
      z.source = sent.source;
      z.range_m = sent.range_m;
      if (pings_) {
        z.at = sent.stamp;
        by_ping_.AddSent(z);
        continue;
      }
      const bool source_known = sent.source == self_
                                    ? OwnPacketAt(sent.stamp, &z.at, &z.p_source)
                                    : ways_[static_cast<std::size_t>(sent.source)].AtPacket(
                                          sent.stamp, tolerance_, &z.at, &z.p_source);
      if (!source_known || !way.Between(z.at, &z.p_receiver)) continue;
      z.sound_mps = SoundBetween(z);
      Take(now, z);
    }
  }

  /// Speed of sound with which the receiver computed the range from the travel time.
  double SoundBetween(const RangeReading& z) const {
    return 1.0 / SlownessBetween(sound_, surface_z_m_, z.p_receiver, z.p_source);
  }

  /// Uses the bearing at which a station received a packet.
  void ReadBearing(TimeNs now, const Letter& letter) {
    BearingReading z;
    z.receiver = letter.id;
    z.source = letter.bearing.source;
    z.azimuth_rad = letter.bearing.azimuth_rad;
    z.std_rad = bearing_std_rad_;
    const bool known = z.source == self_ ? OwnPacketAt(letter.bearing.stamp, &z.at, &z.p_source)
                                         : Way(z.source).AtPacket(letter.bearing.stamp, tolerance_,
                                                                  &z.at, &z.p_source);
    if (!known || !Way(z.receiver).Between(z.at, &z.p_receiver)) return;
    if (now - z.at > kOldest || !filter_.knows(z.source)) return;
    filter_.Take(z);
  }

  bool HasDirection(const acoustics::Reception& r) const {
    return direction_std_rad_ > 0.0 && self_ < auvs_ && r.has_direction &&
           std::isfinite(r.azimuth_rad + r.elevation_rad);
  }

  /// Turns a direction in body axes, from which the own modem received something, into the frame of
  /// the reckoning. False: the attitude at the arrival is not known.
  bool Face(TimeNs arrival, double azimuth_rad, double elevation_rad, DirectionReading* z) const {
    Mat3<double> R_WB;
    if (!own_way_.Attitude(arrival, &R_WB)) return false;
    const double c = std::cos(elevation_rad);
    const Vec3<double> line =
        R_WB *
        Vec3<double>{c * std::cos(azimuth_rad), c * std::sin(azimuth_rad), std::sin(elevation_rad)};
    z->azimuth_rad = std::atan2(line.y, line.x);
    z->elevation_rad = std::atan2(line.z, std::hypot(line.x, line.y));
    z->std_rad = direction_std_rad_;
    return true;
  }

  /// Uses the direction from which the own modem received a packet.
  void ReadDirection(TimeNs now, const Letter& letter) {
    DirectionReading z;
    z.source = letter.id;
    if (Way(letter.id).AtPacket(letter.way.transmit, 0, &z.at, &z.p_source) &&
        own_way_.At(z.at, &z.p_receiver) &&
        Face(letter.arrival, letter.azimuth_rad, letter.elevation_rad, &z)) {
      Take(now, z);
    }
  }

  /// The own packets are not received, but their times are known to within the age's resolution.
  bool OwnPacketAt(TimeNs stamp, TimeNs* at, Vec3<double>* p) const {
    *at = stamp;
    return own_way_.At(stamp, p);
  }

  void Take(TimeNs now, const RangeReading& z) {
    if (now - z.at > kOldest || !filter_.knows(z.receiver) || !filter_.knows(z.source)) return;
    for (const Taken& t : taken_) {
      const TimeNs off = t.at - z.at;
      if (t.receiver == z.receiver && t.source == z.source && off <= tolerance_ &&
          off >= -tolerance_) {
        return;
      }
    }
    taken_[next_taken_++ % taken_.size()] = {z.receiver, z.source, z.at};
    filter_.Take(z);
  }

  void Take(TimeNs now, const DirectionReading& z) {
    if (now - z.at <= kOldest && filter_.knows(z.source)) filter_.Take(z);
  }

  int auvs_, self_;
  double current_std_mps_;
  TimeNs tolerance_;
  acoustics::SoundSpeedProfile sound_;
  double surface_z_m_;
  std::vector<Vec3<double>> chart_;  // [stations]
  ClockModel clocks_;
  JointFilter filter_;
  std::vector<SentWay> ways_;  // by member
  MeasuredRanges measured_;
  std::vector<Letter> pending_;
  OwnWay own_way_;
  std::vector<Taken> taken_;  // used as a ring
  std::size_t next_taken_ = 0;
  bool pings_;  // ranges are measured by pings
  PingRanges by_ping_;
  double bearing_std_rad_;    // of those that stations measure
  double direction_std_rad_;  // of those that the own modem measures; 0: none
  Fixes fixes_;
  OwnReckoning own_;
  bool adrift_ = true;
  double start_std_m_ = -1.0;  // negative: no decision yet
  TimeNs stated_ = 0;          // time of the last change of the own deviation
};

}  // namespace

std::unique_ptr<Localizer> MakeRangeLocalizer(const AgentModel& model, const int& self) {
  return std::make_unique<RangeLocalizer>(model, self);
}

}  // namespace stg::agent
