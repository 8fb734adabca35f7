#pragma once

#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

inline constexpr int kWallUnits = 24;  ///< 6 walls, 4 distances

/// Where an actor's inputs hold two vectors, each of three numbers in units of the half extent.
struct WallInputs {
  int own_position;   ///< index of its first number
  int target_offset;  ///< from the AUV to its target
};

/// Turns the kWallUnits units of a ReLU actor's first layer that say least into hinges that rise
/// where the target is closer to a wall than 1/2, 1, 2 and 4 times the margin, and that nothing
/// listens to yet. On the way to a wall the best action changes within the margin; from inputs
/// that span the workspace, training finds so sharp a kink late or never.
/// @param margin_m       of the kink that matters [m]
/// @param half_extent_m  of the workspace [m]
/// @param observations   the normaliser that the inputs of the hinges pass
void PlaceWallUnits(const Mlp& actor, const WallInputs& where, double margin_m,
                    double half_extent_m, const Normaliser& observations, float* parameters);

}  // namespace stg::learn
