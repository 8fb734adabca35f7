#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/fleet/motion_track.hpp"

namespace stg::acoustics {

/// How long a fleet's channel waits for input, in the time of the stamps.
struct FleetPatience {
  double lag_s = 0.1;           ///< for anything
  double odometry_s = 1.0;      ///< for the next odometry of a present vehicle
  double silent_after_s = 3.0;  ///< a vehicle without odometry for this time is absent
  /// False: ignore the vehicles' velocities, and use differences of their positions.
  bool has_velocity = true;
};

/// Callbacks of a fleet's channel. Times of packets count from the start of the run.
class FleetListener : public PacketObserver {
 public:
  /// A run begins; `start` is its time 0 in the time of the stamps [ns].
  virtual void OnBegin(TimeNs start) = 0;
  /// The packets that a vehicle received in a step, at least one, oldest first; payloads are valid
  /// during the call.
  virtual void OnReceptions(int vehicle, const std::vector<Reception>& received) = 0;
  /// A packet that Offer took did not reach its modem, because its vehicle is absent.
  virtual void OnAbsent(const Transmission& packet) = 0;
  /// A ping that could not be requested.
  virtual void OnPingRefused(std::uint32_t tag, const std::string& why) = 0;
};

/// A channel for vehicles that are not synchronised: motion and packets come at any time, each with
/// its stamp, and a clock gives the present time. Steps are closed on a fixed grid of stamps, each
/// when all its input is complete. The output is a function of the stamps alone, not of the order
/// or time of arrival, if all input comes within the patience.
///
/// Stamps and clock in nanoseconds, from any common zero; nodes are vehicles, by index. Not
/// thread-safe.
class FleetChannel {
 public:
  enum class Word {
    kCounts,
    kRepeated,  ///< there is one with that stamp already
    kLate,      ///< the steps around it are closed
  };

  /// Throws UserError for names in the section that do not exist.
  /// @param network with the number of vehicles, the length of a step and the seed
  /// @param listener must live as long as this object
  FleetChannel(const NetworkConfig& network, const FleetPatience& patience,
               FleetListener* listener);

  /// Clears everything: the next input begins a run. The same input gives the same run.
  void Restart();

  /// Numbers must be finite.
  Word Move(int vehicle, TimeNs stamp, const Motion& motion);
  /// Throws UserError with the reason if the modem would never take the packet, or if too many
  /// packets wait. `kLate`: the packet is offered now. In a model without modems, one packet of a
  /// vehicle leaves in a step, the newest; the others of the step are discarded (kQueue).
  Word Offer(const Transmission& packet);
  /// See Channel::Ping; requested at the next step. The listener gets the result.
  void Ping(int source, int destination, TimeNs timeout, std::uint32_t tag);

  /// Closes all steps whose input is complete, or whose waiting time is over, at the time `now`.
  void Run(TimeNs now) { CloseUntil(Settled(now)); }
  /// Ends the input: closes the steps up to the newest stamp.
  void Finish();

  /// A step has been closed in this run.
  bool begun() const { return begun_; }
  /// Time of the last closed step; undefined before.
  TimeNs closed() const { return closed_; }
  /// Time 0 of the channel; undefined before.
  TimeNs start() const { return start_; }
  bool present(int vehicle) const { return present_[static_cast<std::size_t>(vehicle)]; }
  bool heard_of(int vehicle) const { return track(vehicle).newest().has_value(); }
  const Channel& channel() const { return *channel_; }
  int vehicles() const { return static_cast<int>(tracks_.size()); }

 private:
  struct Offered {
    Transmission packet;  ///< with the stamps of the caller
    std::vector<std::uint8_t> bytes;
  };
  struct Asked {
    int source, destination;
    TimeNs timeout;
    std::uint32_t tag;
  };
  const MotionTrack& track(int vehicle) const { return tracks_[static_cast<std::size_t>(vehicle)]; }
  TimeNs Settled(TimeNs now) const;
  void CloseUntil(TimeNs until);
  void Begin();
  void Close();
  void Ask(TimeNs now);
  void Place();
  void Collect();
  void Discard(const Offered& offered) const;
  void Hand(const Offered& offered);

  TimeNs period_, lag_, patience_, silent_after_;
  std::uint64_t seed_;
  std::unique_ptr<Channel> channel_;
  FleetListener* listener_;
  std::vector<MotionTrack> tracks_;
  std::vector<std::deque<Offered>> waiting_;  ///< [vehicles] for the step of their stamp
  std::vector<Asked> asked_;
  bool begun_ = false;
  TimeNs first_ = -1;  ///< earliest stamp of a run that has not begun
  TimeNs start_ = 0, closed_ = 0, next_ = 0;
  std::vector<bool> present_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<Offered> sending_;
  std::vector<Transmission> offers_;
  std::vector<Reception> received_;
};

}  // namespace stg::acoustics
