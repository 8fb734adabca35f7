#include "instruments.hpp"

#include <cmath>
#include <limits>

#include "auv_common/error.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kInstrumentQueue = 20;

const dynamics::SeaConfig& Open(const dynamics::SeaConfig& sea, const RunConfig& run) {
  if (sea.open) return sea;
  throw UserError(
      "parameter instruments: scenario '" + run.name +
      "' has no open water (sea.open), so there is no depth and no geographic position");
}

}  // namespace

Instruments::Instruments(const RunConfig& run, const dynamics::SeaConfig& sea)
    : period_s_(Seconds(run.decision_period())),
      datum_(Open(sea, run).latitude_deg, sea.longitude_deg),
      auvs_(static_cast<std::size_t>(run.agents)) {
  for (int i = 0; i < run.agents; ++i) Advertise(i);
}

void Instruments::Advertise(int i) {
  Auv& auv = auvs_[static_cast<std::size_t>(i)];
  auv.header.frame_id = frames::Body(i);
  auv.imu.Advertise(topics::AuvTopic(i, topics::kImu), kInstrumentQueue,
                    [&auv](sensor_msgs::Imu* m) {
                      m->header = auv.header;
                      m->orientation.w = auv.nav.q_WB[0];
                      m->orientation.x = auv.nav.q_WB[1];
                      m->orientation.y = auv.nav.q_WB[2];
                      m->orientation.z = auv.nav.q_WB[3];
                      SetVector(auv.nav.w_WB_B, &m->angular_velocity);
                      SetVector(auv.specific_force_B, &m->linear_acceleration);
                      return !m->header.stamp.isZero();
                    });
  auv.pressure.Advertise(topics::AuvTopic(i, topics::kPressure), kInstrumentQueue,
                         [&auv](sensor_msgs::FluidPressure* m) {
                           m->header = auv.header;
                           m->fluid_pressure =
                               kAtmosphere_Pa - kDensity_kgpm3 * kGravity_mps2 * auv.nav.p_WB.z;
                           return !m->header.stamp.isZero();
                         });
  auv.dvl.Advertise(topics::AuvTopic(i, topics::kDvl), kInstrumentQueue,
                    [&auv](geometry_msgs::TwistWithCovarianceStamped* m) {
                      m->header = auv.header;
                      SetVector(auv.nav.v_WB_B, &m->twist.twist.linear);
                      return !m->header.stamp.isZero();
                    });
  auv.altitude.Advertise(topics::AuvTopic(i, topics::kAltitude), kInstrumentQueue,
                         [this, &auv, i](sensor_msgs::Range* m) {
                           m->header = auv.header;
                           m->header.frame_id = frames::Altimeter(i);
                           m->radiation_type = sensor_msgs::Range::ULTRASOUND;
                           m->field_of_view = 0.0F;
                           m->min_range = static_cast<float>(kAltimeter_m[0]);
                           m->max_range = static_cast<float>(kAltimeter_m[1]);
                           const bool heard = auv.altitude_m <= kAltimeter_m[1];
                           m->range = heard ? static_cast<float>(auv.altitude_m)
                                            : std::numeric_limits<float>::infinity();
                           if (m->header.stamp.isZero()) return false;
                           PointDown(m->header, auv.p_WB);
                           return true;
                         });
  auv.gps.Advertise(topics::AuvTopic(i, topics::kGps), kInstrumentQueue,
                    [this, &auv](sensor_msgs::NavSatFix* m) {
                      if (auv.header.stamp.isZero() || auv.nav.p_WB.z < -kSurface_m) return false;
                      const auto place = datum_.ToGeodetic(auv.nav.p_WB);
                      m->header = auv.header;
                      m->status.status = sensor_msgs::NavSatStatus::STATUS_FIX;
                      m->status.service = sensor_msgs::NavSatStatus::SERVICE_GPS;
                      m->latitude = place.latitude_deg;
                      m->longitude = place.longitude_deg;
                      m->altitude = place.height_m;
                      m->position_covariance_type = sensor_msgs::NavSatFix::COVARIANCE_TYPE_UNKNOWN;
                      return true;
                    });
}

void Instruments::PointDown(const std_msgs::Header& beam, const Vec3<double>& p_WB) {
  geometry_msgs::TransformStamped down;
  down.header.stamp = beam.stamp;
  down.header.frame_id = frames::kWorld;
  down.child_frame_id = beam.frame_id;
  SetVector(p_WB, &down.transform.translation);
  down.transform.rotation.y = down.transform.rotation.w = std::sqrt(0.5);  // turns x to -z
  frames_.sendTransform(down);
}

void Instruments::Publish(const dynamics::World& world, TimeNs now, bool first) {
  const Vec3<double> up{0.0, 0.0, kGravity_mps2};
  for (int i = 0; i < world.agents(); ++i) {
    Auv& auv = auvs_[static_cast<std::size_t>(i)];
    const dynamics::VehicleState<Pack>& v = world.vehicle(i);
    const Vec3<double> v_WB = Lane(v.v_WB, 0), p_WB = Lane(v.p_WB, 0);
    const Vec3<double> acceleration =
        first ? Vec3<double>() : (v_WB - auv.v_WB) * (1.0 / period_s_);
    auv.specific_force_B = Lane(v.R_WB.TransposeTimes(Broadcast(acceleration + up)), 0);
    auv.v_WB = v_WB;
    auv.p_WB = p_WB;
    auv.header.stamp = TimeOf(now);
    auv.nav = world.Nav(0, i);
    auv.altitude_m = world.sea().terrain().Altitude(p_WB);
    auv.imu.Publish();
    auv.pressure.Publish();
    auv.dvl.Publish();
    auv.altitude.Publish();
    auv.gps.Publish();
  }
}

}  // namespace stg::nodes
