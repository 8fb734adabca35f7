#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "auv_dynamics/simd.hpp"
#include "auv_dynamics/types.hpp"

/// A scenario: everything a run depends on besides a seed and a policy.
///
/// One plain struct for all packages, filled by the strict loader in
/// scenario_yaml.hpp. Lengths are in one consistent unit, read as metres (the
/// paper's tables label it kilometres); time is in seconds; body axes are FLU,
/// the world is ENU.
namespace stg {

/// What agents decide on: everybody's true state (the release's way), or their own sensing and
/// what the channel brings.
enum class InformationMode { kTruth, kAcoustic };
/// How the equations of motion are stepped; the release's is semi-implicit Euler.
enum class Integrator { kSemiImplicit, kRk4 };
/// Added-mass part of C(nu); the rigid-body part is always there.
enum class AddedMassCoriolis { kFull, kNoMunk, kOff };
/// How a target moves on its own, before walls turn it back.
enum class TargetMotion { kConstantVelocity, kCoordinatedTurn, kRandomWaypoint, kEvasive };
/// What a policy commands: velocity per world axis, or force and torque per body axis.
enum class ActionInterface { kVelocity3, kTau6 };
/// Desired yaw: none, or along the desired velocity.
enum class HeadingMode { kFree, kAlongVelocity };
/// Which neighbours fill the slots of the observation, and in which order.
enum class NeighbourOrder { kNearest, kIndex };
/// The link: all within R_c (Eq. 5), Eq. 6 with loss and delay, or a later physical model.
enum class ChannelModel { kRange, kExtended, kPhysical };
/// The reward as the paper writes it (Eqs. 28-36), as the release computes it, and the release's
/// for its baselines without a task graph.
enum class RewardKind { kPaper, kRelease, kReleaseRaw };
/// Stages of the curriculum: how far out and how fast targets start.
enum class ResetStage { kEasy, kMedium, kHard };

/// Closed; what is drawn from it is uniform.
struct Interval {
  double lo = 0.0, hi = 0.0;
};

/// Clocks of physics, decisions and episodes.
struct TimeConfig {
  double dt_s = 0.1;                ///< physics step
  int decision_steps = 1;           ///< physics steps per decision
  int episode_steps = 500;          ///< decisions per episode (paper: T)
  int tail_steps = 100;             ///< last decisions that count for tail metrics
};

/// Vehicle constants in Fossen's notation; Table S2. Six-component arrays are
/// ordered surge, sway, heave, roll, pitch, yaw.
struct VehicleConfig {
  std::string profile = "remus100";
  double mass_kg = 31.9;
  std::array<double, 3> inertia_kgm2{0.16, 4.10, 4.10};
  std::array<double, 6> added_mass{-2.0, -35.0, -35.0, -0.12, -4.5, -4.5};
  std::array<double, 6> linear_damping{4.0, 8.0, 10.0, 0.8, 3.0, 2.5};
  std::array<double, 6> quadratic_damping{18.0, 30.0, 35.0, 0.25, 1.2, 1.0};
  std::array<double, 3> r_BG_m{0.0, 0.0, 0.0};   ///< centre of gravity from the body origin
  std::array<double, 3> r_BB_m{0.0, 0.0, 0.02};  ///< centre of buoyancy from the body origin
  double weight_n = 312.939;
  double buoyancy_n = 312.939;
  AddedMassCoriolis added_mass_coriolis = AddedMassCoriolis::kNoMunk;
  bool reversed_coriolis = false;    ///< the release's sign error: C(nu) nu enters negated
  bool restoring = true;
  std::array<double, 3> max_velocity_mps{1.5, 0.5, 0.5};
  std::array<double, 3> max_rate_radps{1.2, 1.2, 1.2};
  bool clip_velocity = true;         ///< clip body velocity and rates to the limits
  std::array<double, 6> max_tau{35.0, 20.0, 20.0, 8.0, 10.0, 10.0};
  bool float32_tau = false;          ///< round force and torque to float32 (release)
  Integrator integrator = Integrator::kRk4;
  int substeps = 1;                  ///< integrator steps per physics step
  double radius_m = 0.011;           ///< collision radius
};

/// Water current; the hull forces of Eq. 3 act on the velocity relative to it.
struct CurrentConfig {
  std::array<double, 3> velocity_mps{0.0, 0.0, 0.0};  ///< world frame, irrotational
};

/// First-order Gauss-Markov disturbance w of Eq. 3, body axes.
struct DisturbanceConfig {
  double force_std_n = 0.0;
  double moment_std_nm = 0.0;
  double correlation_time_s = 2.0;
};

/// Repulsion between vehicles: stiffness * softness * softplus((2 radius - distance) / softness).
struct ContactConfig {
  double stiffness = 100.0;          ///< [N per m of softplus argument]
  double softness_m = 0.001;
};

/// The box and what is left of a velocity that meets a wall: its normal and tangential world
/// components, and the body velocity and rates of the vehicle.
struct WorkspaceConfig {
  double half_extent_m = 1.0;        ///< walls at +-half_extent on each axis
  double restitution = 0.2;
  double tangential = 0.85;
  double body_velocity = 0.7;
  double body_rate = 0.8;
};

/// Targets and how they move.
struct TargetConfig {
  int count = 1;
  TargetMotion motion = TargetMotion::kConstantVelocity;
  double max_speed_mps = 0.05;
  double max_turn_rate_radps = 0.5;
  double turn_rate_radps = 0.1;      ///< coordinated_turn: mean magnitude
  double turn_period_s = 10.0;       ///< coordinated_turn: time between new turn rates
  double waypoint_radius_m = 0.05;   ///< random_waypoint: arrival radius
  double evasion_range_m = 0.10;     ///< evasive: flees AUVs closer than this
};

/// Where and how fast an episode starts.
struct ResetStageConfig {
  Interval target_radius_m{0.25, 0.55};
  Interval auv_distance_m{0.25, 0.45};
  Interval target_speed_mps{0.003, 0.008};
};

/// How episodes start; stages are in the order easy, medium, hard.
struct ResetConfig {
  ResetStage stage = ResetStage::kMedium;   ///< evaluation and fixed training
  bool curriculum = false;                  ///< training: easy, medium, hard by reset count
  int curriculum_easy_resets = 800;
  int curriculum_medium_resets = 2000;
  double min_separation_m = 0.10;
  double start_half_extent_m = 0.9;
  std::array<ResetStageConfig, 3> stages{{
      {{0.05, 0.20}, {0.08, 0.20}, {0.001, 0.004}},
      {{0.25, 0.55}, {0.25, 0.45}, {0.003, 0.008}},
      {{0.45, 0.75}, {0.40, 0.70}, {0.006, 0.014}},
  }};
};

/// The agents' own target sensor.
struct SensingConfig {
  double range_m = 0.45;             ///< R_s: detection range and confidence scale (Eq. 13)
  double noise_std_m = 0.0;          ///< per component
  double detection_probability = 1.0;
  double dropout_rate_hz = 0.0;      ///< rate at which the sensor goes blind
  double dropout_duration_s = 1.0;   ///< mean duration of a blind spell
  double cue_std_m = 0.05;           ///< uncertainty of the initial datum, per component
};

/// From a policy's action to force and torque, Eqs. 23-27.
struct ControlConfig {
  ActionInterface interface = ActionInterface::kVelocity3;
  double action_scale = 0.75;        ///< of the policy mean
  double max_delta = 0.35;           ///< rate limit per decision; 0: none
  double smoothing = 0.20;           ///< alpha of Eq. 27; 0: none
  double velocity_gain = 1.0;        ///< K_v = gain * tau_max / v_max (Eq. 24)
  double attitude_gain = 0.12;       ///< K_eta (Eq. 25), of the maximum moment per rad
  double rate_gain = 0.10;           ///< K_omega (Eq. 25), of the maximum moment per max rate
  HeadingMode heading = HeadingMode::kFree;
  double heading_gain = 0.12;        ///< along_velocity: of the maximum moment per rad
};

/// The acoustic channel and the link quality of Eqs. 5-6.
struct ChannelConfig {
  ChannelModel model = ChannelModel::kExtended;
  double range_m = 0.45;             ///< R_c of Eq. 5
  double transmit_period_s = 0.5;    ///< every agent sends one packet per period, staggered
  double sound_speed_mps = 1500.0;
  // Eq. 6
  double max_range_m = 3.5;          ///< extended: nothing arrives beyond
  double attenuation_per_m = 0.5;    ///< alpha
  double loss_probability = 0.10;    ///< at zero distance
  double loss_distance_m = 2.0;      ///< p_loss(d) = 1 - (1 - p0) exp(-(d / loss_distance)^2)
  double freshness_s = 2.0;          ///< tau_f
};

/// The agents' target filter and their memory of neighbours.
struct TrackConfig {
  double process_accel_std_mps2 = 0.01;   ///< white acceleration of the target model
  double measurement_std_m = 0.001;       ///< floor of a detection's standard deviation
  double initial_speed_std_mps = 0.01;
  double gate_sigma = 5.0;                ///< own detections beyond it are set aside, three in a row restart
  double lost_std_m = 0.2;                ///< track no better than this counts as lost
  double neighbour_max_age_s = 10.0;      ///< a neighbour is forgotten after this silence
};

/// Constants of the observation that the paper leaves open (release's values).
struct ObservationConfig {
  bool tracking = true;              ///< Eq. 14, 8 numbers
  bool semantic = true;              ///< Eqs. 15-16, 9 numbers
  bool graph = true;                 ///< Eq. 18, 6 numbers
  NeighbourOrder order = NeighbourOrder::kNearest;
  /// Truth mode only. As the release: the progress shown is always 0 (d(t-1) is
  /// overwritten first), so is the first P of an episode; mean_k(e) counts the
  /// current error twice; lost steps read one too many.
  bool release_bookkeeping = false;
  double distance_scale_m = 1.2;
  double error_scale_m = 0.8;
  double progress_scale_m = 0.04;
  double closing_scale_mps = 0.08;
  int error_window = 5;              ///< k of mean_k(e)
  double lost_scale_steps = 25.0;
  double near_range_m = 0.10;
  double quality_high = 0.75;
  double quality_medium = 0.40;
  double link_available = 0.10;      ///< q above this is an effective neighbour
  double link_radius_m = 0.45;       ///< R_c of Eq. 5 in the graph features
  double role_confidence = 0.40;
};

/// Weights of the terms of Eq. 36, and of our separation term.
struct RewardWeights {
  double tracking = 0.72, observation = 0.16, coordination = 0.02, communication = 0.01,
         semantic = 0.09, control_cost = 0.08, separation = 0.0;
};

/// Constants of the reward, Eqs. 28-36, and of our separation term.
struct RewardConfig {
  RewardKind kind = RewardKind::kPaper;
  RewardWeights weights;
  double desired_distance_m = 0.015;   ///< d*
  Interval band_m{0.010, 0.015};       ///< [d_l, d_u]
  double error_max_m = 0.8;            ///< e_max
  double lost_distance_m = 0.65;
  double w_band = 0.35, w_progress = 0.30, w_closing = 0.15, w_reacquire = 0.20,
         w_too_close = 0.20;           ///< Eq. 30
  double separation_distance_m = 0.024;  ///< separation reward: 0 beyond, -1 at contact centres
  double total_limit = 2.0;
};

/// All of a scenario.
struct Scenario {
  std::string name = "medium";
  std::uint64_t seed = 0;
  int agents = 4;
  InformationMode mode = InformationMode::kAcoustic;
  TimeConfig time;
  VehicleConfig vehicle;
  CurrentConfig current;
  DisturbanceConfig disturbance;
  ContactConfig contact;
  WorkspaceConfig workspace;
  TargetConfig target;
  ResetConfig reset;
  SensingConfig sensing;
  ControlConfig control;
  ChannelConfig channel;
  TrackConfig track;
  ObservationConfig observation;
  RewardConfig reward;

  /// Throws UserError naming the key when a value is out of range or two keys
  /// contradict each other.
  void ValidateOrThrow() const;

  double decision_dt_s() const { return time.dt_s * time.decision_steps; }
  /// The same times in whole nanoseconds, in which stamps are counted: they never drift.
  TimeNs step_period() const { return static_cast<TimeNs>(std::llround(time.dt_s * 1e9)); }
  TimeNs decision_period() const { return step_period() * time.decision_steps; }
  /// Target that agent i is tasked with: i modulo the number of targets.
  int target_of(int agent) const { return agent % target.count; }
  int action_size() const { return control.interface == ActionInterface::kVelocity3 ? 3 : 6; }
  int observation_size() const {
    return 51 + (observation.tracking ? 8 : 0) + (observation.semantic ? 9 : 0) +
           (observation.graph ? 6 : 0);
  }
};

}  // namespace stg
