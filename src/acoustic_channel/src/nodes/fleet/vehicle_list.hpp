#pragma once

#include <string>
#include <vector>

namespace stg::nodes {

/// A vehicle of any simulator, as the parameters name it.
struct Vehicle {
  std::string name;  ///< below it are its topics: "alpha", "fleet/beta"
  int id = 0;        ///< by which messages name it
  std::string odom;  ///< topic of its odometry

  std::string Topic(const char* topic) const { return "/" + name + "/" + topic; }
};

/// The private parameter `vehicles`: a list of vehicles, or one text of words. A vehicle is a text
/// NAME or NAME=TOPIC, or a map with `name` and, if wanted, `id` (0 to 254, else the place in the
/// list) and `odom` (else /NAME/odom). Throws UserError for what is none of these, an empty list,
/// and two vehicles with one name, id or odometry topic.
std::vector<Vehicle> VehicleListParameter();

/// The index of the vehicle with this id; kNobody: there is none.
inline constexpr int kNobody = -2;
int IndexOf(const std::vector<Vehicle>& vehicles, long id);

}  // namespace stg::nodes
