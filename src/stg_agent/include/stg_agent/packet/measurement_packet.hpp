#pragma once

#include <cstddef>
#include <cstdint>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/packet/neighbour_state.hpp"
#include "stg_agent/packet/quantiser.hpp"

namespace stg::agent {

/// The packet with measurements instead of an estimate.
///
/// Layout, least significant bit first: version 4, source 8, generation 18 (1 ms, modulo 262.144
/// s), position 3 x 15, velocity 3 x 8, deviation of the position 6 (logarithmic, rounded up; 0 is
/// exact), tracking error 7 (logarithmic), confidence 4, phase 2, link quality 4, saturated 1; two
/// measurements of 62; one bit to spare; CRC-8 8. A measurement: there 1, target 5, age 10 (an
/// eighth of a decision), then
/// - range: position of the observer then minus its position now, 9 + 9 + 7; range 14;
/// - bearing: the same 25; azimuth 11; elevation 10;
/// - position, range_bearing: the point 3 x 15, as the position.
/// With a sensor that does not distinguish port from starboard, one measurement takes both places:
/// the same 25, range 14, azimuth 14, elevation 12, mirrored azimuth 14.
///
/// With task.assignment free the version is 3, and these fields replace the two measurements: the
/// target that the sender follows 4 (one more than its index; 0: not stated); then
/// - range: looks 2. A look is a time of measurement: there is one with five ranges, or there are
///   two, with one range of the first and two of the second, or two and one. Each look has age 10
///   (the second 9, relative to the first) and the position of the observer 9 + 9 + 7. Each range
///   has the target 4, as above, and range 12;
/// - otherwise two measurements, each with its target 4, age 10 and the rest as above; or only one,
///   with a sensor that does not distinguish port from starboard.
///
/// Ranges follow the scenario: positions 1.25 workspace half extents, velocities the vehicle's
/// limit plus the current, offsets the vehicle's way in the largest age, deviation 1e-5 to 1 half
/// extents, tracking error 1e-4 to the workspace diagonal, range 1.25 times that of the sensor,
/// azimuth a circle, elevation +-2 rad.
///
/// With a localizer (localization.kind) the version is 5, with these differences. Reckoned
/// positions may have drifted out of the region, so their horizontal components are sent modulo 2.5
/// half extents; the receiver takes the position nearest to where it expects the sender. The
/// deviation has 5 bits, and one bit states whether the log measures against the water. The second
/// measurement may be two ranges of packets: there 1, target 31, two times source 5 (31: none), age
/// 9 (an eighth of a decision), range 14 (-100 m to 4.9 km). Or it may be a GPS fix: there 1,
/// target 30, age 9, reckoned minus GPS position 2 x 21 (65 km in 0.0625 m), deviation 5
/// (logarithmic, 0.1 to 100 m, rounded up). The spare bit states whether the sender surfaces for a
/// fix. Sources are the AUVs, then the stations, which send this layout too.
class MeasurementPacket {
 public:
  explicit MeasurementPacket(const AgentModel& model);

  /// As PacketCodec::Encode and Decode.
  Packet Encode(const NeighbourState& state) const;
  NeighbourState Decode(const std::uint8_t* data, std::size_t size, TimeNs now,
                        const Vec3<double>& near = {}) const;

  /// Largest error of a decoded number: half the distance between two codes.
  double position_error_m() const { return 0.5 * position_.resolution; }
  double offset_error_m() const { return 0.5 * offset_.resolution; }
  double range_error_m() const { return 0.5 * range_.resolution; }
  double azimuth_error_rad() const { return 0.5 * azimuth_.resolution; }
  double elevation_error_rad() const { return 0.5 * elevation_.resolution; }
  double sent_fix_error_m() const { return 0.5 * sent_error_.resolution; }

 private:
  struct Writer;
  struct Reader;
  /// Logarithmic codes, with one code for zero.
  struct Logarithm {
    double lo, inverse;
    int codes;
    double step;
    std::uint64_t Code(double value, double rounding, bool* saturated) const;
    double Value(std::uint64_t code) const;
    static Logarithm Of(double lo, double hi, int bits);
  };
  void RequireCode(const NeighbourState& s, const dynamics::Detection& d) const;
  TimeNs AgeCode(const NeighbourState& s, const dynamics::Detection& d) const;
  static void WriteAge(TimeNs steps, int bits, Writer* w);
  void WriteObserver(const NeighbourState& s, const dynamics::Detection& d, Writer* w) const;
  Vec3<double> ReadObserver(const NeighbourState& s, Reader* r) const;
  void WriteSighting(const NeighbourState& s, const dynamics::Detection& d, Writer* w) const;
  void ReadSighting(const NeighbourState& s, Reader* r, dynamics::Detection* d) const;
  /// Age and measurement, without the target.
  void WriteMeasured(const NeighbourState& s, const dynamics::Detection& d, Writer* w) const;
  void ReadMeasured(const NeighbourState& s, int target, Reader* r, dynamics::Detection* d) const;
  /// The fields after the status with task.assignment free.
  void WriteFree(const NeighbourState& s, Writer* w) const;
  void ReadFree(Reader* r, NeighbourState* s) const;
  void WriteLooks(const NeighbourState& s, Writer* w) const;
  void ReadLooks(Reader* r, NeighbourState* s) const;
  void WriteName(int target, Writer* w) const;
  int ReadName(Reader* r) const;
  void SetDeviations(const NeighbourState& s, dynamics::Detection* d) const;
  void WritePlace(const Vec3<double>& p, Writer* w) const;
  Vec3<double> ReadPlace(const Vec3<double>& near, Reader* r) const;
  TimeNs SentAge(const NeighbourState& s, TimeNs stamp, Writer* w) const;
  void WriteSentBearing(const NeighbourState& s, Writer* w) const;
  void ReadSentBearing(Reader* r, NeighbourState* s) const;
  void WriteSentRanges(const NeighbourState& s, Writer* w) const;
  void ReadSentRanges(Reader* r, NeighbourState* s) const;
  void WriteSentFix(const NeighbourState& s, Writer* w) const;
  void ReadSentFix(Reader* r, NeighbourState* s) const;
  /// The items of agents with a localizer: ranges, a bearing or a fix.
  void WriteSent(const NeighbourState& s, Writer* w) const;
  /// Reads such an item in place of measurement k, whose code is next; false: a measurement
  /// follows.
  bool ReadSent(int k, Reader* r, NeighbourState* s) const;

  int agents_, targets_;
  bool free_;     ///< task.assignment is free: version 3
  bool located_;  ///< there is a localizer: version 5
  std::uint64_t version_;
  int members_;  ///< AUVs and stations
  dynamics::MeasurementKind kind_;
  bool ambiguous_;
  dynamics::SensingConfig sensing_;
  dynamics::RelativeOptions relative_;
  double heading_variance_, heading_walk_;  // [rad^2], [rad^2/s]
  TimeNs age_step_;
  Quantiser position_, velocity_, unit_, offset_, rise_, range_, azimuth_, elevation_;
  Quantiser fine_azimuth_, fine_elevation_, sent_azimuth_, sent_range_, sent_error_;
  Logarithm deviation_, error_, sent_std_;
};

}  // namespace stg::agent
