#pragma once

#include <array>
#include <string>
#include <vector>

#include "auv_dynamics/vehicle/vehicle_config.hpp"

/// Motions of a torpedo that another simulator or a trial recorded, to check ours against.
namespace stg::dynamics {

/// What a row tells of the vehicle, in the file's frames: NED world, FRD body, SI, radians.
enum MotionColumn { kX, kY, kZ, kPhi, kTheta, kPsi, kU, kV, kW, kP, kQ, kR, kMotionColumns };
/// "x", "y", "z", "phi" ... as the file's header has them.
const char* NameOf(MotionColumn column);

struct MotionRow {
  int line = 0;         ///< in the file, 1-based
  double time_s = 0.0;  ///< since the command was given
  std::array<double, kMotionColumns> state{};
};

/// From rest at the origin, with actuators at zero, under one command that is held.
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

/// How far ours is from the recorded motions.
struct MotionError {
  struct Column {
    double max_abs_error = 0.0;
    double lo = 0.0, hi = 0.0;  ///< of the recorded values
    int motion = 0;             ///< where the error is largest, 0-based, and its line
    int line = 0;
    /// The error as a share of the range; 0 where there is no error at all.
    double share() const;
  };
  std::array<Column, kMotionColumns> columns;
  /// Largest distance between ours and the recorded position, each as a share of the distance that
  /// its motion runs, along straight lines between its rows and through the origin.
  double position_share = 0.0;
  int position_line = 0;
  int motions = 0, rows = 0;

  /// Position by the distance run, all but x, y, z by their range.
  bool Within(double tolerance) const;
};

/// Flies the motions with `vehicle.model: torpedo` in physics steps of at most dt_s, shorter ones
/// before a row, and compares every row. Angles are compared on the circle.
MotionError Compare(const VehicleConfig& vehicle, const std::vector<RecordedMotion>& motions,
                    double dt_s);

}  // namespace stg::dynamics
