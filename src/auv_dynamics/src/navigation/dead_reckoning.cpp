#include <algorithm>
#include <array>
#include <cmath>

#include "auv_dynamics/navigation/navigation_system.hpp"

namespace stg::dynamics {
namespace {

/// Symmetric 2x2 matrix, horizontal.
struct Spread {
  Pack xx = Pack(0.0), xy = Pack(0.0), yy = Pack(0.0);
};

/// State of one vehicle in all lanes.
struct Reckoning {
  Vec3<Pack> p_WB;      ///< estimate; the true height is used, because depth comes from pressure
  Vec3<Pack> before_W;  ///< true position one step ago
  Pack scale = Pack(0.0), heading = Pack(0.0);          ///< true errors [-], [rad]
  Pack sine = Pack(0.0), cosine = Pack(1.0);            ///< of `heading`
  Pack sine_half = Pack(0.0), cosine_half = Pack(1.0);  ///< of half of `heading`
  Vec3<Pack> noise_W;  ///< of the last ping: velocity x, y [m/s]; depth z [m]
  Vec3<Pack> water_W;  ///< current that the log does not measure [m/s]; zero over ground
  Pack through_water = Pack(0.0);  ///< 1: the last ping found no bottom
  Vec3<Pack> run_W;                ///< estimated way since the last ping [m]
  Spread spread;                   ///< variance of the position [m^2]
  /// Covariance of the position with scale and heading [m], [m rad].
  Vec3<Pack> with_scale, with_heading;
  Pack with_current = Pack(0.0);      ///< covariance of position and current, on each axis [m^2/s]
  Pack heading_variance = Pack(0.0);  ///< [rad^2]
  Pack position_std = Pack(0.0), heading_std = Pack(0.0);  ///< stated values
  // Only used if fixes are reported.
  /// Time of the next fix; kUnder: the vehicle is not at the surface.
  std::array<TimeNs, kLanes> due{};
  std::array<TimeNs, kLanes> fixed{};  ///< time of the newest fix
  Vec3<Pack> p_WF;                     ///< position of the newest fix
  Pack fix_std = Pack(0.0);            ///< stated value; 0: there was no fix
};

constexpr TimeNs kUnder = -1;

/// Integrates the velocity of a Doppler log along a heading. Depth comes from pressure. At the
/// surface there are fixes: they correct the position, or they are only reported. The true way of
/// each step, minus the current if the log has no bottom, is scaled, turned by the error of the
/// heading and disturbed by the noise of the ping. So without errors the position is true for any
/// step.
///
/// The stated standard deviation follows the linear error model e += s d + h J d + c t + noise, h
/// += walk; e, s, h and c are the errors of position, scale, heading and current, d is the way of a
/// ping, and J a quarter turn. The covariances are propagated with it. A fix enters with the same
/// gain on both axes; it does not correct scale and heading. The stated values and this gain use
/// the standard deviations that the vehicle assumes for its instruments.
class DeadReckoning : public NavigationSystem {
 public:
  explicit DeadReckoning(const NavigationSetup& setup)
      : config_(setup.navigation),
        stated_(setup.stated),
        dt_s_(setup.dt_s),
        steps_(static_cast<std::uint32_t>(
            std::max(1.0, std::round(setup.navigation.period_s / setup.dt_s)))),
        step_ns_(static_cast<TimeNs>(std::llround(setup.dt_s * 1e9))),
        ping_s_(steps_ * setup.dt_s),
        walk_std_(WalkOf(setup.navigation)),
        stated_walk_std_(WalkOf(setup.stated)),
        states_(static_cast<std::size_t>(setup.vehicles)) {}

