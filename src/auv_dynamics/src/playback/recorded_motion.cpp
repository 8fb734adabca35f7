#include "auv_dynamics/playback/recorded_motion.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"
#include "auv_dynamics/vehicle/torpedo.hpp"

namespace stg::dynamics {
namespace {

constexpr std::uintmax_t kLargestFile = 64U << 20;
constexpr double kDay_s = 86400.0;
constexpr double kDegree = kPi / 180.0;
constexpr char kHeader[] = "rpm,rudder_deg,stern_deg,Vc,beta_deg,t,x,y,z,phi,theta,psi,u,v,w,p,q,r";
constexpr std::size_t kCommandCells = 5, kCells = kCommandCells + 1 + kMotionColumns;
/// Largest magnitudes of the command's cells, the time and the state's cells. A larger number means
/// damage, and computations with it could overflow. Angles may exceed a full turn.
constexpr double kLargest[kCells] = {1e5, 90.0, 90.0, 100.0, 3600.0, kDay_s, 1e7, 1e7, 1e7,
                                     1e4, 1e4,  1e4,  1e3,   1e3,    1e3,    1e3, 1e3, 1e3};

using Cells = std::array<double, kCells>;

[[noreturn]] void Refuse(const std::string& file, int line, const std::string& what) {
  throw UserError(file + ":" + std::to_string(line) + ": " + what);
}

/// Name of a cell, from the header.
std::string CellName(std::size_t cell) {
  std::string rest = kHeader;
  for (; cell > 0; --cell) rest = rest.substr(rest.find(',') + 1);
  return rest.substr(0, rest.find(','));
}

Cells Parse(const std::string& file, int number, const std::string& line) {
  Cells cells{};
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t k = 0; k < kCells; ++k) {
    const auto [next, error] = std::from_chars(at, end, cells[k]);
    if (error != std::errc() || !std::isfinite(cells[k])) {
      Refuse(file, number, "column " + CellName(k) + ": expected a finite number");
    }
    const bool last = k + 1 == kCells;
    if (last ? next != end : next == end || *next != ',') {
      Refuse(file, number,
             last ? "more cells than the header has columns"
                  : "after column " + CellName(k) + ": expected a comma");
    }
    at = last ? next : next + 1;
    if (std::abs(cells[k]) > kLargest[k]) {
      Refuse(file, number, "column " + CellName(k) + ": out of range");
    }
  }
  if (cells[kCommandCells] < 0.0) {
    Refuse(file, number, "column t: a time before the command is not allowed");
  }
  return cells;
}

bool SameCommand(const RecordedMotion& m, const Cells& c) {
  return m.rpm == c[0] && m.rudder_deg == c[1] && m.stern_deg == c[2] && m.current_mps == c[3] &&
         m.current_towards_deg == c[4];
}

/// The state in the file's frames. World and body are both turned by half a turn around x.
std::array<double, kMotionColumns> StateOf(const VehicleState<double>& s) {
  const Vec3<double> rpy = RpyOf(s.trig);
  return {s.p_WB.x,   -s.p_WB.y,   -s.p_WB.z,   rpy.x,      -rpy.y,      -rpy.z,
          s.v_WB_B.x, -s.v_WB_B.y, -s.v_WB_B.z, s.w_WB_B.x, -s.w_WB_B.y, -s.w_WB_B.z};
}

double DistanceRun(const RecordedMotion& motion) {
  double run = 0.0;
  Vec3<double> before;
  for (const MotionRow& row : motion.rows) {
    const Vec3<double> at{row.state[kX], row.state[kY], row.state[kZ]};
    run += Norm(at - before);
    before = at;
  }
  return run;
}

/// Simulates one vehicle.
class Flight {
 public:
  Flight(const VehicleConfig& vehicle, const RecordedMotion& motion, double dt_s)
      : vehicle_(vehicle), model_(vehicle.torpedo), dt_s_(dt_s) {
    const double beta = motion.current_towards_deg * kDegree;
    v_WC_ = {motion.current_mps * std::cos(beta), -motion.current_mps * std::sin(beta), 0.0};
    command_ = model_.Limit(TorpedoActuators<double>{motion.rpm, motion.rudder_deg * kDegree,
                                                     motion.stern_deg * kDegree});
    state_.trig = TrigOf(state_.rpy);
    state_.R_WB = RotationOf(state_.trig);
  }

