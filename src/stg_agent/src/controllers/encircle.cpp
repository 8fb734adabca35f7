#include "stg_agent/controllers/encircle.hpp"

namespace stg::agent {
namespace {

using config::kFraction;
using config::NonNegative;

constexpr double kTwoPi = 2.0 * kPi;

/// Maps an angle within +-2 pi to [0, 2 pi).
template <class T>
T Positive(const T& angle) {
  return Select(angle < T(0.0), angle + T(kTwoPi), angle);
}

/// In a team on two circles, a change of the radius towards the near edge of the band has no effect
/// up to this [m]. An AUV that searches for a lost target flies a larger change.
constexpr double kNear_m = 60.0;

/// True if the AUV flies the larger of two circles.
template <class T>
bool Outer(const ControllerInput<T>& in) {
  return (in.id / in.model.target.count) % 2 != 0;
}

}  // namespace

bool Encircle::TwoCircles(const AgentModel& s) const {
  const int team = (s.run.agents + s.target.count - 1) / s.target.count;
  return team > options.ring_team;
}

double Encircle::Dodge(const AgentModel& s) const {
  return TwoCircles(s) ? options.ring_dodge : options.dodge;
}

template <class T>
T Encircle::Height(const ControllerInput<T>& in, const T& deeper_m) const {
  const T target = in.knowledge.p_WB.z + in.knowledge.r_BT_W.z;
  const AgentModel& s = in.model;
  if (!s.sea.open) return target;
  const config::Interval& band = s.sea.auv_depth_m;
  const double share = s.run.agents > 1 ? static_cast<double>(in.id) / (s.run.agents - 1) : 0.5;
  const T layer(-(band.lo + share * (band.hi - band.lo)));
  return Select(deeper_m == T(0.0), layer, Clip(layer - deeper_m, T(-band.hi), T(-band.lo)));
}

template <class T>
T Encircle::Radius(const ControllerInput<T>& in, const T& dz) const {
  const AgentModel& s = in.model;
  double d = s.task.desired_distance_m;
  if (TwoCircles(s)) d *= Outer(in) ? 1.0 + options.ring : 1.0 - options.ring;
  const double least = options.smallest_circle;
  return Sqrt(Max(T(d * d) - dz * dz, T(least * least * d * d)));
}

template <class T>
T Encircle::Guided(const ControllerInput<T>& in, const T& circle, const T& wider) const {
  const T least = T(0.25) * circle;
  if (!TwoCircles(in.model)) return Max(circle + wider, least);
  const T side(Outer(in) ? 1.0 : -1.0);
  const T crowded = Clip(side * wider, T(0.0), T(kNear_m));
  return Max(circle + wider - side * crowded, least);
}

template <class T>
Level<T> Encircle::Miss(const Level<T>& v, const Level<T>& r, const Level<T>& w, const T& clearance,
                        double dodge, const T& matters) const {
  const T zero(0.0), one(1.0);
  const Level<T> closing = w - v;
  const T time =
      Clip(-Dot(r, closing) / Max(Dot(closing, closing), T(1e-4)), zero, T(options.horizon_s));
  const Level<T> miss = r + closing * time;
  const T distance = Norm(miss);
  const T strength =
      matters * Max(one - distance / clearance, zero) * (one - time * T(1.0 / options.horizon_s));
  // Head-on there is no side on which to pass, so it turns to starboard.
  const T range = Max(Norm(r), T(1e-3));
  const Level<T> starboard{r.y / range, -r.x / range};
  const T side = Select(Dot(miss, starboard) > T(0.5), -one, one);
  const Level<T> away = r * (-distance / (range * clearance));
  const T speed = Norm(v);
  return (starboard * side + away) * (T(dodge) * strength * speed);
}

template <class T>
Level<T> Encircle::ClearOfChart(const ControllerInput<T>& in, Level<T> v) const {
  const AgentModel& s = in.model;
  const Knowledge<T>& k = in.knowledge;
  const EncircleOptions& o = options;
  const Level<T> own{k.v_WB.x, k.v_WB.y};
  const T turn_m = Norm(v) * T(1.0 / s.control.autopilot.max_turn_rate_radps + o.lead_s);
  const T keep_off = T(o.keep_off_m) + k.position_std_m * T(o.keep_off_doubt);
  const auto pass = [&](double x, double y, double lo, double hi, double radius_m) {
    const auto beside = (k.p_WB.z > T(lo - o.layer_m)) && (k.p_WB.z < T(hi + o.layer_m));
    const Level<T> there{T(x) - k.p_WB.x, T(y) - k.p_WB.y};
    const Level<T> off = TurnedOff(v, own, there, keep_off + T(radius_m), turn_m);
    v = {Select(beside, off.x, v.x), Select(beside, off.y, v.y)};
  };
  for (const auto& b : s.sea.spheres) pass(b[0], b[1], b[2] - b[3], b[2] + b[3], b[3]);
  for (const auto& b : s.sea.cylinders) pass(b[0], b[1], b[2], b[2] + b[4], b[3]);
  return v;
}

template <class T>
Vec3<T> Encircle::Velocity(const ControllerInput<T>& in, const Guidance<T>& guidance) const {
  const AgentModel& s = in.model;
  const EncircleOptions& o = options;
  const Knowledge<T>& k = in.knowledge;
  const T zero(0.0), one(1.0);
  const double most = s.vehicle.max_velocity_mps[0];
  const double slow = std::min(most, std::max(o.slow_mps + o.slow_in_current * s.max_current_mps,
                                              s.control.autopilot.min_speed_mps));
  const double fast = std::max(std::min(most, o.fast_mps), slow);
  const double cruise = std::clamp(o.cruise_mps, slow, fast);

  const Level<T> v_T = TargetVelocity(in);
  const Vec3<T> p_WT = k.p_WB + k.r_BT_W;
  const T z = Height(in, guidance.depth_m);
  const T own_circle = Radius(in, z - p_WT.z);
  const T R = Guided(in, own_circle, guidance.radius_m);

  // Future position of the vehicle, because commands take effect late and last for a decision.
  const Level<T> own{k.v_WB.x, k.v_WB.y};
  const Level<T> now{k.r_BT_W.x, k.r_BT_W.y};
  const Level<T> r = now + (v_T - own) * T(o.lead_s + 0.5 * s.run.decision_dt_s());
  const T rho = Max(Norm(r), T(1e-3));
  const Level<T> in_W = r * (one / rho);
  const Level<T> around{in_W.y * guidance.sense, -in_W.x * guidance.sense};
  const T radial = T(o.inward_gain) * (rho * rho - R * R), tangential = T(2.0) * rho * R;
  const T length = one / Max(Sqrt(radial * radial + tangential * tangential), T(1e-6));
  const Level<T> direction = in_W * (radial * length) + around * (tangential * length);

  // Gaps to the AUVs on this circle, and avoidance of all others.
  const double d = s.task.desired_distance_m;
  const T phase = Atan2(-now.y, -now.x), distance = Norm(now);
  const auto on_circle = Abs(distance - R) < T(o.on_circle * d);
  T ahead(kTwoPi), behind(kTwoPi);
  Level<T> aside;
  const bool rings = TwoCircles(s);
  const double dodge = Dodge(s);
  const T reach = rings ? T(o.ring * d) : T(o.mate_on_circle * d);
  for (int j = 0; j < in.neighbour_count; ++j) {
    const NeighbourSight<T>& n = in.neighbours[j];
    const Circler<T> c = CircleOn(n, p_WT, v_T, R, reach);
    const auto with_us = (c.on_circle > T(0.5)) && on_circle;
    const T gap = Positive(Atan2(c.q.y, c.q.x) - phase);
    ahead = Min(ahead, Select(with_us, gap, T(kTwoPi)));
    behind = Min(behind, Select(with_us, T(kTwoPi) - gap, T(kTwoPi)));
    const auto beside = Abs(c.z - k.p_WB.z) < T(o.layer_m);
    const T clearance =
        Select(with_us, T(o.mate_clearance_m), T(o.clearance_m) + n.age_s * T(o.doubt_mps));
    aside = aside + Miss(own, c.q + now, c.w, clearance, dodge, Select(beside, one, zero));
  }
  const T early = (ahead - behind) * T(0.5 * o.spread_gain) * guidance.sense;
  const T spread =
      Clip(early + guidance.phase_rad * T(o.spread_gain), T(-o.spread_limit), T(o.spread_limit));

  // Relative speed: the ground speed must be sufficient where the circle runs against the target's
  // course. On the way to the circle it is higher.
  const T hurry = Clip((rho - R) * T(1.0 / d) - T(o.hurry_from), zero, one);
  const T on_it = (T(cruise) + Norm(v_T)) * (one + spread);
  T u = on_it + (T(fast) - on_it) * hurry + guidance.speed_mps;
  u = Min(u, SpeedAlong(v_T, direction, T(fast), u));
  u = Max(u, SpeedAlong(v_T, direction, T(slow), u));
  const Level<T> wanted = Limited(v_T + direction * u, slow, fast);

  Level<T> v = Limited(wanted + aside, slow, fast);
  v = ClearOfChart(in, v);
  const T climb = Clip((z - k.p_WB.z) * T(o.depth_gain_ps), T(-o.climb_mps), T(o.climb_mps));
  return {v.x, v.y, climb};
}

template Vec3<double> Encircle::Velocity(const ControllerInput<double>& in,
                                         const Guidance<double>& guidance) const;
template Vec3<Pack> Encircle::Velocity(const ControllerInput<Pack>& in,
                                       const Guidance<Pack>& guidance) const;

template Level<double> Encircle::ClearOfChart(const ControllerInput<double>&, Level<double>) const;
template Level<Pack> Encircle::ClearOfChart(const ControllerInput<Pack>&, Level<Pack>) const;
template double Encircle::Height(const ControllerInput<double>&, const double&) const;
template Pack Encircle::Height(const ControllerInput<Pack>&, const Pack&) const;
template double Encircle::Radius(const ControllerInput<double>&, const double&) const;
template Pack Encircle::Radius(const ControllerInput<Pack>&, const Pack&) const;
template double Encircle::Guided(const ControllerInput<double>&, const double&,
                                 const double&) const;
template Pack Encircle::Guided(const ControllerInput<Pack>&, const Pack&, const Pack&) const;
template Level<double> Encircle::Miss(const Level<double>&, const Level<double>&,
                                      const Level<double>&, const double&, double,
                                      const double&) const;
template Level<Pack> Encircle::Miss(const Level<Pack>&, const Level<Pack>&, const Level<Pack>&,
                                    const Pack&, double, const Pack&) const;

void Describe(EncircleOptions* o, config::Table* t) {
  t->Add("cruise", &o->cruise_mps, NonNegative(100), "m/s",
         "speed over ground where the AUV circles against the target's course");
  t->Add("slow", &o->slow_mps, NonNegative(100), "m/s", "smallest speed over ground");
  t->Add(
      "slow-in-current", &o->slow_in_current, NonNegative(100), "-",
      "share of the largest current that is added to `slow`: where the water flows with the AUV, "
      "its speed over ground cannot be smaller than both together");
  t->Add("fast", &o->fast_mps, NonNegative(100), "m/s",
         "largest speed over ground, and the speed on the way to the circle");
  t->Add("inward", &o->inward_gain, NonNegative(1e3), "-",
         "how steeply the way to the circle points inward");
  t->Add("lead", &o->lead_s, NonNegative(1e3), "s",
         "the law uses the vehicle's position after this time");
  t->Add("spread", &o->spread_gain, NonNegative(1e3), "1/rad",
         "relative change of speed per angle off the middle between the AUVs ahead and behind");
  t->Add("spread-limit", &o->spread_limit, kFraction, "-",
         "largest relative change of speed by `spread`");
  t->Own("spread-limit", {"spread", {"above 0"}, "spread", [o] {
                            return std::vector<std::string>{o->spread_gain > 0.0 ? "above 0" : "0"};
                          }});
  t->Add("clearance", &o->clearance_m, config::Positive(1e4), "m",
         "horizontal distance at which the AUV passes other AUVs");
  t->Add("doubt", &o->doubt_mps, NonNegative(100), "m/s",
         "added to `clearance` per second of age of the other AUV's last packet");
  t->Add("mate-clearance", &o->mate_clearance_m, config::Positive(1e4), "m",
         "the same distance for AUVs on the same circle");
  t->Add("horizon", &o->horizon_s, config::Positive(1e4), "s",
         "closest approaches later than this are ignored");
  t->Add("layer", &o->layer_m, NonNegative(1e4), "m",
         "AUVs and obstacles farther above or below than this are ignored");
  t->Add("depth-gain", &o->depth_gain_ps, NonNegative(1e3), "1/s", "climb rate per error of depth");
  t->Add("climb", &o->climb_mps, NonNegative(100), "m/s", "largest commanded climb rate");
  t->Add("ring", &o->ring, config::Within(0.0, 0.9), "-",
         "large teams: two circles, smaller and larger than d* by this share");
  t->Add("ring-team", &o->ring_team, NonNegative(1e4), "AUVs",
         "teams of more AUVs than this are large");
  t->Add("smallest-circle", &o->smallest_circle, kFraction, "-",
         "smallest radius of the circle far above or below the target, as a share of d*");
  t->Add("dodge", &o->dodge, NonNegative(100), "-",
         "largest sideways speed to avoid an AUV, as a share of the AUV's own speed");
  t->Add("ring-dodge", &o->ring_dodge, NonNegative(100), "-", "the same share in large teams");
  t->Add("on-circle", &o->on_circle, NonNegative(10), "-",
         "the AUV is on the circle when it is closer to it than this share of d*");
  t->Add("mate-on-circle", &o->mate_on_circle, NonNegative(10), "-",
         "the same share for other AUVs, where there is one circle");
  t->Add("keep-off", &o->keep_off_m, NonNegative(1e4), "m",
         "horizontal distance that the AUV keeps from obstacles");
  t->Add("keep-off-doubt", &o->keep_off_doubt, NonNegative(10), "-",
         "added to `keep-off`: so many standard deviations of the AUV's own position");
  t->Add("hurry-from", &o->hurry_from, NonNegative(10), "-",
         "the AUV speeds up when it is farther outside the circle than this share of d*");
}

std::unique_ptr<Controller> MakeEncircle(const EncircleOptions& options) {
  return std::make_unique<ControllerOf<Encircle>>(Encircle{options});
}

}  // namespace stg::agent
