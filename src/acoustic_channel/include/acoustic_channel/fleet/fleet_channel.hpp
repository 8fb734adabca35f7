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

/// How long a fleet's channel waits for what may still come in, in the time of the stamps.
struct FleetPatience {
  double lag_s = 0.1;           ///< for anything
  double odometry_s = 1.0;      ///< for the next word of a vehicle that is there
  double silent_after_s = 3.0;  ///< a vehicle that has said nothing for this long is not there
  /// False: the velocities that vehicles tell say nothing; differences of positions count.
  bool has_velocity = true;
};

/// A fleet's channel reports to it what happens. Times of packets count from the start of the run.
class FleetListener : public PacketObserver {
 public:
  /// A run begins; `start` is its time 0 in the time of the stamps [ns].
  virtual void OnBegin(TimeNs start) = 0;
  /// What one vehicle received in a step, at least one packet, oldest first; payloads are valid
  /// during the call.
  virtual void OnReceptions(int vehicle, const std::vector<Reception>& received) = 0;
  /// A packet that was taken by Offer never reached its modem, as its vehicle is not there.
  virtual void OnAbsent(const Transmission& packet) = 0;
  /// A ping that could not be asked.
  virtual void OnPingRefused(std::uint32_t tag, const std::string& why) = 0;
};

/// A channel for vehicles that are not kept in step: motion and packets come in as they do, each
/// with its stamp; a clock tells how late it is. Steps are closed on a fixed grid of stamps, each
/// when all that counts for it is in. What comes out is a function of the stamps, and not of the
/// order or the moment in which they came in, as long as they come within the patience.
///
/// Stamps and clock in nanoseconds, from any common zero; nodes are vehicles, by index. Not
/// thread-safe.
class FleetChannel {
 public:
  enum class Word {
    kCounts,
    kRepeated,  ///< there is one of that stamp
    kLate,      ///< the steps around it are closed
  };

  /// Throws UserError for names in the section that do not exist.
  /// @param network with the number of vehicles, the length of a step and the seed
  /// @param listener must live as long as this object
  FleetChannel(const NetworkConfig& network, const FleetPatience& patience,
               FleetListener* listener);

  /// Forgets everything: the next word begins a run. With the same words it is the same run.
  void Restart();

  /// Numbers must be finite.
  Word Move(int vehicle, TimeNs stamp, const Motion& motion);
  /// Throws UserError that says why the modem would never take the packet, or that too many wait.
  /// `kLate`: it is offered now instead. Where the model has no modems, one packet of a vehicle
  /// leaves in a step: the newest, and the others of the step are discarded (kQueue).
  Word Offer(const Transmission& packet);
  /// See Channel::Ping; asked at the next step. The listener hears how it ends.
  void Ping(int source, int destination, TimeNs timeout, std::uint32_t tag);

  /// Closes all steps for which everything is in, or has been waited for, at the time `now`.
  void Run(TimeNs now) { CloseUntil(Settled(now)); }
  /// Nothing more will come in: closes the steps up to the newest word.
  void Finish();

  /// A step has been closed in this run.
  bool begun() const { return begun_; }
  /// Of the last closed step; meaningless before.
  TimeNs closed() const { return closed_; }
  /// Time 0 of the channel; meaningless before.
  TimeNs start() const { return start_; }
  bool present(int vehicle) const { return present_[static_cast<std::size_t>(vehicle)]; }
  bool heard_of(int vehicle) const { return track(vehicle).newest().has_value(); }
  const Channel& channel() const { return *channel_; }
  int vehicles() const { return static_cast<int>(tracks_.size()); }

 private:
  struct Offered {
    Transmission packet;  ///< with the stamps of the outside
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
  TimeNs first_ = -1;  ///< earliest word of a run that has not begun
  TimeNs start_ = 0, closed_ = 0, next_ = 0;
  std::vector<bool> present_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<Offered> sending_;
  std::vector<Transmission> offers_;
  std::vector<Reception> received_;
};

}  // namespace stg::acoustics
