#pragma once

#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

inline constexpr int kWallUnits = 24;  ///< 6 walls, 4 distances

/// Places of two vectors in an actor's inputs. Each has three numbers in units of the half extent.
struct WallInputs {
  int own_position;   ///< index of its first number
  int target_offset;  ///< vector from the AUV to its target
};

/// Replaces the kWallUnits units of a ReLU actor's first layer that have the least influence. The
/// new units are hinges that rise where the target is closer to a wall than 1/2, 1, 2 and 4 times
/// the margin. Their output weights are zero at first. Close to a wall the best action changes
/// within the margin. The inputs span the whole workspace, so training alone finds a change this
/// sharp late or never.
/// @param margin_m       width of the region where the best action changes [m]
/// @param half_extent_m  of the workspace [m]
/// @param observations   normaliser of the inputs
void PlaceWallUnits(const Mlp& actor, const WallInputs& where, double margin_m,
                    double half_extent_m, const Normaliser& observations, float* parameters);

}  // namespace stg::learn
