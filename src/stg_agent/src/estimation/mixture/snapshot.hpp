#pragma once

#include "observers.hpp"
#include "surround.hpp"

namespace stg::agent {

/// A detection and the AUV that measured it.
struct Sighting {
  dynamics::Detection detection;
  int source = 0;
  double rivals = 0.0;  ///< of an unlabelled detection, see TargetFilter::Assign
};

/// State of the filter after all sightings up to a time.
struct Snapshot {
  Snapshot(const StateLayout& layout, const DriftModel& drift, int self, int capacity)
      : mixture(layout.own_states(), layout.states(), capacity), observers(layout, drift, self) {}

  /// Forgets everything.
  /// @param no_third time of the last sighting of a third AUV, if there is none
  void Clear(TimeNs no_third) {
    covers = -1;
    stamp = information = mirrored = 0;
    observed = false;
    last.source = other.source = -1;
    third = no_third;
    surround = Surround();
    mixture.Clear();
    observers.Clear();
  }

  TimeNs covers = -1;  ///< contains the sightings up to this time
  TimeNs stamp = 0;    ///< time of the state
  TimeNs information = 0;
  bool observed = false;
  Sighting last;            ///< the newest sighting in it
  Sighting other;           ///< the newest one of another AUV
  TimeNs third = 0;         ///< time of the last one of a third AUV
  Surround surround;        ///< how the observers surround the target
  TimeNs mirrored = 0;      ///< when the mirror image last got some weight
  GaussianMixture mixture;  ///< empty: nothing is known about the target
  Observers observers;
};

}  // namespace stg::agent
