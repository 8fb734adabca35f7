#include "stg_agent/entities/entities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "acoustic_channel/access/medium_access.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "rows/obstacle_rows.hpp"
#include "stg_agent/graph/features.hpp"

namespace stg::agent {
namespace {

constexpr double kCourseFrom = 0.3, kGeometryAge = 60.0;
constexpr double kDrift = 0.3;  // growth of a neighbour's deviation [m/s, in the field]

/// Between walls, AUVs fly in any direction, so x is along the heading.
Frame FrameOf(const Knowledge<double>& k, const EntityScales& u) {
  const double speed = std::hypot(k.v_WB.x, k.v_WB.y);
  if (!u.walls && speed >= kCourseFrom) return {k.v_WB.x / speed, k.v_WB.y / speed};
  return {k.trig.cos_psi, k.trig.sin_psi};
}

double ClosestApproach(const Vec3<double>& r, const Vec3<double>& w, const EntityScales& u,
                       double* miss) {
  const double square = w.x * w.x + w.y * w.y + w.z * w.z;
  const double t = square < 1e-8 * u.speed * u.speed
                       ? 0.0
                       : std::clamp(-Dot(r, w) / square, 0.0, 300.0 * u.time);
  *miss = Norm(r + w * t);
  return t;
}

/// One target, as input of its row: the followed target or another one.
struct Subject {
  int target;
  const Knowledge<double>& knowledge;  ///< of this target
  const TargetBelief& belief;
  double velocity_std_mps, information_age_s;
  bool followed;
};

/// Age of the newest own measurement of a target in a packet. Returns false if there is none.
bool Sighted(const EntityInput& in, const Subject& t, const NeighbourState& report, double* age_s) {
  const bool free = in.model.task.free();
  if (!free && report.target != t.target) return false;
  for (const dynamics::Detection& d : report.sightings) {
    if (free && d.target != t.target) continue;
    *age_s = std::max(0.0, Seconds(in.memory.now - d.stamp));
    return true;
  }
  return false;
}

void PutSelf(const EntityInput& in, const EntityScales& u, const Frame& K, float* out) {
  const Knowledge<double>& k = in.knowledge;
  const AgentModel& m = in.model;
  const double now = Seconds(in.memory.now);
  Row row(out);
  row.Put(u.Speed(k.v_WB_B.x)).Put(u.Speed(std::hypot(k.v_WB.x, k.v_WB.y)));
  row.Put(K.s * k.trig.cos_psi - K.c * k.trig.sin_psi);  // sin(course - heading)
  row.Put(K.c * k.trig.cos_psi + K.s * k.trig.sin_psi);
  row.Put(k.w_WB_B.z * u.time / 0.0873).Put(k.v_WB.z / (0.5 * u.speed));
  const config::Interval& depth = m.sea.auv_depth_m;
  if (u.walls) {
    row.Put(0.0).Put(0.0);  // there is neither a range of depths nor a bottom
  } else {
    row.Put((-k.p_WB.z - depth.lo) / std::max(depth.hi - depth.lo, 1.0));
    row.Put(std::clamp((m.sea.bottom_m + k.p_WB.z - 10.0) / 20.0, -1.0, 1.0));
  }
  row.Put(u.Deviation(in.memory.position_std_m));
  for (const float c : in.memory.command) row.Put(static_cast<double>(c));
  double graph[kGraphNumbers];
  GraphSummary(m.observation, k, &graph);
  for (const double g : graph) row.Put(g);
  row.Put(std::log(1.0 + in.neighbour_count) / 3.0);
  const int targets = std::min((in.belief.started ? 1 : 0) + in.other_count, kTargetRows);
  row.Put(std::log(1.0 + targets) / 2.0);
  // As if the AUVs took the slots in turn. Without slots, e.g. with `csma`, the numbers are 0.
  const double slot = acoustics::SlotOfKeys(m.channel), frame = slot * m.run.agents;
  const bool turns = frame > 0.0;
  const double since = turns ? std::fmod(now - slot * in.id + frame * 4096.0, frame) : 0.0;
  row.Put(turns ? u.Age(since) : 0.0F).Put(turns ? 1.0 - since / frame : 0.0);
  int silent = 0;
  for (int j = 0; j < in.neighbour_count; ++j) {
    if (turns && in.neighbours[j].sight.age_s > 3.0 * frame) ++silent;
  }
  row.Put(in.neighbour_count > 0 ? static_cast<double>(silent) / in.neighbour_count : 0.0);
  row.Put(0.0);
}

/// |mean e^{i theta}| and |mean e^{2 i theta}| of the bearings from the target to AUVs that
/// measured it in the last minute. Both are 1, as for one observer, if there was no measurement.
void Geometry(const EntityInput& in, const EntityScales& u, const Subject& t, double* once,
              double* twice) {
  const Vec3<double>& r = t.knowledge.r_BT_W;
  std::complex<double> first, second;
  int count = 0;
  const auto add = [&](double x, double y) {
    const double d = std::hypot(x, y);
    if (d < 1e-6 * u.length) return;
    const std::complex<double> e(x / d, y / d);
    first += e;
    second += e * e;
    ++count;
  };
  const TimeNs own = in.memory.own_detection[static_cast<std::size_t>(t.target)];
  if (own >= 0 && Seconds(in.memory.now - own) <= kGeometryAge * u.time) {
    add(-r.x, -r.y);
  }
  for (int j = 0; j < in.neighbour_count; ++j) {
    double age = 0.0;
    if (!Sighted(in, t, *in.neighbours[j].report, &age) || age > kGeometryAge * u.time) continue;
    const Vec3<double>& n = in.neighbours[j].sight.r_BN_W;
    add(n.x - r.x, n.y - r.y);
  }
  *once = count > 0 ? std::abs(first) / count : 1.0;
  *twice = count > 0 ? std::abs(second) / count : 1.0;
}

void PutTarget(const EntityInput& in, const EntityScales& u, const Subject& t, const Frame& K,
               float* out) {
  const Knowledge<double>& k = t.knowledge;
  const ObservationConfig& c = in.model.observation;
  const double desired = in.model.task.desired_distance_m;
  const Vec3<double>& r = k.r_BT_W;
  const double level = std::max(std::hypot(r.x, r.y), 1e-6);
  Row row(out);
  PutBearing(K, r, &row);
  row.Put(u.Far(k.distance));
  row.Put(u.Band(k.distance, desired));
  row.Put(u.Middle(k.distance, desired));
  row.Put(r.z / (40.0 * u.length));
  const double lx = r.x / level, ly = r.y / level;  // the line of sight
  // Between walls AUVs are anywhere on a sphere around the target. Directly above it there is no
  // horizontal line of sight, so velocities are along the axes of K.
  const double ax = u.walls ? K.c : lx, ay = u.walls ? K.s : ly;
  const auto along = [&](const Vec3<double>& v) { return u.Speed(v.x * ax + v.y * ay); };
  const auto across = [&](const Vec3<double>& v) { return u.Speed(v.y * ax - v.x * ay); };
  row.Put(along(k.v_WT)).Put(across(k.v_WT)).Put(along(k.v_WB)).Put(across(k.v_WB));
  const double mps = EntityScales::kFieldSpeed_mps * u.speed;
  const auto turning = [&](const Vec3<double>& v) { return u.Speed(v.y * lx - v.x * ly); };
  row.Put((turning(k.v_WT) - turning(k.v_WB)) * mps / std::max(level, u.length) * 60.0 * u.time);
  const Covariance3& P = t.belief.P_WT;
  const double mean = 0.5 * (P.xx + P.yy), half = 0.5 * (P.xx - P.yy);
  const double radius = std::hypot(half, P.xy);
  const double s1 = std::sqrt(std::max(mean + radius, 0.0));
  const double s2 = std::sqrt(std::max(mean - radius, 0.0));
  row.Put(u.Deviation(s1)).Put(u.Deviation(s2));
  // Cosine and sine of twice the angle between the long axis and the line of sight.
  const double cos2 = radius > 1e-12 ? half / radius : 1.0;
  const double sin2 = radius > 1e-12 ? P.xy / radius : 0.0;
  const double c2 = lx * lx - ly * ly, s2l = 2.0 * lx * ly;
  const double a = (s1 - s2) / std::max(s1 + s2, 1e-9);
  row.Put(a * (cos2 * c2 + sin2 * s2l)).Put(a * (sin2 * c2 - cos2 * s2l));
  row.Put(u.Deviation(std::sqrt(std::max(P.zz, 0.0))));
  row.Put(t.velocity_std_mps / (0.9 * u.speed));
  if (u.walls) {
    row.Put(K.x(r) / (40.0 * u.length)).Put(K.y(r) / (40.0 * u.length));
    row.Put(r.z / std::max(Norm(r), 1e-9)).Put(u.Speed(k.v_WT.z));
  } else {
    for (int n = 0; n < 4; ++n) row.Put(0.0);
  }
  row.Put(u.Age(t.information_age_s));
  const TimeNs own = in.memory.own_detection[static_cast<std::size_t>(t.target)];
  row.Put(own >= 0 ? u.Age(Seconds(in.memory.now - own)) : 1.0F);
  row.Put(0.0);
  double once = 1.0, twice = 1.0;
  Geometry(in, u, t, &once, &twice);
  row.Put(once).Put(twice);
  row.Put(k.confidence)
      .Put(ShownProgress(c, k))
      .Put(std::log(1.0 + k.mean_error / (30.0 * u.length)) / 4.0);
  row.Put(k.lost).Put(u.Age(k.lost_steps * in.model.run.decision_dt_s()));
  double phase[kPhases], quality[kQualities];
  PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
  // The quality contains the certainty, too, not only the distance.
  QualityOneHot(c, std::min(k.confidence, std::max(0.0, 1.0 - s1 / (100.0 * u.length))), &quality);
  for (const double p : phase) row.Put(p);
  for (const double q : quality) row.Put(q);
  row.Put(t.followed ? 1.0 : 0.0);
}

void PutNeighbour(const EntityInput& in, const EntityScales& u, const Frame& K,
                  const EntityNeighbour& n, float* out) {
  const NeighbourSight<double>& s = n.sight;
  const Vec3<double> w = s.v_W - in.knowledge.v_WB;
  Row row(out);
  PutBearing(K, s.r_BN_W, &row);
  row.Put(u.Far(s.distance_m)).Put((s.distance_m - u.apart_m) / u.apart_m);
  row.Put(s.r_BN_W.z / u.apart_m);
  row.Put(u.Speed(K.x(w))).Put(u.Speed(K.y(w)));
  double miss = 0.0;
  row.Put(u.Age(ClosestApproach(s.r_BN_W, w, u, &miss)));
  row.Put(miss / (2.0 * u.apart_m)).Put(u.Age(s.age_s));
  row.Put(u.Deviation(n.report->position_std_m));
  row.Put(u.Deviation(kDrift * u.speed * s.age_s));
  row.Put(s.link_quality);
  row.Put(u.walls ? K.x(s.r_BN_W) / u.apart_m : 0.0).Put(u.walls ? K.y(s.r_BN_W) / u.apart_m : 0.0);
  for (int p = 0; p < kPhases; ++p) row.Put(n.report->phase == p ? 1.0 : 0.0);
  row.Put(n.report->confidence).Put(std::log(1.0 + s.tracking_error / (30.0 * u.length)) / 4.0);
  row.Put(std::clamp(s.tracking_error / in.model.observation.error_scale_m, 0.0, 1.0));
}

void PutEdge(const EntityInput& in, const EntityScales& u, const Subject& t,
             const EntityNeighbour& n, float* out) {
  const Vec3<double>& r = t.knowledge.r_BT_W;
  const Vec3<double>& s = n.sight.r_BN_W;
  const Vec3<double> q = s - r;  // position of the neighbour relative to the target
  const double d = Norm(q);
  const double level = std::hypot(q.x, q.y), own = std::hypot(r.x, r.y);
  const double both = std::max(level * own, 1e-9);
  Row row(out);
  row.Put(u.Far(d));
  row.Put(u.Band(d, in.model.task.desired_distance_m));
  row.Put(-(q.x * r.x + q.y * r.y) / both).Put((q.x * r.y - q.y * r.x) / both);
  const int followed = in.model.task.free() ? n.report->followed : n.report->target;
  row.Put(followed == t.target ? 1.0 : 0.0);
  double age = 0.0;
  row.Put(Sighted(in, t, *n.report, &age) ? u.Age(age) : 1.0F);
  row.Put(0.0);
  const double share = Dot(s, r) / std::max(Dot(r, r), 1e-9);
  const bool between = share > 0.0 && share < 1.0 && Norm(s - r * share) < u.apart_m;
  row.Put(between ? 1.0 : 0.0);
}

/// Knowledge of a target that the AUV does not follow, as if it followed it from this decision on.
/// It has no history.
Knowledge<double> Regarding(const EntityInput& in, const EntityBelief& b) {
  const AgentModel& m = in.model;
  Knowledge<double> k = in.knowledge;
  k.v_WT = b.v_WT;
  k.Measure(b.r_BT_W, k.v_WB - k.v_WT, m.task.desired_distance_m);
  k.previous_distance = k.distance;
  k.mean_error = k.error;
  const bool lost =
      b.belief.position_std_m() > m.track.lost_std_m || k.distance > m.task.lost_distance_m;
  const bool seen = b.belief.observed && b.information_age_s <= m.track.neighbour_max_age_s;
  k.lost = lost ? 1.0 : 0.0;
  k.lost_steps = 0.0;
  k.confidence = !lost && seen ? Confidence(k.distance, m.sensing.range_m) : 0.0;
  return k;
}

}  // namespace

void BuildEntities(const EntityInput& in, Entities* out) {
  const EntityScales u(in.model);
  const Frame K = FrameOf(in.knowledge, u);
  PutSelf(in, u, K, out->self);
  if (in.search != nullptr) {
    BuildSearchRow(*in.search, in.knowledge.p_WB, K.c, K.s, in.model.sensing.range_m, out->search);
  } else {
    std::fill(out->search, out->search + kSearchNumbers, 0.0F);
  }
  out->neighbours = std::min(in.neighbour_count, kNeighbourRows);
  out->targets = 0;
  const auto put = [&](const Subject& t) {
    const int row = out->targets++;
    out->target_of_row[row] = t.target;
    PutTarget(in, u, t, K, out->target[row]);
    for (int j = 0; j < out->neighbours; ++j)
      PutEdge(in, u, t, in.neighbours[j], out->edge[row][j]);
  };
  if (in.belief.started) {
    put({in.target, in.knowledge, in.belief, in.velocity_std_mps, in.information_age_s, true});
  }
  for (int k = 0; k < in.other_count && out->targets < kTargetRows; ++k) {
    const EntityBelief& b = in.others[k];
    put({b.target, Regarding(in, b), b.belief, b.velocity_std_mps, b.information_age_s, false});
  }
  for (int j = 0; j < out->neighbours; ++j)
    PutNeighbour(in, u, K, in.neighbours[j], out->neighbour[j]);
  out->obstacles = BuildObstacleRows(in, u, K, out->obstacle);
}

void BuildEntities(const AgentView& agent, Entities* out) {
  const TargetEstimate estimate = agent.estimate();
  EntityInput in{agent.model(),     agent.id(),     agent.target(),
                 agent.knowledge(), agent.memory(), agent.belief()};
  in.velocity_std_mps = std::sqrt(std::max(estimate.vv, 0.0));
  in.information_age_s = std::max(0.0, Seconds(in.memory.now - in.belief.information));
  if (agent.search() != nullptr) in.search = &agent.search()->map();
  std::array<EntityBelief, kMostTargets> others;
  for (int k = 0; k < agent.beliefs(); ++k) {
    const int target = agent.first_target() + k;
    if (target == agent.target()) continue;
    EntityBelief b{target, {}, {}, agent.belief(target)};
    if (!b.belief.started) continue;
    const TargetEstimate e = agent.estimate(target);
    b.r_BT_W = e.p_WT - in.knowledge.p_WB;
    b.v_WT = e.v_WT;
    b.velocity_std_mps = std::sqrt(std::max(e.vv, 0.0));
    b.information_age_s = std::max(0.0, Seconds(in.memory.now - b.belief.information));
    const auto distance = [&](int at) { return Norm(others[static_cast<std::size_t>(at)].r_BT_W); };
    int rank = in.other_count++;
    for (; rank > 0 && Norm(b.r_BT_W) < distance(rank - 1); --rank) {
      others[static_cast<std::size_t>(rank)] = others[static_cast<std::size_t>(rank - 1)];
    }
    others[static_cast<std::size_t>(rank)] = b;
  }
  in.others = others.data();
  EntityNeighbour nearest[kNeighbourRows];
  for (const int id : agent.neighbours().known()) {
    const NeighbourSight<double> sight = agent.sight(id);
    int rank = in.neighbour_count;
    while (rank > 0 && sight.distance_m < nearest[rank - 1].sight.distance_m) --rank;
    if (rank >= kNeighbourRows) continue;
    if (in.neighbour_count < kNeighbourRows) ++in.neighbour_count;
    for (int k = in.neighbour_count - 1; k > rank; --k) nearest[k] = nearest[k - 1];
    nearest[rank] = {sight, &agent.neighbours().state(id)};
  }
  in.neighbours = nearest;
  BuildEntities(in, out);
}

}  // namespace stg::agent
