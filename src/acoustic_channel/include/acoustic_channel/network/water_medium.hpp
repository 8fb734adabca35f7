#pragma once

#include <memory>

#include "acoustic_channel/network/medium.hpp"
#include "acoustic_channel/network/physical_config.hpp"
#include "acoustic_channel/propagation/bursts.hpp"
#include "acoustic_channel/propagation/fading.hpp"
#include "acoustic_channel/propagation/propagation.hpp"

namespace stg::acoustics {

/// The water of the sections `channel.physical.water`, `.noise` and `.propagation`.
class WaterMedium : public Medium {
 public:
  WaterMedium(const PhysicalConfig& config, int nodes, LineOfSight line_of_sight = {});

  void Reset(std::uint64_t seed, std::uint32_t episode) override;
  Hearing Hear(const PacketKey& key, const NodeMotion& source, const NodeMotion& receiver,
               const ModemProfile& sender) override;
  NoiseSpan Noise(int node, TimeNs t, double speed_mps, const ModemProfile& receiver) override;
  Hearing Expect(const NodeMotion& source, const NodeMotion& receiver,
                 const ModemProfile& sender) const override;
  double SoundSpeed(const Vec3<double>& p_W) const override;

 private:
  Hearing Steady(const PathSum& paths, const ModemProfile& sender) const;

  double surface_z_m_, shadow_db_;
  Propagation propagation_;
  NoiseModel noise_;
  Shadowing shadowing_;
  Bursts bursts_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
};

}  // namespace stg::acoustics
