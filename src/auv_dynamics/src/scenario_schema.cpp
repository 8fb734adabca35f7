#include "scenario_schema.hpp"

#include <array>
#include <utility>

namespace stg {
namespace {

Limits Positive(double hi) { return {0.0, hi, true}; }
Limits NonNegative(double hi) { return {0.0, hi, false}; }
Limits Within(double lo, double hi) { return {lo, hi, false}; }
constexpr Limits kFraction{0.0, 1.0, false};
constexpr Limits kNone{};

template <class E>
EnumRef Enum(E* value, std::vector<std::string> names) {
  return {std::move(names), [value] { return static_cast<int>(*value); },
          [value](int index) { *value = static_cast<E>(index); }};
}

template <std::size_t N>
NumbersRef Numbers(std::array<double, N>* values) {
  return {values->data(), static_cast<int>(N)};
}

/// Collects fields under a section prefix.
class Table {
 public:
  void Section(const std::string& prefix) { prefix_ = prefix; }
  void Add(const std::string& key, ValueRef value, Limits limits, const std::string& unit,
           const std::string& meaning) {
    fields_.push_back({prefix_ + key, std::move(value), limits, unit, meaning});
  }
  std::vector<ScenarioField> Take() { return std::move(fields_); }

 private:
  std::string prefix_;
  std::vector<ScenarioField> fields_;
};

void AddTop(Table* t, Scenario* s) {
  t->Section("");
  t->Add("name", &s->name, kNone, "-", "label of the scenario in results");
  t->Add("seed", &s->seed, kNone, "-", "seed of all random numbers unless a program is given one");
  t->Add("agents", &s->agents, Within(1, 255), "-", "number of AUVs N");
  t->Add("mode", Enum(&s->mode, {"truth", "acoustic"}), kNone, "-",
         "what agents know: true states, or own sensors and received packets");
}

void AddTime(Table* t, TimeConfig* c) {
  t->Section("time.");
  t->Add("dt_s", &c->dt_s, Within(1e-4, 1.0), "s", "physics step, a whole number of nanoseconds");
  t->Add("decision_steps", &c->decision_steps, Within(1, 1000), "physics steps",
         "length of one decision");
  t->Add("episode_steps", &c->episode_steps, Within(1, 1e6), "decisions", "episode length T");
  t->Add("tail_steps", &c->tail_steps, Within(1, 1e6), "decisions",
         "last decisions of an episode that count for tail metrics");
}

void AddVehicle(Table* t, VehicleConfig* c) {
  const std::string axes = "surge sway heave roll pitch yaw";
  t->Section("vehicle.");
  t->Add("profile", &c->profile, kNone, "-", "label of this set of vehicle constants");
  t->Add("mass_kg", &c->mass_kg, Positive(1e6), "kg", "mass m");
  t->Add("inertia_kgm2", Numbers(&c->inertia_kgm2), Positive(1e8), "kg m^2, body",
         "moments of inertia Ix Iy Iz");
  t->Add("added_mass", Numbers(&c->added_mass), Within(-1e8, 0.0), "kg, kg m^2, body",
         "added-mass derivatives in Fossen's sign, " + axes);
  t->Add("linear_damping", Numbers(&c->linear_damping), NonNegative(1e6), "N s/m, N m s/rad, body",
         "linear damping magnitudes, " + axes);
  t->Add("quadratic_damping", Numbers(&c->quadratic_damping), NonNegative(1e6),
         "N s^2/m^2, N m s^2/rad^2, body", "quadratic damping magnitudes, " + axes);
  t->Add("r_BG_m", Numbers(&c->r_BG_m), Within(-100, 100), "m, body FLU",
         "centre of gravity from the body origin");
  t->Add("r_BB_m", Numbers(&c->r_BB_m), Within(-100, 100), "m, body FLU",
         "centre of buoyancy from the body origin");
  t->Add("weight_n", &c->weight_n, NonNegative(1e7), "N", "weight W");
  t->Add("buoyancy_n", &c->buoyancy_n, NonNegative(1e7), "N", "buoyancy B");
  t->Add("added_mass_coriolis", Enum(&c->added_mass_coriolis, {"full", "no_munk", "off"}), kNone,
         "-", "added-mass part of C(nu): whole, without the Munk moment, or none");
  t->Add("reversed_coriolis", &c->reversed_coriolis, kNone, "-",
         "C(nu) nu enters with the wrong sign, an error of the release that its traces hold");
  t->Add("restoring", &c->restoring, kNone, "-", "weight, buoyancy and righting moment act");
  t->Add("max_velocity_mps", Numbers(&c->max_velocity_mps), Positive(100), "m/s, body",
         "largest u v w; scales actions and observations");
  t->Add("max_rate_radps", Numbers(&c->max_rate_radps), Positive(100), "rad/s, body",
         "largest p q r; scales the controller and observations");
  t->Add("clip_velocity", &c->clip_velocity, kNone, "-",
         "clip body velocity and rates to these limits after every step");
  t->Add("max_tau", Numbers(&c->max_tau), Positive(1e6), "N, N m, body",
         "actuator limits, " + axes);
  t->Add("float32_tau", &c->float32_tau, kNone, "-",
         "round the commanded force and torque to float32, as the release does");
  t->Add("integrator", Enum(&c->integrator, {"semi_implicit", "rk4"}), kNone, "-",
         "time integration: the release's step, or Runge-Kutta of order 4");
  t->Add("substeps", &c->substeps, Within(1, 1000), "-", "integrator steps per physics step");
  t->Add("radius_m", &c->radius_m, Positive(100), "m", "collision radius of one AUV");
}

void AddSurroundings(Table* t, Scenario* s) {
  t->Section("current.");
  t->Add("velocity_mps", Numbers(&s->current.velocity_mps), Within(-10, 10), "m/s, world ENU",
         "constant, irrotational water current");
  t->Section("disturbance.");
  t->Add("force_std_n", &s->disturbance.force_std_n, NonNegative(1e5), "N, body",
         "standard deviation of each force component of w in Eq. 3; 0: none");
  t->Add("moment_std_nm", &s->disturbance.moment_std_nm, NonNegative(1e5), "N m, body",
         "standard deviation of each moment component of w; 0: none");
  t->Add("correlation_time_s", &s->disturbance.correlation_time_s, Positive(1e5), "s",
         "correlation time of the Gauss-Markov disturbance");
  t->Section("contact.");
  t->Add("stiffness", &s->contact.stiffness, NonNegative(1e7), "N/m",
         "contact force per metre of the softplus overlap; 0: AUVs pass through each other");
  t->Add("softness_m", &s->contact.softness_m, Positive(1), "m",
         "length over which the contact force sets in");
  WorkspaceConfig* w = &s->workspace;
  t->Section("workspace.");
  t->Add("half_extent_m", &w->half_extent_m, Positive(1e5), "m, world ENU",
         "walls at +- this value on each axis");
  t->Add("restitution", &w->restitution, kFraction, "-",
         "kept share of the velocity component normal to a wall");
  t->Add("tangential", &w->tangential, kFraction, "-",
         "kept share of the velocity components along a wall");
  t->Add("body_velocity", &w->body_velocity, kFraction, "-",
         "kept share of the body velocity at a wall");
  t->Add("body_rate", &w->body_rate, kFraction, "-", "kept share of the body rates at a wall");
}

void AddTarget(Table* t, TargetConfig* c) {
  t->Section("target.");
  t->Add("count", &c->count, Within(1, 16), "-",
         "number of targets; AUV i is tasked with target i modulo this");
  t->Add("motion",
         Enum(&c->motion, {"constant_velocity", "coordinated_turn", "random_waypoint", "evasive"}),
         kNone, "-", "motion of the targets");
  t->Add("max_speed_mps", &c->max_speed_mps, Positive(10), "m/s", "no target is faster");
  t->Add("max_turn_rate_radps", &c->max_turn_rate_radps, Positive(10), "rad/s",
         "no target turns faster, walls apart");
  t->Add("turn_rate_radps", &c->turn_rate_radps, NonNegative(10), "rad/s",
         "coordinated_turn: mean magnitude of the turn rate");
  t->Add("turn_period_s", &c->turn_period_s, Positive(1e5), "s",
         "coordinated_turn: time between new turn rates");
  t->Add("waypoint_radius_m", &c->waypoint_radius_m, Positive(1e4), "m",
         "random_waypoint: distance at which a waypoint counts as reached");
  t->Add("evasion_range_m", &c->evasion_range_m, NonNegative(1e4), "m",
         "evasive: the target flees AUVs closer than this");
}

void AddReset(Table* t, ResetConfig* c) {
  t->Section("reset.");
  t->Add("stage", Enum(&c->stage, {"easy", "medium", "hard"}), kNone, "-",
         "reset stage of evaluation and of training without a curriculum");
  t->Add("curriculum", &c->curriculum, kNone, "-",
         "training draws the stage from the number of resets: easy, medium, then hard");
  t->Add("curriculum_easy_resets", &c->curriculum_easy_resets, NonNegative(1e9), "resets",
         "curriculum: resets up to this number are easy");
  t->Add("curriculum_medium_resets", &c->curriculum_medium_resets, NonNegative(1e9), "resets",
         "curriculum: resets up to this number are medium, later ones hard");
  t->Add("min_separation_m", &c->min_separation_m, NonNegative(1e4), "m",
         "AUVs start at least this far from each other");
  t->Add("start_half_extent_m", &c->start_half_extent_m, Positive(1e5), "m, world ENU",
         "AUVs start within +- this value on each axis");
  const char* names[] = {"easy", "medium", "hard"};
  for (std::size_t i = 0; i < c->stages.size(); ++i) {
    t->Section(std::string("reset.stages.") + names[i] + ".");
    t->Add("target_radius_m", &c->stages[i].target_radius_m, NonNegative(1e5), "m",
           "[low, high] distance of a target from the origin of the world");
    t->Add("auv_distance_m", &c->stages[i].auv_distance_m, NonNegative(1e5), "m",
           "[low, high] distance of an AUV from its target");
    t->Add("target_speed_mps", &c->stages[i].target_speed_mps, NonNegative(10), "m/s",
           "[low, high] speed of a target, in a uniformly drawn direction");
  }
}

void AddSensing(Table* t, SensingConfig* c) {
  t->Section("sensing.");
  t->Add("range_m", &c->range_m, Positive(1e5), "m",
         "R_s: detection range, and scale of the confidence of Eq. 13");
  t->Add("noise_std_m", &c->noise_std_m, NonNegative(1e4), "m, world ENU",
         "standard deviation of each component of a detection");
  t->Add("detection_probability", &c->detection_probability, kFraction, "-",
         "chance of a detection per decision within range");
  t->Add("dropout_rate_hz", &c->dropout_rate_hz, NonNegative(1e3), "Hz",
         "rate at which a sensor goes blind; 0: never");
  t->Add("dropout_duration_s", &c->dropout_duration_s, Positive(1e5), "s",
         "mean duration of a blind spell");
  t->Add("cue_std_m", &c->cue_std_m, NonNegative(1e4), "m, world ENU",
         "acoustic mode: standard deviation of each component of the initial datum");
}

void AddControl(Table* t, ControlConfig* c) {
  t->Section("control.");
  t->Add("interface", Enum(&c->interface, {"velocity3", "tau6"}), kNone, "-",
         "action: desired world velocity (3), or body force and moment (6)");
  t->Add("action_scale", &c->action_scale, Within(0.0, 1.0), "-",
         "the policy's mean is this times its tanh; 0.18 in the paper's force interface");
  t->Add("max_delta", &c->max_delta, NonNegative(2), "-",
         "velocity3: largest change of an action per decision; 0: no limit");
  t->Add("smoothing", &c->smoothing, Within(0.0, 0.999), "-",
         "velocity3: weight alpha of the previous action in Eq. 27; 0: none");
  t->Add("velocity_gain", &c->velocity_gain, NonNegative(1e3), "-",
         "K_v of Eq. 24, times max_tau / max_velocity_mps");
  t->Add("attitude_gain", &c->attitude_gain, NonNegative(1e3), "1/rad",
         "K_eta of Eq. 25 for roll and pitch, as a share of the largest moment");
  t->Add("rate_gain", &c->rate_gain, NonNegative(1e3), "-",
         "K_omega of Eq. 25, as a share of the largest moment at the largest rate");
  t->Add("heading", Enum(&c->heading, {"free", "along_velocity"}), kNone, "-",
         "yaw: only damped, or the bow points along the commanded velocity");
  t->Add("heading_gain", &c->heading_gain, NonNegative(1e3), "1/rad",
         "along_velocity: gain, as a share of the largest moment");
}

void AddChannel(Table* t, ChannelConfig* c) {
  t->Section("channel.");
  t->Add("model", Enum(&c->model, {"range", "extended", "physical"}), kNone, "-",
         "link model: Eq. 5, Eq. 6, or the acoustic modem");
  t->Add("range_m", &c->range_m, Positive(1e6), "m", "range: R_c of Eq. 5");
  t->Add("transmit_period_s", &c->transmit_period_s, Positive(1e4), "s",
         "every AUV sends one packet per period, staggered; at least one decision");
  t->Add("sound_speed_mps", &c->sound_speed_mps, Within(1.0, 1e5), "m/s",
         "propagation speed of packets");
  t->Add("max_range_m", &c->max_range_m, Positive(1e6), "m",
         "extended: nothing arrives beyond this distance");
  t->Add("attenuation_per_m", &c->attenuation_per_m, NonNegative(1e4), "1/m",
         "extended: alpha of Eq. 6");
  t->Add("loss_probability", &c->loss_probability, kFraction, "-",
         "extended: probability p0 that a packet is lost at zero distance");
  t->Add("loss_distance_m", &c->loss_distance_m, Positive(1e6), "m",
         "extended: scale D of p_loss(d) = 1 - (1 - p0) exp(-(d/D)^2)");
  t->Add("freshness_s", &c->freshness_s, Positive(1e5), "s",
         "extended: decay time tau_f of Eq. 6 with the age of the information");
}

void AddTrack(Table* t, TrackConfig* c) {
  t->Section("track.");
  t->Add("process_accel_std_mps2", &c->process_accel_std_mps2, Positive(100), "m/s^2",
         "acoustic mode: white acceleration of the target model");
  t->Add("measurement_std_m", &c->measurement_std_m, Positive(1e4), "m",
         "smallest standard deviation given to a detection");
  t->Add("initial_speed_std_mps", &c->initial_speed_std_mps, Positive(100), "m/s",
         "standard deviation of each velocity component of a new track");
  t->Add("gate_sigma", &c->gate_sigma, Positive(1e3), "-",
         "own detections farther off are set aside, three in a row restart the track");
  t->Add("lost_std_m", &c->lost_std_m, Positive(1e4), "m",
         "a track whose position is no better than this counts as lost");
  t->Add("neighbour_max_age_s", &c->neighbour_max_age_s, Positive(1e5), "s",
         "a neighbour is forgotten after this silence");
}

void AddObservation(Table* t, ObservationConfig* c) {
  t->Section("observation.");
  t->Add("tracking", &c->tracking, kNone, "-", "include the 8 tracking numbers of Eq. 14");
  t->Add("semantic", &c->semantic, kNone, "-", "include the 9 semantic numbers of Eqs. 15-16");
  t->Add("graph", &c->graph, kNone, "-", "include the 6 task-graph numbers of Eq. 18");
  t->Add("order", Enum(&c->order, {"nearest", "index"}), kNone, "-",
         "which three neighbours are shown: the nearest, or the first by index");
  t->Add("release_bookkeeping", &c->release_bookkeeping, kNone, "-",
         "truth mode, as the release: shown progress and first P are 0, mean error counts the current "
         "one twice, lost steps read one too many");
  t->Add("distance_scale_m", &c->distance_scale_m, Positive(1e5), "m",
         "target distance that reads 1");
  t->Add("error_scale_m", &c->error_scale_m, Positive(1e5), "m", "tracking error that reads 1");
  t->Add("progress_scale_m", &c->progress_scale_m, Positive(1e4), "m",
         "approach in one decision that reads 1");
  t->Add("closing_scale_mps", &c->closing_scale_mps, Positive(100), "m/s",
         "closing speed that reads 1");
  t->Add("error_window", &c->error_window, Within(1, 64), "decisions",
         "length k of the running mean of the tracking error");
  t->Add("lost_scale_steps", &c->lost_scale_steps, Positive(1e6), "decisions",
         "consecutive lost decisions that read 1");
  t->Add("near_range_m", &c->near_range_m, NonNegative(1e5), "m",
         "closer to the target than this, an approach counts as stable");
  t->Add("quality_high", &c->quality_high, kFraction, "-", "confidence from here on is high");
  t->Add("quality_medium", &c->quality_medium, kFraction, "-",
         "confidence from here on is medium, below it low");
  t->Add("link_available", &c->link_available, kFraction, "-",
         "a link quality above this makes an effective neighbour");
  t->Add("link_radius_m", &c->link_radius_m, Positive(1e5), "m",
         "truth mode: R_c of Eq. 5 in the graph features");
  t->Add("role_confidence", &c->role_confidence, kFraction, "-",
         "confidence from which an AUV with an advantage takes the tracking role");
}

void AddReward(Table* t, RewardConfig* c) {
  t->Section("reward.");
  t->Add("kind", Enum(&c->kind, {"paper", "release", "release_raw"}), kNone, "-",
         "Eqs. 28-36, the release's reward, or that of its raw baselines");
  t->Section("reward.weights.");
  RewardWeights* w = &c->weights;
  t->Add("tracking", &w->tracking, NonNegative(1e3), "-", "weight of the tracking term");
  t->Add("observation", &w->observation, NonNegative(1e3), "-", "weight of the observation term");
  t->Add("coordination", &w->coordination, NonNegative(1e3), "-",
         "weight of the coordination term");
  t->Add("communication", &w->communication, NonNegative(1e3), "-",
         "weight of the communication term");
  t->Add("semantic", &w->semantic, NonNegative(1e3), "-", "weight of the semantic term");
  t->Add("control_cost", &w->control_cost, NonNegative(1e3), "-",
         "weight of the control cost, which is subtracted");
  t->Add("separation", &w->separation, NonNegative(1e3), "-",
         "weight of the penalty for closeness to another AUV; 0 in the paper");
  t->Section("reward.");
  t->Add("desired_distance_m", &c->desired_distance_m, NonNegative(1e4), "m",
         "desired distance d* from the target");
  t->Add("band_m", &c->band_m, Positive(1e4), "m", "[d_l, d_u]: tracking band");
  t->Add("error_max_m", &c->error_max_m, Positive(1e5), "m", "e_max: error that earns nothing");
  t->Add("lost_distance_m", &c->lost_distance_m, Positive(1e5), "m",
         "farther from the target than this, it counts as lost");
  t->Add("w_band", &c->w_band, NonNegative(1e3), "-", "Eq. 30: weight of the band term");
  t->Add("w_progress", &c->w_progress, NonNegative(1e3), "-", "Eq. 30: weight of progress");
  t->Add("w_closing", &c->w_closing, NonNegative(1e3), "-", "Eq. 30: weight of closing speed");
  t->Add("w_reacquire", &c->w_reacquire, NonNegative(1e3), "-", "Eq. 30: weight of reacquisition");
  t->Add("w_too_close", &c->w_too_close, NonNegative(1e3), "-",
         "Eq. 30: weight of the penalty inside d_l");
  t->Add("separation_distance_m", &c->separation_distance_m, Positive(1e4), "m",
         "separation penalty: none beyond this distance of two AUVs");
  t->Add("total_limit", &c->total_limit, Positive(1e6), "-",
         "an agent's total reward is clipped to +- this value");
}

}  // namespace

std::vector<ScenarioField> ScenarioFields(Scenario* scenario) {
  Table table;
  AddTop(&table, scenario);
  AddTime(&table, &scenario->time);
  AddVehicle(&table, &scenario->vehicle);
  AddSurroundings(&table, scenario);
  AddTarget(&table, &scenario->target);
  AddReset(&table, &scenario->reset);
  AddSensing(&table, &scenario->sensing);
  AddControl(&table, &scenario->control);
  AddChannel(&table, &scenario->channel);
  AddTrack(&table, &scenario->track);
  AddObservation(&table, &scenario->observation);
  AddReward(&table, &scenario->reward);
  return table.Take();
}

}  // namespace stg
