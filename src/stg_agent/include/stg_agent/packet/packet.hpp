#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/packet/measurement_packet.hpp"
#include "stg_agent/packet/neighbour_state.hpp"
#include "stg_agent/packet/quantiser.hpp"

/// The 32-byte form of NeighbourState on the acoustic link.
namespace stg::agent {

/// A quantity sent as an integer code: values lo + code * resolution, code in [0, steps].
///
/// bits = ceil(log2((hi - lo) / resolution + 1)). Symmetric fields use an even number of steps,
/// so that zero is exact; the decoder refuses the spare code.
struct PacketField {
  const char* name;
  int bits;
  double lo, hi, resolution;
};

/// Bounded binary codec for NeighbourState. Every packet has kPacketBytes bytes.
///
/// Layout kEstimate, least significant bit first: version 4, source 8, generation 16 (1 ms, modulo
/// 65.536 s), position 3 x 15, velocity 3 x 12, confidence 7, tracking error 14, phase 2, link
/// quality 7, saturated 1, has_target 1, target 6, target age 15 (1 ms, to 32.767 s), target
/// position 3 x 15, target velocity 3 x 11, target deviation 8 (logarithmic), CRC-8 8. Ranges
/// follow the scenario: positions 1.25 workspace half extents, speeds the vehicle's limit plus
/// the current, target speeds twice the target's limit, tracking error the workspace diagonal,
/// target deviation 1e-5 to 10 half extents. Decoded values are within half the resolution (of
/// the logarithm for the deviation; half a millisecond for both times) unless `saturated`.
///
/// Layout kMeasurements: see MeasurementPacket.
///
/// The checksum (polynomial 0x1D) finds every damage of one or two bits and every burst of up to
/// eight bits; it misses other damage once in 256 times.
class PacketCodec {
 public:
  /// Throws UserError when the scenario does not fit the layout (more than 256 AUVs, 64 targets).
  explicit PacketCodec(const AgentModel& model, PacketLayout layout = PacketLayout::kEstimate);

  /// A non-finite value, a negative generation time or an index out of range is a bug of the
  /// caller and throws std::invalid_argument. Allocates nothing otherwise.
  Packet Encode(const NeighbourState& state) const;

  /// `now` is the receiver's clock; the generation time is the latest possible one up to `now`.
  /// Throws UserError for a wrong size, version, checksum or index, an unused code, or a later
  /// time.
  /// @param near assumed position of the sender. With a localizer, positions are sent modulo the
  /// region; the decoder takes the one nearest to `near`
  NeighbourState Decode(const std::uint8_t* data, std::size_t size, TimeNs now,
                        const Vec3<double>& near = {}) const;
  /// The source in a packet's header.
  static int SourceOf(const std::uint8_t* data, std::size_t size);

  static constexpr int kFieldCount = 8;
  /// Ranges and resolutions: position, velocity, confidence, tracking_error, link_quality,
  /// target_position, target_velocity, log_target_std (natural logarithm of metres).
  std::array<PacketField, kFieldCount> fields() const;

 private:
  Packet EncodeEstimate(const NeighbourState& state) const;
  NeighbourState DecodeEstimate(const std::uint8_t* data, std::size_t size, TimeNs now) const;

  PacketLayout layout_;
  int agents_, targets_;
  bool free_;  // targets are chosen freely
  Quantiser position_, velocity_, unit_, error_, target_velocity_, log_std_;
  std::array<double, 256> std_of_code_{};  ///< exp(log_std_) for every code
  MeasurementPacket measurements_;
};

}  // namespace stg::agent
