#include "stg_env/task/field_totals.hpp"

#include <algorithm>
#include <cmath>

#include "auv_dynamics/vehicle/shaft_power.hpp"

namespace stg::task {

template <class T>
T Spread(const SwarmState<T>& swarm, int target) {
  T east(0.0), north(0.0), count(0.0);
  const auto t = static_cast<std::size_t>(target);
  const Vec3<T>& p_WT = swarm.targets[t].p_WT;
  for (std::size_t i = 0; i < swarm.vehicles.size(); ++i) {
    if (swarm.following == nullptr && i % swarm.targets.size() != t) continue;
    const T follows = swarm.follows(i, t);
    const Vec3<T> r = swarm.vehicles[i].p_WB - p_WT;
    const T inverse = follows / Max(Sqrt(r.x * r.x + r.y * r.y), T(1e-6));
    east += r.x * inverse;
    north += r.y * inverse;
    count += follows;
  }
  const T spread = T(1.0) - Sqrt(east * east + north * north) * (T(1.0) / Max(count, T(1.0)));
  if (swarm.following == nullptr) return spread;
  return Select(count > T(0.5), spread, T(0.0));
}

template <class T>
T NormalisedSquare(const Vec3<T>& r, const T (&P)[6]) {
  // Uses the adjugate matrix.
  const T a = P[3] * P[5] - P[4] * P[4], b = P[2] * P[4] - P[1] * P[5],
          c = P[1] * P[4] - P[2] * P[3];
  const T d = P[0] * P[5] - P[2] * P[2], e = P[1] * P[2] - P[0] * P[4],
          f = P[0] * P[3] - P[1] * P[1];
  const T determinant = P[0] * a + P[1] * b + P[2] * c;
  const auto positive = (determinant > T(0.0)) && (P[0] > T(0.0)) && (f > T(0.0));
  const T square = r.x * (a * r.x + b * r.y + c * r.z) + r.y * (b * r.x + d * r.y + e * r.z) +
                   r.z * (c * r.x + e * r.y + f * r.z);
  return Select(positive, square / Select(positive, determinant, T(1.0)), T(0.0));
}

template <class T>
FieldTotals<T>::FieldTotals(const JudgeConfig& scenario)
    : scenario_(scenario),
      estimates_(scenario),
      search_(scenario),
      spell_(static_cast<std::size_t>(scenario.run.agents), T(0.0)),
      band_(spell_),
      there_(spell_),
      turns_propeller_(spell_.size()) {
  for (std::size_t i = 0; i < turns_propeller_.size(); ++i) {
    turns_propeller_[i] = dynamics::TurnsPropeller(scenario.world.vehicle, static_cast<int>(i));
  }
}

template <class T>
void FieldTotals<T>::Start(const Mask<T>& lanes) {
  const auto restart = [&](T* value, double first) { *value = Select(lanes, T(first), *value); };
  Sums& s = sums_;
  for (T* sum : {&s.present,
                 &s.square,
                 &s.nees,
                 &s.judged,
                 &s.known,
                 &s.age,
                 &s.band,
                 &s.lost,
                 &s.losses,
                 &s.recovered,
                 &s.recovered_steps,
                 &s.spread,
                 &s.near_pairs,
                 &s.groundings,
                 &s.collisions,
                 &s.received,
                 &s.missed,
                 &s.modem_energy,
                 &s.propulsion,
                 &s.airtime,
                 &s.pings,
                 &s.ping_answers}) {
    restart(sum, 0.0);
  }
  restart(&s.min_altitude, 1e9);
  restart(&s.min_clearance, 1e9);
  for (T& spell : spell_) restart(&spell, 0.0);
  for (T& band : band_) restart(&band, 0.0);
  for (T& there : there_) restart(&there, 0.0);
  estimates_.Start(lanes);
  search_.Start(lanes);
  navigation_.Start(lanes);
}

template <class T>
void FieldTotals<T>::Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
                         const Mask<T>& tail) {
  estimates_.Add(swarm, tracking, tail);
  search_.Add(swarm, tracking);
  navigation_.Add(swarm, tail);
  const T zero(0.0), one(1.0);
  const config::Interval& band = scenario_.reward.band_m;
  Sums& s = sums_;
  s.groundings = s.collisions = s.received = s.missed = s.modem_energy = s.airtime = s.pings =
      s.ping_answers = zero;  // these are counted elsewhere
  for (std::size_t i = 0; i < tracking.size(); ++i) {
    const FieldState<T>& f = (*swarm.field)[i];
    const Tracking<T>& k = tracking[i];
    const Vec3<T> error = f.p_WT - swarm.target_of(i).p_WT;
    const auto known = (f.known > T(0.5)) && (f.present > T(0.5));
    const T nees = NormalisedSquare(error, f.covariance);
    s.present += f.present;
    s.known += Select(known, one, zero);
    s.square += Select(known, Dot(error, error), zero);
    s.nees += Select(known, nees, zero);
    s.judged += Select(known && (nees > zero), one, zero);
    s.age += Select(known, f.age_s, zero);
    const auto inside =
        (k.distance <= T(band.hi)) && (k.distance >= T(band.lo)) && (f.present > T(0.5));
    there_[i] += f.present;
    s.band += Select(inside, one, zero);
    band_[i] += Select(inside, one, zero);
    s.lost += Select(f.present > T(0.5), k.lost, zero);
    const auto lost = (k.lost > T(0.5)) && (f.present > T(0.5));
    const auto before = spell_[i] > zero;
    s.losses += Select(lost, Select(before, zero, one), zero);
    s.recovered += Select(lost, zero, Select(before, one, zero));
    s.recovered_steps += Select(lost, zero, spell_[i]);
    spell_[i] = Select(lost, spell_[i] + one, zero);
    s.min_altitude = Min(s.min_altitude, f.altitude_m);
    s.min_clearance = Min(s.min_clearance, f.clearance_m);
    s.groundings += f.groundings;
    s.collisions += f.collisions;
    s.received += f.received;
    s.missed += f.missed;
    s.modem_energy += f.modem_energy_j;
    s.airtime += f.airtime_s;
    s.pings += f.pings;
    s.ping_answers += f.ping_answers;
    if (turns_propeller_[i]) {
      const dynamics::TorpedoConfig& torpedo = scenario_.world.vehicle.torpedo;
      const T rpm = swarm.tau[i][0] * T(torpedo.max_propeller_rpm);
      s.propulsion += dynamics::ShaftPower(torpedo, rpm, Norm(swarm.vehicles[i].v_WB));
    }
  }
  for (int k = 0; k < scenario_.world.target.count; ++k) {
    s.spread += Spread(swarm, k) * T(1.0 / scenario_.world.target.count);
  }
  const T near(scenario_.reward.separation_distance_m);
  for (int i = 0; i < scenario_.run.agents; ++i) {
    for (int j = i + 1; j < scenario_.run.agents; ++j) {
      s.near_pairs += Select(swarm.separations.distance(i, j) < near, one, zero);
    }
  }
}

