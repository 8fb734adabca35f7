#include "agent_messages.hpp"

#include <algorithm>
#include <cmath>

#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

/// Time between two messages of the search map [ns]. The AUVs of `search` look every 5 s.
constexpr TimeNs kSearchMapPeriod = 5'000'000'000;

}  // namespace

bool FiniteFrame(const auv_msgs::SensorFrame& m) {
  return FinitePose(m.pose) && FiniteTwist(m.twist) && Finite(m.position_std) &&
         Finite(m.heading_std) && m.position_std >= 0.0 && m.heading_std >= 0.0 &&
         FiniteVector(m.fix_position) && Finite(m.fix_std) && m.fix_std >= 0.0;
}

dynamics::NavState NavOf(const auv_msgs::SensorFrame& m, TimeNs start) {
  dynamics::NavState nav = NavOf(m.pose, m.twist, NsOf(m.header.stamp) - start);
  nav.position_std_m = m.position_std;
  nav.heading_std_rad = m.heading_std;
  if (m.fix_std > 0.0) {
    nav.fix_stamp = NsOf(m.fix_stamp) - start;
    nav.p_WF = VectorOf(m.fix_position);
    nav.fix_std_m = m.fix_std;
  }
  return nav;
}

dynamics::Cue CueOf(const auv_msgs::SensorFrame& m, int target) {
  dynamics::Cue cue;
  cue.target = -1;  // no target
  if (m.cue_valid && FiniteVector(m.cue_position) && Finite(m.cue_std) && m.cue_std >= 0.0) {
    cue.target = target;
    cue.p_WT = VectorOf(m.cue_position);
    cue.std_m = m.cue_std;
  }
  return cue;
}

std::vector<dynamics::Cue> OtherCues(const auv_msgs::SensorFrame& m, const dynamics::Cue& cue,
                                     int own, int targets) {
  std::vector<dynamics::Cue> others;
  const auto finite = [](const auto& p) { return FiniteVector(p); };
  if (cue.target < 0 || m.cues.size() != static_cast<std::size_t>(targets) ||
      !std::all_of(m.cues.begin(), m.cues.end(), finite)) {
    return others;
  }
  for (int k = 0; k < targets; ++k) {
    if (k == own) continue;
    others.push_back(cue);
    others.back().target = k;
    others.back().p_WT = VectorOf(m.cues[static_cast<std::size_t>(k)]);
  }
  return others;
}

void SetTaskState(const agent::Agent& agent, const agent::AgentOutput& output,
                  auv_msgs::TaskState* m) {
  const agent::TaskView task = agent.task();
  const agent::Knowledge<double>& k = agent.knowledge();
  const agent::TargetBelief target = agent.belief();
  std::copy(task.z_track.begin(), task.z_track.end(), m->z_track.begin());
  std::copy(task.graph.begin(), task.graph.end(), m->graph_summary.begin());
  m->phase = static_cast<std::uint8_t>(task.phase);
  m->quality = static_cast<std::uint8_t>(task.quality);
  m->role = task.role;
  m->action.assign(output.action, output.action + agent.model().control.action_size());
  m->target = static_cast<std::uint32_t>(agent.target());
  m->absent = !agent.present();
  m->target_known = target.started;
  SetVector(target.p_WT, &m->target_position);
  SetVector(target.v_WT, &m->target_velocity);
  SetVector(k.r_BT_W, &m->target_offset);
  m->target_std = target.position_std_m();
  const agent::Covariance3& P = target.P_WT;
  const double covariance[6] = {P.xx, P.xy, P.xz, P.yy, P.yz, P.zz};
  std::copy(covariance, covariance + 6, m->target_covariance.begin());
  m->target_age = Seconds(target.stamp - target.information);
  m->target_distance = k.distance;
  m->tracking_error = k.error;
  m->confidence = k.confidence;
  m->neighbours.clear();
  m->neighbour_age = 0.0;
  const agent::AgentView view = agent.view();
  m->beliefs.clear();
  m->beliefs_known.clear();
  for (int k = 0; agent.model().task.free() && k < view.beliefs(); ++k) {
    const agent::TargetBelief belief = view.belief(k);
    m->beliefs.emplace_back();
    SetVector(belief.p_WT, &m->beliefs.back());
    m->beliefs_known.push_back(agent::Known(agent.model(), belief) ? 1 : 0);
  }
  for (const int id : view.neighbours().known()) {
    const double age = view.sight(id).age_s;
    m->neighbour_age = m->neighbours.empty() ? age : std::min(m->neighbour_age, age);
    m->neighbours.push_back(static_cast<std::uint32_t>(id));
  }
}

bool ShowsSearchMap(TimeNs time, TimeNs step) {
  return time < step || time / kSearchMapPeriod != (time - step) / kSearchMapPeriod;
}

bool SetSearchMap(const agent::SearchMemory& search, const ros::Time& stamp,
                  nav_msgs::OccupancyGrid* m) {
  using agent::SearchMap;
  const SearchMap& map = search.map();
  double largest = 0.0;
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) largest = std::max(largest, map.mass(r, c));
  }
  if (!(largest > 0.0)) return false;
  m->header.frame_id = frames::kWorld;
  m->header.stamp = m->info.map_load_time = stamp;
  m->info.resolution = static_cast<float>(map.cell_m());
  m->info.width = m->info.height = SearchMap::kSide;
  // The corner of cell (0, 0), not its middle.
  m->info.origin.position.x = map.x(0) - 0.5 * map.cell_m();
  m->info.origin.position.y = map.y(0) - 0.5 * map.cell_m();
  m->info.origin.position.z = 0.0;
  m->info.origin.orientation.w = 1.0;
  m->data.clear();
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      const double percent = 100.0 * map.mass(r, c) / largest;
      m->data.push_back(map.Inside(r, c) ? static_cast<std::int8_t>(std::lround(percent)) : -1);
    }
  }
  return true;
}

}  // namespace stg::nodes
