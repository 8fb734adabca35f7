#pragma once

#include <cstdint>

namespace stg::learn {

/// Generalised advantage estimation (Eqs. 39-40) of one environment's segment.
///
/// Every episode ends by truncation. So a step that ends an episode bootstraps with the value of
/// the state *before* the reset, and the recursion starts anew there.
///
/// Arrays have `steps` entries at distance `stride`.
/// @param rewards r_t.
/// @param values V(s_t).
/// @param done 1 if the episode ended with step t.
/// @param final_values V of the state before the reset; only read where done.
/// @param bootstrap V of the state after the segment; unused if its last step is done.
/// @param advantages A_t, written. The value target is A_t + V(s_t).
void GeneralisedAdvantages(const float* rewards, const float* values, const std::uint8_t* done,
                           const float* final_values, float bootstrap, int steps, int stride,
                           float gamma, float lambda, float* advantages);

}  // namespace stg::learn