  const VehicleState<double>& FlyTo(double time_s) {
    const double left = time_s - now_;
    const int steps = static_cast<int>(std::ceil(left / dt_s_ - 1e-9));
    for (int k = 0; k < steps; ++k) {
      Integrate(model_, vehicle_, command_, Wrench<double>(), v_WC_, left / steps, &state_,
                &actuators_);
    }
    now_ = time_s;
    return state_;
  }

 private:
  const VehicleConfig& vehicle_;
  TorpedoModel model_;
  double dt_s_, now_ = 0.0;
  Vec3<double> v_WC_;
  TorpedoActuators<double> command_, actuators_;
  VehicleState<double> state_;
};

}  // namespace

const char* NameOf(MotionColumn column) {
  static const char* const names[kMotionColumns] = {"x", "y", "z", "phi", "theta", "psi",
                                                    "u", "v", "w", "p",   "q",     "r"};
  return names[column];
}

std::vector<RecordedMotion> LoadMotions(const std::string& file) {
  std::ifstream in = OpenText(file, kLargestFile);
  std::vector<RecordedMotion> motions;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line != kHeader) Refuse(file, 1, std::string("expected the header ") + kHeader);
      continue;
    }
    if (line.empty() && in.peek() == std::ifstream::traits_type::eof()) break;
    const Cells cells = Parse(file, number, line);
    const double time_s = cells[kCommandCells];
    if (motions.empty() || !SameCommand(motions.back(), cells) ||
        time_s <= motions.back().rows.back().time_s) {
      motions.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], {}});
    }
    MotionRow row;
    row.line = number;
    row.time_s = time_s;
    std::copy(cells.end() - kMotionColumns, cells.end(), row.state.begin());
    motions.back().rows.push_back(row);
  }
  if (motions.empty()) throw UserError(file + ": contains no motion");
  return motions;
}

double MotionError::Column::share() const {
  if (max_abs_error == 0.0) return 0.0;
  return max_abs_error / (hi - lo);
}

bool MotionError::Within(double tolerance) const {
  bool within = position_share <= tolerance;
  for (int c = kPhi; c < kMotionColumns; ++c) {
    within = within && columns[static_cast<std::size_t>(c)].share() <= tolerance;
  }
  return within;
}

MotionError Compare(const VehicleConfig& vehicle, const std::vector<RecordedMotion>& motions,
                    double dt_s) {
  MotionError result;
  for (const RecordedMotion& motion : motions) {
    Flight flight(vehicle, motion, dt_s);
    const double run = DistanceRun(motion);
    for (const MotionRow& row : motion.rows) {
      const auto ours = StateOf(flight.FlyTo(row.time_s));
      for (std::size_t c = 0; c < kMotionColumns; ++c) {
        MotionError::Column& column = result.columns[c];
        const double recorded = row.state[c];
        double error = ours[c] - recorded;
        if (c == kPhi || c == kTheta || c == kPsi) error = WrapAngle(error);
        // Zero is in the range, because every column starts there.
        column.lo = std::min(column.lo, recorded);
        column.hi = std::max(column.hi, recorded);
        if (!(std::abs(error) <= column.max_abs_error)) {
          column.max_abs_error = std::abs(error);
          column.motion = result.motions;
          column.line = row.line;
        }
      }
      const Vec3<double> miss{ours[kX] - row.state[kX], ours[kY] - row.state[kY],
                              ours[kZ] - row.state[kZ]};
      const double share = Norm(miss) > 0.0 ? Norm(miss) / run : 0.0;
      if (!(share <= result.position_share)) {
        result.position_share = share;
        result.position_line = row.line;
      }
      ++result.rows;
    }
    ++result.motions;
  }
  return result;
}

}  // namespace stg::dynamics
