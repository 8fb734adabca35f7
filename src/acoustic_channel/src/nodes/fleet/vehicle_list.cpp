#include "vehicle_list.hpp"

#include <ros/names.h>

#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {
namespace {

using XmlRpc::XmlRpcValue;

constexpr int kLargestId = 254;

[[noreturn]] void RefuseEntry(int place, const std::string& why) {
  throw UserError("parameter vehicles: entry " + std::to_string(place) + ": " + why);
}

std::string TextOf(int place, const XmlRpcValue& value, const std::string& what) {
  if (value.getType() != XmlRpcValue::TypeString) RefuseEntry(place, what + " must be text");
  return XmlRpcValue(value);
}

/// Parses NAME or NAME=TOPIC.
FleetVehicle FromWord(const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return {word, 0, ""};
  return {word.substr(0, equals), 0, word.substr(equals + 1)};
}

FleetVehicle FromMap(int place, XmlRpcValue& map) {
  FleetVehicle v;
  v.id = place;
  for (auto& [key, value] : map) {
    if (key == "name") {
      v.name = TextOf(place, value, key);
    } else if (key == "odom") {
      v.odom = TextOf(place, value, key);
    } else if (key == "id") {
      if (value.getType() != XmlRpcValue::TypeInt) RefuseEntry(place, "id must be a whole number");
      v.id = static_cast<int>(value);
    } else {
      RefuseEntry(place, "unknown key '" + key + "'; the keys are name, id, odom");
    }
  }
  return v;
}

void Complete(int place, FleetVehicle* v) {
  while (!v->name.empty() && v->name.front() == '/') v->name.erase(0, 1);
  std::string error;
  if (v->name.empty() || !ros::names::validate("/" + v->name, error)) {
    RefuseEntry(place, "'" + v->name + "' is not a valid name of a vehicle");
  }
  if (v->odom.empty()) v->odom = v->Topic("odom");
  if (!ros::names::validate(v->odom, error)) {
    RefuseEntry(place, "'" + v->odom + "' is not a valid name of a topic");
  }
  if (v->id < 0 || v->id > kLargestId) {
    RefuseEntry(place, "id must be from 0 to " + std::to_string(kLargestId));
  }
}

void RefuseTwins(const std::vector<FleetVehicle>& vehicles) {
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const FleetVehicle &a = vehicles[j], &b = vehicles[i];
      const int place = static_cast<int>(i);
      if (a.name == b.name) RefuseEntry(place, "another vehicle has the name '" + b.name + "'");
      if (a.id == b.id) RefuseEntry(place, "another vehicle has the id " + std::to_string(b.id));
      if (a.odom == b.odom) RefuseEntry(place, "another vehicle has the odometry topic " + b.odom);
    }
  }
}

}  // namespace

std::vector<FleetVehicle> VehicleListParameter() {
  XmlRpcValue value;
  PrivateParameter("vehicles", &value);
  std::vector<FleetVehicle> vehicles;
  if (value.getType() == XmlRpcValue::TypeString) {
    std::istringstream words{std::string(value)};
    for (std::string word; words >> word;) {
      vehicles.push_back(FromWord(word));
      vehicles.back().id = static_cast<int>(vehicles.size()) - 1;
    }
  } else if (value.getType() == XmlRpcValue::TypeArray) {
    for (int i = 0; i < value.size(); ++i) {
      const bool map = value[i].getType() == XmlRpcValue::TypeStruct;
      vehicles.push_back(map ? FromMap(i, value[i])
                             : FromWord(TextOf(i, value[i], "an entry that is not a map of keys")));
      if (!map) vehicles.back().id = i;
    }
  } else {
    throw UserError("parameter vehicles: must be a list of vehicles");
  }
  if (vehicles.empty()) throw UserError("parameter vehicles: must name at least one vehicle");
  for (std::size_t i = 0; i < vehicles.size(); ++i) Complete(static_cast<int>(i), &vehicles[i]);
  RefuseTwins(vehicles);
  return vehicles;
}

int IndexOf(const std::vector<FleetVehicle>& vehicles, long id) {
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    if (vehicles[i].id == id) return static_cast<int>(i);
  }
  return kNoVehicle;
}

}  // namespace stg::nodes
