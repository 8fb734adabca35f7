#include "stg_agent/stations/station.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::agent {
namespace {

/// Time constant with which a craft's velocity follows the wanted one.
constexpr double kCraftLag_s = 2.0;
constexpr double kDraught_m = 2.0;  ///< depth of its modem below the surface
/// After this time without a packet, an AUV does not count for the middle.
constexpr TimeNs kSilent = 120'000'000'000;

Vec3<double> HomeOf(const StationsConfig& s, int station) {
  if (!s.is_craft(station)) {
    const auto& row = s.beacons[static_cast<std::size_t>(station)];
    return {row[0], row[1], row[2]};
  }
  const auto& row = s.crafts[static_cast<std::size_t>(station) - s.beacons.size()];
  return {row[0], row[1], -kDraught_m};
}

}  // namespace

Station::Station(SharedConstants constants, int station)
    : constants_(std::move(constants)),
      member_(constants_->model.run.agents + station),
      craft_(constants_->model.stations.is_craft(station)),
      home_W_(HomeOf(constants_->model.stations, station)),
      sound_(constants_->model.channel.physical.water),
      heard_(static_cast<std::size_t>(constants_->model.run.agents)) {
  const AgentModel& model = constants_->model;
  if (craft_) {
    localizer_ = MakeLocalizer(model, member_);
  } else if (model.locates() && !model.pings_members()) {
    ranges_ = std::make_unique<MeasuredRanges>(model.run.agents, model.members());
  }
  Reset(0, 0);
}

void Station::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  now_ = 0;
  p_W_ = home_W_;
  v_W_ = {};
  std::fill(heard_.begin(), heard_.end(), Heard());
  if (localizer_ != nullptr) localizer_->Reset();
  if (ranges_ != nullptr) ranges_->Clear();
  Err(0, true);
}

/// Draws the error of a position: for a craft the error of the satellite position, anew at each
/// decision; for a beacon the error of the survey, once.
void Station::Err(std::uint32_t step, bool start) {
  if (!start && !craft_) return;
  const AgentModel& s = constants_->model;
  Random random(seed_, Stream::kStation, episode_, step, static_cast<std::uint32_t>(member_));
  const double x = random.Normal(), y = random.Normal();
  if (start) {
    const double std_m = craft_ ? s.stations.gps_std_m : s.stations.survey_std_m;
    error_W_ = Vec3<double>{x, y, 0.0} * std_m;
    // A beacon reports its charted position; its true position differs by the error.
    if (!craft_) p_W_ = home_W_ - error_W_;
    return;
  }
  const double kept = std::exp(-s.run.decision_dt_s() / s.stations.gps_memory_s);
  error_W_ = error_W_ * kept +
             Vec3<double>{x, y, 0.0} * (s.stations.gps_std_m * std::sqrt(1.0 - kept * kept));
}

void Station::Receive(const acoustics::Reception& reception, const Vec3<double>& r_W) {
  const bool bearings = constants_->model.stations.usbl_std_deg > 0.0;
  if (localizer_ == nullptr && ranges_ == nullptr && !bearings) return;
  const acoustics::ByteView& bytes = reception.payload;
  const int source = PacketCodec::SourceOf(bytes.data, bytes.size);
  if (source < 0 || source >= constants_->model.members()) return;
  try {
    const Vec3<double> near = localizer_ != nullptr ? localizer_->NearTo(source) : stated_W();
    const NeighbourState state =
        constants_->codec.Decode(bytes.data, bytes.size, reception.arrival, near);
    if (localizer_ != nullptr) localizer_->Hear(state, reception);
    if (ranges_ != nullptr) MeasureRange(state, reception);
    if (source >= constants_->model.run.agents) return;
    Heard& heard = heard_[static_cast<std::size_t>(source)];
    if (state.generation <= heard.stamp) return;
    heard.stamp = state.generation;
    heard.p_W = state.p_W;
    heard.v_W = state.v_W;
    if (!bearings) return;
    Random random(seed_, Stream::kBearing, episode_, reception.sequence,
                  static_cast<std::uint32_t>(source * constants_->model.members() + member_));
    const double std_rad = constants_->model.stations.usbl_std_deg * kPi / 180.0;
    heard.bearing = {source, reception.transmit,
                     WrapAngle(std::atan2(r_W.y, r_W.x) + std_rad * random.Normal())};
  } catch (const UserError&) {
    // A packet may be damaged on its way.
  }
}

