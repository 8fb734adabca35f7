#pragma once

/// The observation layout `stg-2:entities`: the knowledge of one AUV, as one row about itself and
/// any number of rows about others. docs/entities.md lists all numbers.
///
/// Frame K of an AUV: origin its own navigated position, x along its course over ground (its
/// heading below 0.3 m/s; between walls always its heading), y to port, z up. No number depends on
/// where north is.
namespace stg::agent {

inline constexpr char kEntityLayout[] = "stg-2:entities";

/// Numbers of one row.
inline constexpr int kSelfNumbers = 26;
inline constexpr int kTargetNumbers = 40;
inline constexpr int kNeighbourNumbers = 22;
inline constexpr int kEdgeNumbers = 8;
inline constexpr int kObstacleNumbers = 10;
inline constexpr int kSearchNumbers = 28;

/// Most rows of a kind. Of more neighbours or obstacles the nearest are shown.
inline constexpr int kTargetRows = 5;
inline constexpr int kNeighbourRows = 16;
inline constexpr int kObstacleRows = 8;

/// Every number is clipped to +-this.
inline constexpr float kEntityClip = 3.0F;

/// Indices of some of the numbers.
inline constexpr int kSelfDeviation = 8;     ///< of the own position
inline constexpr int kSelfCommand = 9;       ///< the five of the last command
inline constexpr int kSelfGraph = 14;        ///< the six of Eq. 18
inline constexpr int kSelfNeighbours = 20;   ///< how many there are
inline constexpr int kTargetDeviation = 11;  ///< the six of the ellipse, depth and velocity
inline constexpr int kTargetAge = 21;        ///< of the newest observation, and of the own one
inline constexpr int kTargetPhase = 31;      ///< four phases, and then four qualities
inline constexpr int kTargetFollowed = 39;   ///< 1 of the target that it follows
inline constexpr int kNeighbourAge = 9;      ///< of the packet; stated deviation, its growth since
inline constexpr int kNeighbourQuality = 12;
inline constexpr int kNeighbourError = 21;
inline constexpr int kEdgeAge = 5;  ///< of the neighbour's newest measurement

}  // namespace stg::agent
