#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/NavSatFix.h>
#include <sensor_msgs/Range.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "auv_common/nodes/on_demand.hpp"
#include "auv_dynamics/terrain/datum.hpp"
#include "auv_dynamics/world/world.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::nodes {

/// Publishes the instruments that marine ROS software uses, for every AUV of lane 0 in open water,
/// at each decision:
///   imu       attitude and body rates of the navigation; the specific force is the mean since the
///             previous decision, from the change of the true velocity over ground
///   pressure  absolute, for the depth of the navigation: p_atm + rho g depth
///   dvl       velocity over ground in body axes, from the navigation
///   altitude  of the body's origin above the bottom, straight down for any attitude, along x of
///             its own frame in tf; +Inf if it is out of range (REP 117)
///   gps       within kSurface_m of the surface, where an aerial is out of the water
/// It costs nothing without subscribers.
class Instruments {
 public:
  static constexpr double kDensity_kgpm3 = 1026.0, kGravity_mps2 = 9.81;
  static constexpr double kAtmosphere_Pa = 101325.0;
  static constexpr double kSurface_m = 0.5;
  static constexpr double kAltimeter_m[2] = {0.3, 100.0};  ///< range of the altimeter

  /// Throws UserError for a scenario without open water, because there is neither depth nor
  /// latitude.
  Instruments(const RunConfig& run, const dynamics::SeaConfig& sea);

  /// @param now clock time of the decision; `first` decision of an episode: no motion before it
  void Publish(const dynamics::World& world, TimeNs now, bool first);

 private:
  struct Auv {
    OnDemand<sensor_msgs::Imu> imu;
    OnDemand<sensor_msgs::FluidPressure> pressure;
    OnDemand<geometry_msgs::TwistWithCovarianceStamped> dvl;
    OnDemand<sensor_msgs::Range> altitude;
    OnDemand<sensor_msgs::NavSatFix> gps;
    std_msgs::Header header;
    dynamics::NavState nav;
    Vec3<double> p_WB, v_WB, specific_force_B;
    double altitude_m = 0.0;
  };
  void Advertise(int i);
  /// Sends the frame of an altimeter's beam.
  void PointDown(const std_msgs::Header& beam, const Vec3<double>& p_WB);

  double period_s_;
  dynamics::Datum datum_;
  std::vector<Auv> auvs_;
  tf2_ros::TransformBroadcaster frames_;
};

}  // namespace stg::nodes
