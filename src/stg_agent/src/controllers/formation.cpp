#include "stg_agent/controllers/formation.hpp"

#include <array>

namespace stg::agent {
namespace {

using config::kNone;
using config::NonNegative;

constexpr double kFullTurn = 2.0 * kPi;
/// Largest number of other AUVs. Of a larger team, the first ones in the input are used.
constexpr int kMost = 32;

}  // namespace

template <class T>
T Formation::Slot(const ControllerInput<T>& in, const Level<T>& v_T) const {
  const T zero(0.0), one(1.0);
  const Knowledge<T>& k = in.knowledge;
  const Vec3<T> p_WT = k.p_WB + k.r_BT_W;
  const bool course = options.slots == Slots::kCourse;
  // A target that rests has no course; the angle of a vector of length zero is not defined.
  const T east = Select(v_T.x == zero && v_T.y == zero, one, v_T.x);
  const T reference = course ? Atan2(v_T.y, east) : zero;
  const auto from_astern = [&](const T& bearing) {
    const T a = bearing - reference + T(kPi);
    return a - T(kFullTurn) * Floor(a * T(1.0 / kFullTurn));
  };
  // First the own bearing, then the bearings of the others in the ring.
  std::array<T, kMost + 1> bearing, present;
  bearing[0] = from_astern(Atan2(-k.r_BT_W.y, -k.r_BT_W.x));
  present[0] = one;
  int count = 1;
  for (int j = 0; j < in.neighbour_count && count <= kMost; ++j) {
    const Vec3<T> r = in.neighbours[j].p_WN - p_WT;
    const auto u = static_cast<std::size_t>(count++);
    bearing[u] = from_astern(Atan2(r.y, r.x));
    const T range = options.team_range_m * options.team_range_m;
    const auto near = (r.x * r.x + r.y * r.y < T(range)) && (in.neighbours[j].known > T(0.5));
    present[u] = Select(near, one, zero);
  }
  const auto n = static_cast<std::size_t>(count);
  T places = zero;
  for (std::size_t j = 0; j < n; ++j) places += present[j];
  const T step = T(kFullTurn) / places;
  T own_rank = zero, sines = zero, cosines = zero;
  for (std::size_t j = 0; j < n; ++j) {
    T rank = zero;
    for (std::size_t i = 0; i < n; ++i) {
      const auto before = (bearing[i] < bearing[j]) ||
                          ((bearing[i] == bearing[j]) && (i < j ? one > zero : one < zero));
      rank += Select(before, present[i], zero);
    }
    if (j == 0) own_rank = rank;
    T s, c;
    SinCos(bearing[j] - rank * step, &s, &c);
    sines += present[j] * s;
    cosines += present[j] * c;
  }
  const T first = course ? step * T(0.5) : Atan2(sines, cosines);
  return reference - T(kPi) + first + own_rank * step;
}

template <class T>
Level<T> Formation::Keep(const ControllerInput<T>& in, const Level<T>& v_T, const T& R,
                         const Guidance<T>& guidance) const {
  const Knowledge<T>& k = in.knowledge;
  const T one(1.0);
  const Level<T> own{k.v_WB.x, k.v_WB.y};
  const Level<T> r = Level<T>{k.r_BT_W.x, k.r_BT_W.y} +
                     (v_T - own) * T(options.lead_s + 0.5 * in.model.run.decision_dt_s());
  const T rho = Max(Norm(r), T(1e-3));
  const Level<T> outward = r * (-one / rho);
  const Level<T> around{-outward.y, outward.x};
  const T off = Slot(in, v_T) + guidance.phase_rad - Atan2(outward.y, outward.x);
  const T turn = off - T(kFullTurn) * Floor((off + T(kPi)) * T(1.0 / kFullTurn));
  const Level<T> way = outward * (R - rho) + around * (turn * Min(rho, R * T(1.5)));
  const T length = Max(Norm(way), T(1e-3));
  const Level<T> direction = way * (one / length);
  T u = length * T(options.gain_ps);
  u = Min(u, SpeedAlong(v_T, direction, T(options.fast_mps), u));
  return Limited(v_T + direction * u + around * guidance.speed_mps, options.slow_mps,
                 options.fast_mps);
}

template <class T>
void Formation::Act(const ControllerInput<T>& in, const Guidance<T>& guidance, T* action) const {
  const AgentModel& s = in.model;
  const Knowledge<T>& k = in.knowledge;
  const T zero(0.0), one(1.0);
  EncircleOptions circle;
  circle.clearance_m = options.clearance_m;
  circle.doubt_mps = options.doubt_mps;
  const Encircle ring{circle};
  const Level<T> v_T = TargetVelocity(in);
  const T z = ring.Height(in, guidance.depth_m);
  const T own_ring = ring.Radius(in, z - (k.p_WB.z + k.r_BT_W.z)) * T(options.radius);
  const T R = ring.Guided(in, own_ring, guidance.radius_m);
  Level<T> v = Keep(in, v_T, R, guidance);
  const Level<T> own{k.v_WB.x, k.v_WB.y};
  for (int j = 0; j < in.neighbour_count; ++j) {
    const NeighbourSight<T>& n = in.neighbours[j];
    const auto beside = Abs(n.p_WN.z - k.p_WB.z) < T(circle.layer_m);
    v = v + ring.Miss(own, {n.p_WN.x - k.p_WB.x, n.p_WN.y - k.p_WB.y}, {n.v_W.x, n.v_W.y},
                      T(options.clearance_m) + n.age_s * T(options.doubt_mps), ring.Dodge(s),
                      Select(beside, one, zero));
  }
  v = ring.ClearOfChart(in, Limited(v, options.slow_mps, options.fast_mps));
  const T climb =
      Clip((z - k.p_WB.z) * T(circle.depth_gain_ps), T(-circle.climb_mps), T(circle.climb_mps));
  const auto& vmax = s.vehicle.max_velocity_mps;
  const T velocity[3] = {Clip(v.x * T(1.0 / vmax[0]), T(-1.0), T(1.0)),
                         Clip(v.y * T(1.0 / vmax[1]), T(-1.0), T(1.0)),
                         Clip(climb * T(1.0 / vmax[2]), T(-1.0), T(1.0))};
  AskForVelocity(in, velocity, action);

  // If the target is slower than the vehicles can fly, no place can be kept, so they circle.
  const auto slow = Norm(v_T) < T(options.weave_below_mps);
  if (!Any(slow)) return;
  T circling[dynamics::kMaxActionSize] = {};
  Encircle{EncircleOptions{}}.Act(in, guidance, circling);
  for (int a = 0; a < s.control.action_size(); ++a)
    action[a] = Select(slow, circling[a], action[a]);
}

void Describe(FormationOptions* o, config::Table* t) {
  t->Add("slots", config::Enum(&o->slots, {"free", "course"}), kNone, "-",
         "bearings of the places in the ring. free: those nearest to the AUVs; course: symmetric "
         "to the target's course");
  t->Add("radius", &o->radius, config::Within(0.1, 10.0), "-",
         "radius of the ring, as a share of d*");
  t->Add("gain", &o->gain_ps, NonNegative(100), "1/s",
         "speed towards the AUV's place per distance from it");
  t->Add("slow", &o->slow_mps, NonNegative(100), "m/s", "smallest speed over ground");
  t->Add("fast", &o->fast_mps, NonNegative(100), "m/s", "largest speed over ground");
  t->Add("weave-below", &o->weave_below_mps, NonNegative(100), "m/s",
         "the AUVs circle a target that is slower than this");
  t->Add("team-range", &o->team_range_m, NonNegative(1e5), "m",
         "AUVs farther from the target than this have no place in the ring");
  t->Add("lead", &o->lead_s, NonNegative(1e3), "s",
         "the law uses the vehicle's position after this time");
  t->Add("clearance", &o->clearance_m, NonNegative(1e4), "m",
         "horizontal distance at which the AUV passes other AUVs");
  t->Add("doubt", &o->doubt_mps, NonNegative(100), "m/s",
         "added to `clearance` per second of age of the other AUV's last packet");
}

template void Formation::Act(const ControllerInput<double>& in, const Guidance<double>& guidance,
                             double* action) const;
template void Formation::Act(const ControllerInput<Pack>& in, const Guidance<Pack>& guidance,
                             Pack* action) const;

std::unique_ptr<Controller> MakeFormation(const FormationOptions& options) {
  return std::make_unique<ControllerOf<Formation>>(Formation{options});
}

std::unique_ptr<Controller> MakeContain(const ContainOptions& options) {
  return MakeFormation(options);
}

}  // namespace stg::agent