  void Reset(int lane, int i, const EpisodeClock& clock,
             const VehicleState<Pack>& vehicle) override {
    Reckoning& r = At(i);
    Random random = clock.DrawAt(Stream::kNavigationStart, 0, static_cast<std::uint32_t>(i));
    const Vec3<double> p_WB = Lane(vehicle.p_WB, lane);
    const double x = random.Normal(), y = random.Normal();
    SetLane(&r.scale, lane, config_.dvl_scale_std * random.Normal());
    SetLane(&r.heading, lane, HeadingOf(config_) * random.Normal());
    SetLane(&r.p_WB, lane, p_WB + Vec3<double>{x, y, 0.0} * config_.start_std_m);
    SetLane(&r.before_W, lane, p_WB);
    SetLane(&r.run_W, lane, {});
    SetLane(&r.water_W, lane, {});
    SetLane(&r.through_water, lane, 0.0);
    const double variance = stated_.start_std_m * stated_.start_std_m;
    const double heading_std = HeadingOf(stated_);
    SetLane(&r.spread.xx, lane, variance);
    SetLane(&r.spread.xy, lane, 0.0);
    SetLane(&r.spread.yy, lane, variance);
    SetLane(&r.with_scale, lane, {});
    SetLane(&r.with_heading, lane, {});
    SetLane(&r.with_current, lane, 0.0);
    SetLane(&r.heading_variance, lane, heading_std * heading_std);
    r.due[static_cast<std::size_t>(lane)] = kUnder;
    SetLane(&r.p_WF, lane, {});
    SetLane(&r.fix_std, lane, 0.0);
    Ping(lane, i, clock, 0.0);
    FollowHeading(&r);
    State(&r);
  }

  void Step(int i, const EpisodeClocks& clocks, const VehicleState<Pack>& vehicle,
            const Vec3<Pack>& v_WC, const Terrain& terrain) override {
    Reckoning& r = At(i);
    const Pack dt(dt_s_), one(1.0);
    r.water_W = v_WC * r.through_water;
    const Vec3<Pack> way = (vehicle.p_WB - r.before_W - r.water_W * dt) * (one + r.scale);
    r.before_W = vehicle.p_WB;
    const Vec3<Pack> run{r.cosine * way.x - r.sine * way.y + r.noise_W.x * dt,
                         r.sine * way.x + r.cosine * way.y + r.noise_W.y * dt, Pack(0.0)};
    r.p_WB.x += run.x;
    r.p_WB.y += run.y;
    r.run_W += run;
    Pack due(0.0);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (clocks[static_cast<std::size_t>(lane)].step % steps_ == 0) SetLane(&due, lane, 1.0);
    }
    const Mask<Pack> pings = due > Pack(0.5);
    if (!Any(pings)) return;
    Spend(pings, &r);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (Lane(due, lane) == 0.0) continue;
      const Vec3<double> p_WB = Lane(vehicle.p_WB, lane);
      const EpisodeClock& clock = clocks[static_cast<std::size_t>(lane)];
      Random random = Ping(lane, i, clock, walk_std_);
      const bool lost_bottom = terrain.Altitude(p_WB) > config_.dvl_altitude_m;
      SetLane(&r.through_water, lane, lost_bottom ? 1.0 : 0.0);
      const bool surfaced = -p_WB.z < config_.gps_depth_m;
      if (config_.fixes == FixUse::kReported) {
        LookForFix(lane, surfaced, clock.step * step_ns_, p_WB, &random, &r);
      } else if (surfaced) {
        Fix(lane, p_WB, &random, &r);
      }
    }
    r.water_W = v_WC * r.through_water;
    FollowHeading(&r);
    State(&r);
  }

  void Believe(int i, Navigation<Pack>* nav) const override {
    const Reckoning& r = states_[static_cast<std::size_t>(i)];
    const Pack one(1.0);
    // The velocity first, because the log measures in body axes and the true attitude is needed.
    const Mat3<Pack> R_WB = RotationOf(nav->q_WB);
    const Vec3<Pack> v_W = R_WB * nav->v_WB_B - r.water_W;
    const Vec3<Pack> noise{r.cosine * r.noise_W.x + r.sine * r.noise_W.y,
                           r.cosine * r.noise_W.y - r.sine * r.noise_W.x, Pack(0.0)};
    const Vec3<Pack> said{v_W.x * (one + r.scale) + noise.x, v_W.y * (one + r.scale) + noise.y,
                          v_W.z};
    nav->v_WB_B = R_WB.TransposeTimes(said);
    nav->p_WB = {r.p_WB.x, r.p_WB.y, nav->p_WB.z + r.noise_W.z};
    Pack(&q)[4] = nav->q_WB;
    const Pack w = r.cosine_half * q[0] - r.sine_half * q[3];
    const Pack x = r.cosine_half * q[1] - r.sine_half * q[2];
    const Pack y = r.cosine_half * q[2] + r.sine_half * q[1];
    const Pack z = r.cosine_half * q[3] + r.sine_half * q[0];
    q[0] = w;
    q[1] = x;
    q[2] = y;
    q[3] = z;
    nav->position_std_m = r.position_std;
    nav->heading_std_rad = r.heading_std;
    nav->fix_stamp = r.fixed;
    nav->p_WF = r.p_WF;
    nav->fix_std_m = r.fix_std;
  }

