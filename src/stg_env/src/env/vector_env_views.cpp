#include "auv_common/numbers/lane_structs.hpp"
#include "environment.hpp"
#include "sources/acoustic_source.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::env {

int VectorEnv::step(int env) const { return SliceOf(env).lanes->task().steps(lane_of(env)); }

std::uint64_t VectorEnv::seed(int env) const {
  return SliceOf(env).lanes->world().seed(lane_of(env));
}

TimeNs VectorEnv::time(int env) const { return SliceOf(env).lanes->world().time(lane_of(env)); }

dynamics::NavState VectorEnv::nav(int env, int i) const {
  return SliceOf(env).lanes->world().Truth(lane_of(env), i);
}

dynamics::NavState VectorEnv::navigation(int env, int i) const {
  return SliceOf(env).lanes->world().Nav(lane_of(env), i);
}

dynamics::VehicleState<double> VectorEnv::vehicle(int env, int i) const {
  return LaneOf(SliceOf(env).lanes->world().vehicle(i), lane_of(env));
}

bool VectorEnv::Sense(int env, int i, int k, dynamics::Detection* detection) const {
  return SliceOf(env).lanes->world().Sense(lane_of(env), i, k, detection);
}

dynamics::TargetState<double> VectorEnv::target(int env, int k) const {
  return LaneOf(SliceOf(env).lanes->world().target(k), lane_of(env));
}

task::Tracking<double> VectorEnv::tracking(int env, int i) const {
  return LaneOf(SliceOf(env).lanes->task().tracking(i), lane_of(env));
}

int VectorEnv::followed(int env, int i) const {
  return SliceOf(env).lanes->followed(lane_of(env), i);
}

bool VectorEnv::present(int env, int i) const {
  return scenario(env).agent.fleet.present(i, Seconds(time(env)));
}

task::RewardTerms<double> VectorEnv::terms(int env, int i) const {
  return LaneOf(SliceOf(env).lanes->task().terms(i), lane_of(env));
}

agent::Knowledge<double> VectorEnv::knowledge(int env, int i) const {
  return LaneOf(SliceOf(env).lanes->knowledge(i), lane_of(env));
}

agent::AgentView VectorEnv::agent(int env, int i) const {
  return SliceOf(env).lanes->acoustic().agent(i).view(lane_of(env));
}

const acoustics::Channel& VectorEnv::channel(int env) const {
  return SliceOf(env).lanes->acoustic().channel(lane_of(env));
}

void VectorEnv::ObservePackets(int env, acoustics::PacketObserver* observer) {
  SliceOf(env).lanes->acoustic().ObservePackets(lane_of(env), observer);
}

}  // namespace stg::env
