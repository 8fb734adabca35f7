#pragma once

#include <memory>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"
#include "acoustic_channel/network/network.hpp"

namespace stg::acoustics {

/// The network of modems behind the interface of decision steps: positions are known at steps, and
/// nodes move on straight lines between; Deliver processes the events between two steps.
class PhysicalChannel : public Channel {
 public:
  /// Throws UserError for names in the section that do not exist.
  PhysicalChannel(const ChannelConfig& config, const RunConfig& run, LineOfSight line_of_sight);

  void Reset(std::uint64_t seed, std::uint32_t episode) override;
  void Observe(PacketObserver* observer) override { network_.Observe(observer); }
  void SetPresent(int node, bool present) override;
  bool continuous() const override { return true; }
  int nodes() const override { return network_.nodes(); }
  std::size_t max_payload() const override { return network_.max_payload(); }
  bool Due(int node, TimeNs t) override { return turns_.Due(node, t); }
  void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
            const std::vector<Vec3<double>>& v_W,
            const std::vector<Transmission>& offered) override;
  void Deliver(int receiver, TimeNs until, std::vector<Reception>* out) override;
  LinkStatistics Link(int source, int destination, TimeNs now) const override;
  const ChannelTotals& totals() const override { return network_.totals(); }
  void Ping(int source, int destination, TimeNs t, TimeNs timeout, std::uint32_t tag) override;
  double EnergyJ(int node, TimeNs now) const override { return network_.EnergyJ(node, now); }
  double SentS(int node, TimeNs now) const override { return network_.SentS(node, now); }

 private:
  Network network_;
  Turns turns_;
  double freshness_s_;
  bool started_ = false, changed_ = false;
  TimeNs stepped_ = 0;         ///< time of the last step
  std::vector<char> present_;  ///< [nodes], as from the next step on
};

std::unique_ptr<PropagationModel> MakePhysicalModel(const ChannelConfig& config);

}  // namespace stg::acoustics
