#pragma once

/// Names of the view's topics, relative to the marker node's own name.
namespace stg::topics {

inline constexpr char kOverview[] = "overview";
inline constexpr char kClose[] = "close";
inline constexpr char kTerrain[] = "terrain";

}  // namespace stg::topics
