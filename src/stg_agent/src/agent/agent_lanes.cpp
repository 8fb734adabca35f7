#include "stg_agent/agent/agent_lanes.hpp"

#include <cstring>
#include <stdexcept>

namespace stg::agent {
namespace {

/// One lane of a structure of numbers that is a template over their type.
template <template <class> class S>
S<double> LaneOf(const S<Pack>& packs, int lane) {
  static_assert(sizeof(S<Pack>) == sizeof(S<double>) * kLanes, "all members are numbers");
  constexpr std::size_t kCount = sizeof(S<double>) / sizeof(double);
  const char* from =
      reinterpret_cast<const char*>(&packs) + sizeof(double) * static_cast<std::size_t>(lane);
  double numbers[kCount];
  for (std::size_t k = 0; k < kCount; ++k) {
    std::memcpy(&numbers[k], from + k * sizeof(Pack), sizeof(double));
  }
  S<double> out;
  std::memcpy(&out, numbers, sizeof(out));
  return out;
}

/// Zero in every lane whose numbers are all finite.
Pack Finiteness(const Vec3<Pack>& v) { return (v.x - v.x) + (v.y - v.y) + (v.z - v.z); }

bool AnyNonZero(const Pack& a) { return Any(!(a == Pack(0.0))); }

}  // namespace

AgentLanes::AgentLanes(const Agent& first, int id)
    : reports_(static_cast<std::size_t>(first.scenario().agents)),
      age_s_(reports_.size(), Pack(0.0)),
      mind_(first.scenario()) {
  agents_.reserve(kLanes);
  // Not plain copies: those would lose the memory that an agent reserves.
  for (int lane = 0; lane < kLanes; ++lane) agents_.emplace_back(first, id);
}

void AgentLanes::Reset(int lane, std::uint32_t episode, const dynamics::Cue& cue) {
  At(lane).Reset(episode, cue);
  for (Report& r : reports_) SetLane(&r.known, lane, 0.0);
  mind_.Reset();  // of all lanes: each of them starts
}

void AgentLanes::Receive(int lane, const acoustics::Reception& reception) {
  const NeighbourState* state = At(lane).Take(reception);
  if (!state) return;
  Report& r = reports_[static_cast<std::size_t>(state->source)];
  SetLane(&r.p_W, lane, state->p_W);
  SetLane(&r.v_W, lane, state->v_W);
  SetLane(&r.generation_ns, lane, static_cast<double>(state->generation));
  SetLane(&r.tracking_error, lane, state->tracking_error);
  SetLane(&r.known, lane, 1.0);
}

void AgentLanes::Observe(const dynamics::Navigation<Pack>& nav) {
  Pack finite = Finiteness(nav.p_WB) + Finiteness(nav.v_WB_B) + Finiteness(nav.w_WB_B);
  for (const Pack& q : nav.q_WB) finite += q - q;
  if (AnyNonZero(finite)) throw std::invalid_argument("non-finite navigation state");
  const Pack now(static_cast<double>(nav.stamp)), zero(0.0);
  const Pack oldest(scenario().track.neighbour_max_age_s);
  for (std::size_t j = 0; j < reports_.size(); ++j) {
    // Whole nanoseconds below 2^53 are exact.
    age_s_[j] = Max((now - reports_[j].generation_ns) * Pack(1e-9), zero);
    const Mask<Pack> past = (age_s_[j] > oldest) && (reports_[j].known > zero);
    if (Any(past)) Forget(past, nav);
  }
  for (Agent& a : agents_) {
    a.Begin(nav.stamp);
    a.UpdateTrack();
  }
  const TargetView<Pack> target = SeeTarget();
  mind_.SetNavigation(nav);
  mind_.SetTracking(scenario(), target, agents_.front().step());
  mind_.SetNeighbours(scenario(), SeeNeighbours(target.p_WT));
}

void AgentLanes::Forget(const Mask<Pack>& past, const dynamics::Navigation<Pack>& nav) {
  const Pack gone = Select(past, Pack(1.0), Pack(0.0));
  for (int lane = 0; lane < kLanes; ++lane) {
    if (Lane(gone, lane) == 0.0) continue;
    NeighbourTable& table = At(lane).neighbours_;
    table.Predict(nav.stamp, Lane(nav.p_WB, lane));
    for (std::size_t j = 0; j < reports_.size(); ++j) {
      SetLane(&reports_[j].known, lane, table.at(static_cast<int>(j)).known ? 1.0 : 0.0);
    }
  }
}

TargetView<Pack> AgentLanes::SeeTarget() const {
  alignas(Pack::arch_type::alignment()) double view[9][kLanes];
  for (std::size_t lane = 0; lane < agents_.size(); ++lane) {
    const Agent& a = agents_[lane];
    const TargetEstimate& e = a.track_.estimate();
    const double column[9] = {e.p_WT.x,
                              e.p_WT.y,
                              e.p_WT.z,
                              e.v_WT.x,
                              e.v_WT.y,
                              e.v_WT.z,
                              e.pp,
                              a.track_.started() ? 1.0 : 0.0,
                              a.Current() ? 1.0 : 0.0};
    for (int k = 0; k < 9; ++k) view[k][lane] = column[k];
  }
  const auto at = [&view](int k) { return Pack::load_aligned(view[k]); };
  return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, at(6), at(7), at(8)};
}

NeighbourView<Pack> AgentLanes::SeeNeighbours(const Vec3<Pack>& p_WT) const {
  const AgentConfig& s = scenario();
  const Pack zero(0.0), nowhere(1e9);
  const bool nearest = s.observation.order == NeighbourOrder::kNearest;
  const int self = agents_.front().id();
  const acoustics::LinkEstimator& links = agents_.front().neighbours_.links();
  NeighbourView<Pack> view;
  int slot = 0;
  for (int j = 0; j < s.agents; ++j) {
    if (j == self) continue;
    const auto uj = static_cast<std::size_t>(j);
    const Report& n = reports_[uj];
    const Mask<Pack> known = n.known > zero;
    const Vec3<Pack> p_WN = DeadReckon(n.p_W, n.v_W, age_s_[uj], s.workspace.half_extent_m);
    const Vec3<Pack> r = p_WN - mind_.knowledge.p_WB;
    const Pack d = Norm(r);
    view.Add(s.observation, known, p_WN, p_WT, links.Quality(d, age_s_[uj]), n.tracking_error);
    if (nearest) {
      view.nearest.Offer(r, Select(known, d, nowhere));
    } else if (slot < kNeighbourSlots) {
      view.nearest.offset[slot++] = Select<Pack>(known, r, Vec3<Pack>());
    }
  }
  return view;
}

void AgentLanes::Act(const Pack* action) {
  Pack finite(0.0);
  for (int k = 0; k < scenario().action_size(); ++k) finite += action[k] - action[k];
  if (AnyNonZero(finite)) throw std::invalid_argument("non-finite action");
  mind_.Act(scenario(), action);
}

Packet AgentLanes::MakePacket(int lane) {
  Agent& a = At(lane);
  a.mind_.knowledge = LaneOf<Knowledge>(mind_.knowledge, lane);
  return a.MakePacket();
}

const Agent& AgentLanes::agent(int lane) {
  Agent& a = At(lane);
  a.mind_.knowledge = LaneOf<Knowledge>(mind_.knowledge, lane);
  for (std::size_t k = 0; k < 6; ++k) a.mind_.action[k] = Lane(mind_.action[k], lane);
  a.neighbours_.Predict(a.now_, a.knowledge().p_WB);
  return a;
}

}  // namespace stg::agent