void Station::MeasureRange(const NeighbourState& state, const acoustics::Reception& reception) {
  // The slowness depends on depths only, which a packet contains whole.
  const double slowness = SlownessBetween(
      sound_, constants_->model.channel.physical.water.surface_z_m, stated_W(), state.p_W);
  ranges_->Add({state.source, reception.transmit, reception.travel_time_s / slowness});
}

void Station::Advance(TimeNs now, std::uint32_t step) {
  const double dt_s = Seconds(now - now_);
  if (craft_ && dt_s > 0.0) {
    p_W_ += v_W_ * dt_s;
    Err(step, false);
  }
  now_ = now;
  if (localizer_ == nullptr) return;
  localizer_->Advance(now, {stated_W(), constants_->model.stations.gps_std_m});
  if (craft_ && dt_s > 0.0) v_W_ += (Wanted(now) - v_W_) * (1.0 - std::exp(-dt_s / kCraftLag_s));
}

Vec3<double> Station::Wanted(TimeNs now) const {
  Vec3<double> middle;
  int count = 0;
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    const Heard& h = heard_[i];
    if (h.stamp < 0 || now - h.stamp > kSilent) continue;
    // From the AUV's frame to the own one, which differs from the world only by the error of the
    // satellites.
    const PlaneError e = localizer_->relative(static_cast<int>(i), now);
    const Vec3<double> p = h.p_W + h.v_W * Seconds(now - h.stamp);
    middle += Vec3<double>{p.x - e.x, p.y - e.y, 0.0};
    ++count;
  }
  const Vec3<double> centre = count > 0 ? middle * (1.0 / count) : home_W_;
  const StationsConfig& s = constants_->model.stations;
  const Vec3<double> out{stated_W().x - centre.x, stated_W().y - centre.y, 0.0};
  const double rho = std::max(Norm(out), 1e-3), R = s.craft_circle_m;
  // The velocity field of a limit cycle leads onto the circle and around it.
  const double radial = (R * R - rho * rho) / rho, around = 2.0 * R;
  const Vec3<double> way{radial * out.x - around * out.y, radial * out.y + around * out.x, 0.0};
  return way * (s.craft_speed_mps / std::max(Norm(way), 1e-6));
}

void Station::TellBearing(NeighbourState* state) {
  constexpr TimeNs kNew = 30'000'000'000;
  Heard* next = nullptr;
  for (Heard& h : heard_) {
    if (h.stamp < 0 || h.bearing.stamp <= h.sent || now_ - h.bearing.stamp > kNew) continue;
    if (next == nullptr || h.sent < next->sent) next = &h;
  }
  if (next == nullptr) return;
  state->has_bearing = true;
  state->bearing = next->bearing;
  next->sent = now_;
}

Packet Station::MakePacket() {
  NeighbourState state;
  state.source = member_;
  state.generation = now_;
  state.p_W = stated_W();
  state.v_W = v_W_;
  const StationsConfig& s = constants_->model.stations;
  state.position_std_m = craft_ ? s.gps_std_m : s.survey_std_m;
  if (localizer_ != nullptr) localizer_->Tell(&state);
  if (ranges_ != nullptr) ranges_->Tell(&state);
  if (s.usbl_std_deg > 0.0) TellBearing(&state);
  return constants_->codec.Encode(state);
}

}  // namespace stg::agent
