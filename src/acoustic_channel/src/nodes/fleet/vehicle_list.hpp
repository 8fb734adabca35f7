#pragma once

#include <string>
#include <vector>

namespace stg::nodes {

/// A vehicle of any simulator, as given in the parameters.
struct FleetVehicle {
  std::string name;  ///< prefix of its topics: "alpha", "fleet/beta"
  int id = 0;        ///< number of the vehicle in messages
  std::string odom;  ///< topic of its odometry

  std::string Topic(const char* topic) const { return "/" + name + "/" + topic; }
};

/// Reads the private parameter `vehicles`: a list of vehicles, or one text with words. A vehicle is
/// a text NAME or NAME=TOPIC, or a map with `name` and optional `id` (0 to 254; default: place in
/// the list) and `odom` (default: /NAME/odom). Throws UserError for anything else, for an empty
/// list, and for two vehicles with the same name, id or odometry topic.
std::vector<FleetVehicle> VehicleListParameter();

/// The index of the vehicle with this id; kNoVehicle: there is none.
inline constexpr int kNoVehicle = -2;
int IndexOf(const std::vector<FleetVehicle>& vehicles, long id);

}  // namespace stg::nodes
