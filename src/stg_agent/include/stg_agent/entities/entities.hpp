#pragma once

#include "stg_agent/agent/agent_view.hpp"
#include "stg_agent/agent/entity_memory.hpp"
#include "stg_agent/entities/entity_scales.hpp"
#include "stg_agent/entities/layout.hpp"
#include "stg_agent/search/search_map.hpp"

namespace stg::agent {

/// The rows of one AUV. Rows after the counts have no meaning.
struct Entities {
  int targets = 0, neighbours = 0, obstacles = 0;
  float self[kSelfNumbers];
  float search[kSearchNumbers];
  float target[kTargetRows][kTargetNumbers];
  float neighbour[kNeighbourRows][kNeighbourNumbers];
  float obstacle[kObstacleRows][kObstacleNumbers];
  float edge[kTargetRows][kNeighbourRows][kEdgeNumbers];  ///< of target t and neighbour n
  int target_of_row[kTargetRows];                         ///< the target that a row is about
};

/// A neighbour, as input of the entities.
struct EntityNeighbour {
  NeighbourSight<double> sight;
  const NeighbourState* report = nullptr;  ///< its newest packet
};

/// An estimate of a target that the AUV does not follow, as input of the entities.
struct EntityBelief {
  int target = 0;
  Vec3<double> r_BT_W, v_WT;  ///< against the own position, in the frame of the own navigation
  TargetBelief belief;
  double velocity_std_mps = 0.0, information_age_s = 0.0;
};

/// The whole input of the entities. World axes.
struct EntityInput {
  const AgentModel& model;
  int id;
  int target;  ///< that it is tasked with
  const Knowledge<double>& knowledge;
  const EntityMemory& memory;
  TargetBelief belief;
  double velocity_std_mps = 0.0;                ///< of the target's estimate, each axis
  double information_age_s = 0.0;               ///< of the newest observation in it
  const EntityNeighbour* neighbours = nullptr;  ///< [neighbour_count], nearest first
  int neighbour_count = 0;
  const SearchMap* search = nullptr;     ///< null: it keeps no map
  const EntityBelief* others = nullptr;  ///< [other_count], nearest first; all of them started
  int other_count = 0;
};

/// Writes the rows; allocates nothing. Neighbours have the order of the input, and obstacles are
/// sorted by distance. The first row of a target is for the target that the AUV follows, if it has
/// an estimate of it. The rows of the other targets are sorted by distance. There are at most
/// kTargetRows.
///
/// Some numbers are always zero, because the agent does not compute them yet: for a target, the
/// last innovation, and in open water the second mixture component; for a neighbour in open water,
/// the share of its packets missed and their SINR; for an edge, the share of the information; for
/// the AUV itself, the site's noise.
void BuildEntities(const EntityInput& input, Entities* out);

/// The same of an agent after Observe, with its nearest neighbours.
void BuildEntities(const AgentView& agent, Entities* out);

/// The row about the search: square roots of the map's mass in eight sectors of the frame K, the
/// first one straight ahead, the next ones to port, for three rings (0 to 400, 900, 2000 m); the
/// mass within the sensor's reach; the entropy divided by the entropy of a uniform map; cos and sin
/// of the bearing of the cell with the largest mass.
/// @param cos_course, sin_course the x axis of K in the world
/// @param out [kSearchNumbers]
void BuildSearchRow(const SearchMap& map, const Vec3<double>& p_WB, double cos_course,
                    double sin_course, double sensor_m, float* out);

}  // namespace stg::agent