template <class T>
FieldMetrics FieldTotals<T>::Metrics(int lane, double steps) const {
  const auto at = [lane](const T& value) { return Lane(value, lane); };
  const double dt_s = scenario_.run.decision_dt_s();
  const Sums& s = sums_;
  const double agents = static_cast<double>(scenario_.run.agents);
  const double all = std::max(1.0, at(s.present));
  FieldMetrics m;
  const double known = std::max(1.0, at(s.known));
  m.estimate_rmse = std::sqrt(at(s.square) / known);
  m.nees = at(s.nees) / std::max(1.0, at(s.judged));
  m.estimate_known = at(s.known) / all;
  m.information_age = at(s.age) / known;
  m.estimates = estimates_.Metrics(lane);
  m.search = search_.Metrics(lane, steps);
  m.navigation = navigation_.Metrics(lane);
  m.band_share = at(s.band) / all;
  m.worst_band_share = 1.0;
  for (std::size_t i = 0; i < band_.size(); ++i) {
    const double there = at(there_[i]);
    if (there > 0.0) m.worst_band_share = std::min(m.worst_band_share, at(band_[i]) / there);
  }
  m.time_lost = at(s.lost) * dt_s / agents;
  m.time_to_reacquire = at(s.recovered_steps) * dt_s / std::max(1.0, at(s.recovered));
  m.losses = at(s.losses) / agents;
  m.spread = at(s.spread) / steps;
  m.near_pairs = at(s.near_pairs) / steps;
  m.min_altitude = at(s.min_altitude);
  m.min_clearance = at(s.min_clearance);
  m.groundings = at(s.groundings);
  m.collisions = at(s.collisions);
  m.packets = at(s.received) / agents;
  m.packet_loss = at(s.missed) / std::max(1.0, at(s.received) + at(s.missed));
  m.modem_energy = at(s.modem_energy) / agents;
  m.propulsion_energy = at(s.propulsion) * dt_s / agents;
  const bool members = m.navigation && scenario_.agent.localization.by == agent::RangesBy::kPing;
  if ((scenario_.world.sensing.pings() || members) && at(s.pings) >= 0.0) {
    PingMetrics& p = m.pings.emplace();
    p.pings = at(s.pings) / agents;
    p.loss = 1.0 - at(s.ping_answers) / std::max(1.0, at(s.pings));
    p.airtime_share = at(s.airtime) / agents / (steps * dt_s);
  }
  return m;
}

template class FieldTotals<double>;
template class FieldTotals<Pack>;
template double Spread(const SwarmState<double>&, int);
template Pack Spread(const SwarmState<Pack>&, int);
template double NormalisedSquare(const Vec3<double>&, const double (&)[6]);
template Pack NormalisedSquare(const Vec3<Pack>&, const Pack (&)[6]);

}  // namespace stg::task