  Observer At(int lane, int i) const override {
    const Reckoning& r = states_[static_cast<std::size_t>(i)];
    Observer o;
    o.p_WO = {Lane(r.p_WB.x, lane), Lane(r.p_WB.y, lane),
              Lane(r.before_W.z, lane) + Lane(r.noise_W.z, lane)};
    o.position_std_m = Lane(r.position_std, lane);
    o.heading_error_rad = Lane(r.heading, lane);
    o.heading_std_rad = Lane(r.heading_std, lane);
    return o;
  }

 private:
  static double HeadingOf(const NavigationConfig& c) { return c.heading_std_deg * kPi / 180.0; }
  /// Standard deviation of the heading's walk between two pings [rad].
  double WalkOf(const NavigationConfig& c) const {
    return c.gyro_walk_deg_per_sqrt_h * kPi / 180.0 * std::sqrt(ping_s_ / 3600.0);
  }

  Reckoning& At(int i) { return states_[static_cast<std::size_t>(i)]; }

  /// Draws the noise of one ping. The noise of a fix comes next from the returned generator.
  Random Ping(int lane, int i, const EpisodeClock& clock, double walk_std) {
    Reckoning& r = At(i);
    Random random =
        clock.DrawAt(Stream::kNavigation, clock.step / steps_, static_cast<std::uint32_t>(i));
    const double x = random.Normal(), y = random.Normal(), z = random.Normal();
    SetLane(&r.noise_W, lane,
            {config_.dvl_noise_mps * x, config_.dvl_noise_mps * y, config_.depth_std_m * z});
    SetLane(&r.heading, lane, Lane(r.heading, lane) + walk_std * random.Normal());
    return random;
  }

  static void FollowHeading(Reckoning* r) {
    SinCos(r->heading, &r->sine, &r->cosine);
    SinCos(r->heading * Pack(0.5), &r->sine_half, &r->cosine_half);
  }

  /// Propagates the covariances over one ping, in the lanes of the mask.
  void Spend(const Mask<Pack>& lanes, Reckoning* r) const {
    const Pack zero(0.0), two(2.0), t(ping_s_), noise(stated_.dvl_noise_mps * ping_s_);
    const Pack ss(stated_.dvl_scale_std * stated_.dvl_scale_std);
    const Pack current(stated_.current_std_mps * stated_.current_std_mps);
    const Pack &hh = r->heading_variance, water = r->through_water;
    const Pack dx = r->run_W.x, dy = r->run_W.y;
    const Vec3<Pack>&s = r->with_scale, &h = r->with_heading;
    const Pack c = r->with_current;
    // e' = e + s (dx, dy) + h (-dy, dx) + c t
    const Pack own = noise * noise + water * t * (two * c + current * t);
    const Pack xx = two * (s.x * dx - h.x * dy) + ss * dx * dx + hh * dy * dy + own;
    const Pack yy = two * (s.y * dy + h.y * dx) + ss * dy * dy + hh * dx * dx + own;
    const Pack xy = s.x * dy + s.y * dx + h.x * dx - h.y * dy + (ss - hh) * dx * dy;
    r->spread.xx += Select(lanes, xx, zero);
    r->spread.xy += Select(lanes, xy, zero);
    r->spread.yy += Select(lanes, yy, zero);
    r->with_scale += Vec3<Pack>{Select(lanes, ss * dx, zero), Select(lanes, ss * dy, zero), zero};
    r->with_heading +=
        Vec3<Pack>{Select(lanes, -hh * dy, zero), Select(lanes, hh * dx, zero), zero};
    r->with_current += Select(lanes, water * current * t, zero);
    r->heading_variance += Select(lanes, Pack(stated_walk_std_ * stated_walk_std_), zero);
    r->run_W = Select<Pack>(lanes, Vec3<Pack>(), r->run_W);
  }

