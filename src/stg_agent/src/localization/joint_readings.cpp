#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "joint_row.hpp"
#include "stg_agent/localization/joint_filter.hpp"

/// The readings of the joint filter: for each kind, its row of the states and its update.
namespace stg::agent {
namespace {

/// At a smaller horizontal distance a bearing has no information.
constexpr double kLeastLevel_m = 5.0;

}  // namespace

void JointFilter::AddError(int id, int axis, double weight, double age_s, Row* row) const {
  if (IsAnchor(id)) {
    row->Add(AnchorAt(id) + axis, weight);
    return;
  }
  const int slot = SlotOf(id);
  if (slot < 0) return;
  row->Add(ErrorAt(slot) + axis, weight);
  if (age_s == 0.0 || !observers_[static_cast<std::size_t>(slot)].adrift) return;
  row->Add(ShearAt(slot) + axis, weight * age_s);
  row->Add(CurrentAt() + axis, weight * age_s);
}

void JointFilter::AddClock(int id, double weight, double age_s, Row* row) const {
  const int clock = ClockAt(id);
  if (clock < 0) return;
  row->Add(clock, weight);
  if (age_s != 0.0) row->Add(clock + 1, -weight * age_s);
}

double JointFilter::Mean(const Row& row) const {
  double sum = 0.0;
  for (int k = 0; k < row.count; ++k) {
    sum += row.value[static_cast<std::size_t>(k)] *
           x_[static_cast<std::size_t>(row.index[static_cast<std::size_t>(k)])];
  }
  return sum;
}

/// Computes P times the row as a column. Returns row P column.
double JointFilter::Column(const Row& row, double* column) const {
  std::fill_n(column, n_, 0.0);
  for (int k = 0; k < row.count; ++k) {
    const double v = row.value[static_cast<std::size_t>(k)];
    const double* p = P_.data() + row.index[static_cast<std::size_t>(k)] * n_;
    for (int c = 0; c < n_; ++c) column[c] += v * p[c];
  }
  double sum = 0.0;
  for (int k = 0; k < row.count; ++k) {
    sum += row.value[static_cast<std::size_t>(k)] * column[row.index[static_cast<std::size_t>(k)]];
  }
  return sum;
}

void JointFilter::Offset(int to, int from, const Vec3<double>& sent, double age_s,
                         double (&offset)[2]) const {
  for (int axis = 0; axis < 2; ++axis) {
    Row error;
    AddError(to, axis, 1.0, age_s, &error);
    AddError(from, axis, -1.0, age_s, &error);
    offset[axis] = (axis == 0 ? sent.x : sent.y) - Mean(error);
  }
}

double JointFilter::Wander(double age_s) const {
  return (Squared(config_.current_std_mps) / config_.current_memory_s +
          Squared(config_.shear_std_mps) / config_.shear_memory_s) *
         2.0 * age_s * age_s * age_s / 3.0;
}

/// Uniform between 0 and the most, and the noise of all ranges.
double JointFilter::LateDensity(double innovation, double std_m) const {
  const double scale = 1.0 / (std_m * std::sqrt(2.0)), most = config_.late_max_m;
  return 0.5 * (std::erf(innovation * scale) - std::erf((innovation - most) * scale)) / most;
}

void JointFilter::Update(const double* column, double gain, double less) {
  for (int r = 0; r < n_; ++r) {
    const double f = column[r];
    x_[static_cast<std::size_t>(r)] += gain * f;
    for (int c = 0; c <= r; ++c) {
      const double p = P(r, c) - less * f * column[c];
      P(r, c) = p;
      P(c, r) = p;
    }
  }
}

bool JointFilter::Passes(double innovation, double S) {
  nis_ = innovation * innovation / S;
  return nis_ <= Squared(config_.gate_sigma);
}

bool JointFilter::Apply(const double* column, double innovation, double S) {
  if (!Passes(innovation, S)) return false;
  Update(column, innovation / S, 1.0 / S);
  return true;
}

bool JointFilter::Take(const BearingReading& z) { return TakeAzimuth(z, -1); }

bool JointFilter::Take(const DirectionReading& z) {
  double offset[2];
  Offset(z.source, self_, z.p_source - z.p_receiver, std::max(0.0, Seconds(now_ - z.at)), offset);
  const double level = std::hypot(offset[0], offset[1]);
  if (level < kLeastLevel_m) return false;
  BearingReading azimuth;
  azimuth.receiver = self_;
  azimuth.source = z.source;
  azimuth.at = z.at;
  azimuth.p_receiver = z.p_receiver;
  azimuth.p_source = z.p_source;
  azimuth.azimuth_rad = z.azimuth_rad;
  // The same error across the line of sight is a larger angle in the plane.
  azimuth.std_rad = z.std_rad * std::hypot(level, z.p_source.z - z.p_receiver.z) / level;
  const bool taken = TakeAzimuth(azimuth, HeadingAt(self_));
  return TakeElevation(z) || taken;
}

bool JointFilter::TakeAzimuth(const BearingReading& z, int heading) {
  const double age_s = std::max(0.0, Seconds(now_ - z.at));
  double offset[2];
  Offset(z.source, z.receiver, z.p_source - z.p_receiver, age_s, offset);
  const double level = std::hypot(offset[0], offset[1]);
  if (level < kLeastLevel_m) return false;  // straight above or below there is no bearing
  const double along[2] = {offset[0] / level, offset[1] / level};
  const double across[2] = {-along[1], along[0]};
  Row row, line;
  for (int axis = 0; axis < 2; ++axis) {
    AddError(z.source, axis, -across[axis] / level, age_s, &row);
    AddError(z.receiver, axis, across[axis] / level, age_s, &row);
    AddError(z.source, axis, -along[axis] / level, age_s, &line);
    AddError(z.receiver, axis, along[axis] / level, age_s, &line);
  }
  if (heading >= 0) row.Add(heading, 1.0);
  std::array<double, kMostJointStates> column;
  const double lengthwise = Column(line, column.data());
  const double sidewise = Column(row, column.data());
  // In second order, a bearing depends on the distance.
  const double noise = Squared(z.std_rad) + Wander(age_s) / Squared(level) + lengthwise * sidewise;
  const double S = sidewise + noise;
  const double turned = heading < 0 ? 0.0 : x_[static_cast<std::size_t>(heading)];
  const double innovation = WrapAngle(z.azimuth_rad - turned - std::atan2(offset[1], offset[0]));
  return Apply(column.data(), innovation, S);
}

/// With both depths, the elevation is a measurement of the horizontal distance.
bool JointFilter::TakeElevation(const DirectionReading& z) {
  const double age_s = std::max(0.0, Seconds(now_ - z.at));
  double offset[2];
  Offset(z.source, self_, z.p_source - z.p_receiver, age_s, offset);
  const double level = std::hypot(offset[0], offset[1]), up = z.p_source.z - z.p_receiver.z;
  if (level < kLeastLevel_m) return false;
  const double along[2] = {offset[0] / level, offset[1] / level};
  const double square = level * level + up * up, slope = -up / square;
  Row row, bend;
  for (int axis = 0; axis < 2; ++axis) {
    const double across = axis == 0 ? -along[1] : along[0];
    AddError(z.source, axis, -slope * along[axis], age_s, &row);
    AddError(self_, axis, slope * along[axis], age_s, &row);
    AddError(z.source, axis, across, age_s, &bend);
    AddError(self_, axis, -across, age_s, &bend);
  }
  std::array<double, kMostJointStates> column;
  // Second order, across and along the line.
  const double curved = Column(bend, column.data()) * slope / level;
  const double variance = Column(row, column.data());
  const double steeper = slope == 0.0 ? 0.0 : variance / slope * (-2.0 * level / square);
  const double noise = Squared(z.std_rad) + Squared(slope) * Wander(age_s) +
                       0.5 * (curved * curved + steeper * steeper);
  const double S = variance + noise;
  const double innovation = z.elevation_rad - std::atan2(up, level) - 0.5 * (curved + steeper);
  return Apply(column.data(), innovation, S);
}

bool JointFilter::Take(const RangeReading& z) {
  const double age_s = std::max(0.0, Seconds(now_ - z.at));
  double offset[2];
  Offset(z.receiver, z.source, z.p_receiver - z.p_source, age_s, offset);
  const double dz = z.p_receiver.z - z.p_source.z;
  const double level = std::max(std::hypot(offset[0], offset[1]), 1e-3);
  const double range = std::hypot(level, dz);
  const double u[2] = {offset[0] / range, offset[1] / range};
  const double across[2] = {-offset[1] / level, offset[0] / level};

  Row row, bend;
  for (int axis = 0; axis < 2; ++axis) {
    AddError(z.receiver, axis, -u[axis], age_s, &row);
    AddError(z.source, axis, u[axis], age_s, &row);
    AddError(z.receiver, axis, across[axis], age_s, &bend);
    AddError(z.source, axis, -across[axis], age_s, &bend);
  }
  row.Add(ScaleAt(), range);
  Row ahead;
  AddClock(z.receiver, z.sound_mps / kClockSound_mps, age_s, &ahead);
  AddClock(z.source, -z.sound_mps / kClockSound_mps, age_s, &ahead);
  for (int k = 0; k < ahead.count; ++k) {
    row.Add(ahead.index[static_cast<std::size_t>(k)], ahead.value[static_cast<std::size_t>(k)]);
  }
  std::array<double, kMostJointStates> column;
  const double curved = Column(bend, column.data()) / range;
  // The row does not contain the effect of the currents since then.
  const double noise = Squared(config_.range_std_m) + Wander(age_s) + 0.5 * curved * curved;
  const double S = Column(row, column.data()) + noise;
  const double expected = (1.0 + x_[static_cast<std::size_t>(ScaleAt())]) * range + Mean(ahead);
  const double innovation = z.range_m - expected - 0.5 * curved;
  if (!Passes(innovation, S)) return false;
  // A late sound makes a range longer, by any value up to late_max_m.
  const double first =
      (1.0 - config_.late_share) * std::exp(-0.5 * nis_) / std::sqrt(2.0 * kPi * S);
  const double late = config_.late_share * LateDensity(innovation, std::sqrt(S));
  const double truth = first / (first + late);
  Update(column.data(), truth * innovation / S, (truth - truth * (1.0 - truth) * nis_) / S);
  return true;
}

/// GPS has no outliers here, so a fix is never rejected. So a filter with too small a covariance
/// can recover.
bool JointFilter::Take(const FixReading& z) {
  if (IsAnchor(z.member) || SlotOf(z.member) < 0) return false;
  const double age_s = std::max(0.0, Seconds(now_ - z.at));
  const double noise = Squared(z.std_m) + Wander(age_s);
  nis_ = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    Row row;
    AddError(z.member, axis, 1.0, age_s, &row);
    std::array<double, kMostJointStates> column;
    const double S = Column(row, column.data()) + noise;
    const double innovation = (axis == 0 ? z.error_x : z.error_y) - Mean(row);
    nis_ += 0.5 * innovation * innovation / S;
    Update(column.data(), innovation / S, 1.0 / S);
  }
  return true;
}

}  // namespace stg::agent
