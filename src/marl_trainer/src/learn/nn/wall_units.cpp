#include "marl_trainer/learn/nn/wall_units.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <numeric>
#include <vector>

namespace stg::learn {

void PlaceWallUnits(const Mlp& actor, const WallInputs& where, double margin_m,
                    double half_extent_m, const Normaliser& observations, float* parameters) {
  assert(actor.layers() >= 2 && actor.spec().layer_outputs(0) >= kWallUnits);
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int inputs = actor.spec().layer_inputs(0), units = actor.spec().layer_outputs(0);
  Eigen::Map<RowMajor> in(parameters + actor.weight_offset(0), units, inputs);
  Eigen::Map<Eigen::VectorXf> bias(parameters + actor.bias_offset(0), units);
  Eigen::Map<RowMajor> out(parameters + actor.weight_offset(1), actor.spec().layer_outputs(1),
                           units);

  const Eigen::VectorXf say =
      in.rowwise().norm().array() * out.colwise().norm().transpose().array();
  std::vector<int> order(static_cast<std::size_t>(units));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return say[a] < say[b]; });

  const int* unit = order.data();
  for (const double multiple : {0.5, 1.0, 2.0, 4.0}) {
    const double margin = multiple * margin_m / half_extent_m;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double wall : {-1.0, 1.0}) {
        // relu(1 - room / margin), where room = 1 - wall (own + offset) is between target and wall.
        in.row(*unit).setZero();
        double constant = 1.0 - 1.0 / margin;
        for (const int i : {where.own_position + axis, where.target_offset + axis}) {
          const auto n = static_cast<std::size_t>(i);
          in(*unit, i) =
              static_cast<float>(wall / margin * static_cast<double>(observations.std[n]));
          constant += wall / margin * static_cast<double>(observations.mean[n]);
        }
        bias[*unit] = static_cast<float>(constant);
        out.col(*unit++).setZero();
      }
    }
  }
}

}  // namespace stg::learn