  /// Reports a fix once the receiver has been at the surface for long enough. The error of GPS is
  /// nearly constant for some time, so the next fix comes when this error has changed.
  void LookForFix(int lane, bool surfaced, TimeNs now, const Vec3<double>& p_WB, Random* random,
                  Reckoning* r) const {
    TimeNs& due = r->due[static_cast<std::size_t>(lane)];
    if (!surfaced) {
      due = kUnder;
      return;
    }
    if (due == kUnder) due = now + Nanoseconds(config_.gps_first_fix_s);
    if (now < due) return;
    due = now + Nanoseconds(config_.gps_period_s);
    r->fixed[static_cast<std::size_t>(lane)] = now;
    const double x = random->Normal(), y = random->Normal();
    SetLane(&r->p_WF, lane, p_WB + Vec3<double>{x, y, 0.0} * config_.gps_std_m);
    SetLane(&r->fix_std, lane, stated_.gps_std_m);
  }
  static TimeNs Nanoseconds(double seconds) {
    return static_cast<TimeNs>(std::llround(seconds * 1e9));
  }

  /// Corrects the position of one lane by a fix.
  void Fix(int lane, const Vec3<double>& p_WB, Random* random, Reckoning* r) const {
    const double noise = stated_.gps_std_m * stated_.gps_std_m;
    const double variance = Largest(r->spread, lane);
    const double gain = variance / (variance + noise), kept = 1.0 - gain;
    const double x = p_WB.x + config_.gps_std_m * random->Normal();
    const double y = p_WB.y + config_.gps_std_m * random->Normal();
    SetLane(&r->p_WB.x, lane, Lane(r->p_WB.x, lane) * kept + x * gain);
    SetLane(&r->p_WB.y, lane, Lane(r->p_WB.y, lane) * kept + y * gain);
    const double added = gain * gain * noise, share = kept * kept;
    SetLane(&r->spread.xx, lane, Lane(r->spread.xx, lane) * share + added);
    SetLane(&r->spread.xy, lane, Lane(r->spread.xy, lane) * share);
    SetLane(&r->spread.yy, lane, Lane(r->spread.yy, lane) * share + added);
    SetLane(&r->with_scale, lane, Lane(r->with_scale, lane) * kept);
    SetLane(&r->with_heading, lane, Lane(r->with_heading, lane) * kept);
    SetLane(&r->with_current, lane, Lane(r->with_current, lane) * kept);
  }

  template <class T>
  static T LargestOf(const T& xx, const T& xy, const T& yy) {
    const T half = (xx - yy) * T(0.5);
    return (xx + yy) * T(0.5) + Sqrt(half * half + xy * xy);
  }
  static double Largest(const Spread& s, int lane) {
    return LargestOf(Lane(s.xx, lane), Lane(s.xy, lane), Lane(s.yy, lane));
  }

  static void State(Reckoning* r) {
    r->position_std = Sqrt(LargestOf(r->spread.xx, r->spread.xy, r->spread.yy));
    r->heading_std = Sqrt(r->heading_variance);
  }

  NavigationConfig config_, stated_;
  double dt_s_;
  std::uint32_t steps_;  // physics steps between two pings
  TimeNs step_ns_;
  double ping_s_, walk_std_, stated_walk_std_;
  std::vector<Reckoning> states_;  // [vehicles]
};

std::unique_ptr<NavigationSystem> MakeDeadReckoning(const NavigationSetup& setup) {
  return std::make_unique<DeadReckoning>(setup);
}

}  // namespace

NavigationRegistry::Entry DeadReckoningEntry() { return {"dead_reckoning", MakeDeadReckoning}; }

}  // namespace stg::dynamics
