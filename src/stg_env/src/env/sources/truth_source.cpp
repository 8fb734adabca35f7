#include "truth_source.hpp"

#include <algorithm>

#include "acoustic_channel/models/range.hpp"

namespace stg::env {

TruthSource::TruthSource(const agent::AgentModel& model, double range_m)
    : model_(model),
      range_m_(range_m),
      exact_angles_(model.vehicle.integrator == dynamics::Integrator::kSemiImplicit),
      minds_(static_cast<std::size_t>(model.run.agents),
             agent::Mind<Pack>(model, agent::Bookkeeping::kTruth)),
      before_(minds_),
      links_(minds_.size()) {}

void TruthSource::Start(const dynamics::World&, const LaneSet& lanes) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!lanes[lane]) continue;
    for (agent::Mind<Pack>& mind : minds_) mind.Reset(lane);
  }
}

void TruthSource::Observe(const dynamics::World& world, const LaneSet& lanes) {
  if (lanes.all()) {
    Think(world);
    return;
  }
  before_ = minds_;
  Think(world);
  const Mask<Pack> mask = lanes.mask();
  for (std::size_t i = 0; i < minds_.size(); ++i) minds_[i].KeepOthers(mask, before_[i]);
}

void TruthSource::Act(const dynamics::World& world, int i, const Pack* wanted,
                      task::Effort<Pack>* action, task::Effort<Pack>* tau) {
  agent::Mind<Pack>& mind = minds_[static_cast<std::size_t>(i)];
  const dynamics::VehicleState<Pack>& v = world.vehicle(i);
  mind.Act(model_, wanted, [&] { return exact_angles_ ? v.rpy : RpyOf(v.trig); });
  *action = mind.action;
  const Pack* t = mind.knowledge.tau;
  *tau = {t[0], t[1], t[2], t[3], t[4], t[5]};  // std::copy would be a call, which costs more
}

void TruthSource::Think(const dynamics::World& world) {
  const Pack zero(0.0), one(1.0);
  Pack total_error = zero, nearest(1e9);
  for (int i = 0; i < model_.run.agents; ++i) {
    agent::Mind<Pack>& mind = minds_[static_cast<std::size_t>(i)];
    const dynamics::TargetState<Pack>& t = world.target(model_.target.of(i));
    mind.SetNavigation(world.vehicle(i));
    mind.SetTracking(model_, {t.p_WT, t.v_WT, zero, one, one});
    total_error += mind.knowledge.error;
    nearest = Min(nearest, mind.knowledge.distance);
  }
  MeasureLinks(world);
  for (int i = 0; i < model_.run.agents; ++i) {
    agent::Mind<Pack>& mind = minds_[static_cast<std::size_t>(i)];
    agent::NeighbourView<Pack>& s = links_[static_cast<std::size_t>(i)];
    const agent::Knowledge<Pack>& k = mind.knowledge;
    s.mean_error = model_.run.agents > 1
                       ? (total_error - k.error) * Pack(1.0 / (model_.run.agents - 1))
                       : k.error;
    s.closest = Select(k.distance <= nearest, one, zero);
    Show(world, i, s.offset);
    mind.SetNeighbours(model_, s);
  }
}

void TruthSource::MeasureLinks(const dynamics::World& world) {
  const Pack zero(0.0), one(1.0), available(model_.observation.link_available);
  for (agent::NeighbourView<Pack>& s : links_) s.quality = s.best = s.effective = zero;
  // Handles each pair once. Every AUV adds its neighbours in the order of their numbers.
  for (int i = 0; i < model_.run.agents; ++i) {
    for (int j = i + 1; j < model_.run.agents; ++j) {
      const Pack q = acoustics::RangeQuality(world.distance(i, j), model_.channel.range_m);
      const Pack counts = Select(q > available, one, zero);
      for (const int end : {i, j}) {
        agent::NeighbourView<Pack>& s = links_[static_cast<std::size_t>(end)];
        s.quality += q;
        s.best = Max(s.best, q);
        s.effective += counts;
      }
    }
  }
}

void TruthSource::Show(const dynamics::World& world, int i, Vec3<Pack>* slots) const {
  const Vec3<Pack>& p_WB = world.vehicle(i).p_WB;
  if (model_.observation.order == agent::NeighbourOrder::kIndex) {
    for (int j = 0, slot = 0; j < model_.run.agents && slot < agent::kNeighbourSlots; ++j) {
      if (j != i) slots[slot++] = world.vehicle(j).p_WB - p_WB;
    }
    return;
  }
  agent::NearestSlots<Pack> nearest;
  for (int j = 0; j < model_.run.agents; ++j) {
    if (j != i) nearest.Offer(world.vehicle(j).p_WB - p_WB, world.distance(i, j));
  }
  std::copy(nearest.offset, nearest.offset + agent::kNeighbourSlots, slots);
}

Pack TruthSource::LinkQuality(const dynamics::World& world) const {
  // Mean of q (Eq. 5) over the existing edges.
  const Pack zero(0.0), one(1.0);
  Pack sum = zero, edges = zero;
  for (int i = 0; i < model_.run.agents; ++i) {
    for (int j = i + 1; j < model_.run.agents; ++j) {
      const Pack q = acoustics::RangeQuality(world.distance(i, j), range_m_);
      sum += q;
      edges += Select(q > zero, one, zero);
    }
  }
  return sum / Max(edges, one);
}

void TruthSource::Tell(const dynamics::World& world, int i, task::FieldState<Pack>* f) const {
  f->known = Pack(1.0);
  f->p_WT = world.target(model_.target.of(i)).p_WT;
  f->r_BT_W = f->p_WT - world.vehicle(i).p_WB;
}

}  // namespace stg::env
