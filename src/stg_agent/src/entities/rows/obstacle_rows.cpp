#include "obstacle_rows.hpp"

namespace stg::agent {
namespace {

constexpr double kRange = 500.0;  // farther obstacles are not shown [m, in the field]

enum class Kind { kSphere, kUpright, kWall };

/// One obstacle, relative to the AUV. Of a wall, r points at its nearest point.
struct Seen {
  Kind kind;
  Vec3<double> r;
  double clearance;
  double size;     ///< radius; of a wall, the target's distance to it
  double nearest;  ///< decides the order, and whether it is shown
};

/// The nearest obstacles so far, in their order.
struct Nearest {
  double range;
  Seen seen[kObstacleRows];
  int count = 0;

  void Offer(const Seen& s) {
    if (s.nearest > range) return;
    int rank = count;
    while (rank > 0 && s.nearest < seen[rank - 1].nearest) --rank;
    if (rank >= kObstacleRows) return;
    if (count < kObstacleRows) ++count;
    for (int k = count - 1; k > rank; --k) seen[k] = seen[k - 1];
    seen[rank] = s;
  }
};

void OfferChart(const EntityInput& in, Nearest* nearest) {
  const Vec3<double>& p = in.knowledge.p_WB;
  for (const auto& b : in.model.sea.spheres) {
    const Vec3<double> r{b[0] - p.x, b[1] - p.y, b[2] - p.z};
    const double clearance = Norm(r) - b[3];
    nearest->Offer({Kind::kSphere, r, clearance, b[3], clearance});
  }
  for (const auto& b : in.model.sea.cylinders) {
    const double z = std::clamp(p.z, b[2], b[2] + b[4]);
    const Vec3<double> r{b[0] - p.x, b[1] - p.y, z - p.z};
    const double clearance = std::hypot(std::max(std::hypot(r.x, r.y) - b[3], 0.0), r.z);
    nearest->Offer({Kind::kUpright, r, clearance, b[3], clearance});
  }
}

/// A wall matters to a swarm when the AUV or its target is near it: at a wall the AUVs have only
/// half a sphere around the target.
void OfferWalls(const EntityInput& in, Nearest* nearest) {
  const Vec3<double>& p = in.knowledge.p_WB;
  const Vec3<double> goal = p + in.knowledge.r_BT_W;
  for (int w = 0; w < 6; ++w) {
    const int axis = w / 2;
    const double side = w % 2 == 0 ? 1.0 : -1.0;
    const Vec3<double> normal{axis == 0 ? side : 0.0, axis == 1 ? side : 0.0,
                              axis == 2 ? side : 0.0};
    // An estimate may be behind the wall; its direction must stay defined.
    const double clearance = std::max(in.model.wall_m() - Dot(p, normal), 1e-6);
    const double room = in.model.wall_m() - Dot(goal, normal);
    nearest->Offer({Kind::kWall, normal * clearance, clearance, room, std::min(clearance, room)});
  }
}

void PutObstacle(const EntityInput& in, const EntityScales& scales, const Frame& K, const Seen& o,
                 float* out) {
  const double d = std::max(Norm(o.r), 1e-6);
  const double closing = scales.Speed(Dot(in.knowledge.v_WB, o.r) / d);
  Row row(out);
  for (const Kind kind : {Kind::kSphere, Kind::kUpright, Kind::kWall}) {
    row.Put(o.kind == kind ? 1.0 : 0.0);
  }
  if (o.kind == Kind::kWall) {
    const double desired = in.model.task.desired_distance_m;
    row.Put(K.x(o.r) / d).Put(K.y(o.r) / d).Put(scales.Far(o.clearance));
    row.Put((o.clearance - scales.apart_m) / scales.apart_m).Put(closing);
    row.Put((o.size - desired) / desired).Put(o.r.z / d);
    return;
  }
  PutBearing(K, o.r, &row);
  row.Put(scales.Far(std::max(o.clearance, 0.0)));
  row.Put((o.clearance / scales.length - 25.0) / 25.0).Put(closing);
  row.Put(scales.Far(o.size)).Put(o.r.z / (20.0 * scales.length));
}

}  // namespace

int BuildObstacleRows(const EntityInput& in, const EntityScales& scales, const Frame& K,
                      float (*out)[kObstacleNumbers]) {
  Nearest nearest{kRange * scales.length, {}, 0};
  OfferChart(in, &nearest);
  if (scales.walls) OfferWalls(in, &nearest);
  for (int o = 0; o < nearest.count; ++o) PutObstacle(in, scales, K, nearest.seen[o], out[o]);
  return nearest.count;
}

}  // namespace stg::agent
