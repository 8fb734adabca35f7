#pragma once

#include <array>
#include <string>
#include <vector>

#include "auv_dynamics/vehicle/vehicle_config.hpp"

/// Motions of a torpedo from another simulator or a trial, for comparison with this simulator.
namespace stg::dynamics {

/// State of the vehicle in a row, in the file's frames: NED world, FRD body, SI, radians.
enum MotionColumn { kX, kY, kZ, kPhi, kTheta, kPsi, kU, kV, kW, kP, kQ, kR, kMotionColumns };
/// Names of the columns, as in the file's header: "x", "y", "z", "phi" ...
const char* NameOf(MotionColumn column);

struct MotionRow {
  int line = 0;         ///< in the file, 1-based
  double time_s = 0.0;  ///< since the command was given
  std::array<double, kMotionColumns> state{};
};

/// A motion from rest at the origin, with actuators at zero, under one constant command.
struct RecordedMotion {
  double rpm = 0.0, rudder_deg = 0.0, stern_deg = 0.0;
  double current_mps = 0.0;          ///< Vc
  double current_towards_deg = 0.0;  ///< beta, clockwise from the x axis (north)
  std::vector<MotionRow> rows;       ///< times increase
};

/// Reads a CSV with the header
///   rpm,rudder_deg,stern_deg,Vc,beta_deg,t,x,y,z,phi,theta,psi,u,v,w,p,q,r
/// Rows of the same command whose times increase are one motion; a new command, or a time that does
/// not increase, begins the next. Throws UserError with file and line for anything else than finite
/// numbers in every cell, for commands no vehicle has (beyond 1e5 rpm, 90 deg or 100 m/s), for
/// times below zero or past a day, and for files without rows or larger than 64 MiB.
std::vector<RecordedMotion> LoadMotions(const std::string& file);

/// Errors of this simulator against the recorded motions.
struct MotionError {
  struct Column {
    double max_abs_error = 0.0;
    double lo = 0.0, hi = 0.0;  ///< of the recorded values
    int motion = 0;             ///< motion of the largest error, 0-based, and its line
    int line = 0;
    /// The error as a share of the range; 0 without an error.
    double share() const;
  };
  std::array<Column, kMotionColumns> columns;
  /// Largest distance between simulated and recorded position, as a share of the length of its
  /// motion, along straight lines from the origin through its rows.
  double position_share = 0.0;
  int position_line = 0;
  int motions = 0, rows = 0;

  /// Position by the distance run, all but x, y, z by their range.
  bool Within(double tolerance) const;
};

/// Simulates the motions with `vehicle.model: torpedo` in physics steps of at most dt_s, shorter
/// ones before a row, and compares every row. Differences of angles are taken on the circle.
MotionError Compare(const VehicleConfig& vehicle, const std::vector<RecordedMotion>& motions,
                    double dt_s);

}  // namespace stg::dynamics
