#include "stg_env/env/unread_keys.hpp"

#include <optional>

#include "auv_common/error.hpp"
#include "stg_agent/controllers/idle.hpp"
#include "stg_agent/controllers/pursuit.hpp"
#include "stg_agent/controllers/search_laws.hpp"
#include "stg_agent/graph/observation_config.hpp"

namespace stg::env {
namespace {

/// What decides, as far as it matters for the numbers that it reads.
struct Reader {
  std::string name;
  bool observes = false;   ///< a policy over the observation
  bool entities = false;   ///< a policy over entities
  bool law = false;        ///< a built-in controller
  bool searches = false;   ///< a law that reads the search map
  bool keeps_off = false;  ///< a law that keeps its depth and keeps off charted obstacles
  bool walls = false;      ///< a law that keeps off the walls
};

Reader ReaderOf(const agent::Decider& decider) {
  Reader r;
  r.name = "'" + decider.name + "'";
  r.observes = decider.observes();
  r.entities = decider.entities != nullptr;
  const agent::Controller* const law = decider.builtin.get();
  r.law = law != nullptr;
  r.searches = dynamic_cast<const agent::SearchLaw*>(law) != nullptr;
  const auto* const pursuit = dynamic_cast<const agent::ControllerOf<agent::Pursuit>*>(law);
  const bool idle = dynamic_cast<const agent::ControllerOf<agent::Idle>*>(law) != nullptr;
  r.keeps_off = r.law && pursuit == nullptr && !idle;
  r.walls = pursuit != nullptr && pursuit->law().options.wall_margin_m > 0.0;
  return r;
}

bool IsForeign(const agent::Decider& decider) {
  const std::string name = decider.name.substr(0, decider.name.find(':'));
  return decider.builtin != nullptr && !agent::Controllers().IsOwn(name);
}

/// A key that not everything reads.
struct Rule {
  std::vector<std::string> keys;
  bool read;
  std::string what;  ///< that reads it
};

std::vector<Rule> RulesOf(const Reader& r, const Chosen& s) {
  const agent::AgentModel& m = s.model;
  const bool policy = r.observes || r.entities, truth = s.mode == InformationMode::kTruth;
  const bool paper = s.reward == task::RewardKind::kPaper;
  const bool raw = s.reward == task::RewardKind::kReleaseRaw;
  return {
      {{"believed.sea.bottom_m"}, r.entities, "a policy over entities"},
      {{"sea.bottom_m"},
       r.entities || m.sea.terrain == "flat",
       "a policy over entities, or a sea with the terrain flat,"},
      {{"believed.sea.auv_depth_m", "believed.sea.spheres", "believed.sea.cylinders"},
       r.entities || r.keeps_off,
       "a policy over entities, or a law that keeps off the bottom and obstacles,"},
      {{"track.search_cell_m"}, r.entities || r.searches, "a policy over entities or a search law"},
      {{"believed.sensing.range_m"}, policy || r.searches, "a policy or a search law"},
      {{"track.lost_std_m"}, policy || m.task.free(), "a policy, or the assignment free,"},
      {{"vehicle.max_rate_radps", "believed.vehicle.max_rate_radps"},
       r.observes || dynamics::LimitsRates(m.vehicle),
       "a policy over the observation, or a vehicle that limits its rates,"},
      {{"control.velocity_gain", "control.attitude_gain", "control.rate_gain", "control.heading",
        "control.heading_gain"},
       r.law || m.control.interface != dynamics::ActionInterface::kTau6,
       "a law, or the interface velocity3,"},
      {{"channel.range_m"}, r.observes || !truth || paper, "a policy, or the paper's reward,"},
      {{"believed.channel.range_m"}, r.observes || !truth, "a policy, or the mode acoustic,"},
      {{"believed.workspace.half_extent_m"},
       r.observes || !truth || (r.walls && !m.sea.open),
       "a policy, a pursuit with a wall-margin, or the mode acoustic,"},
      {{"observation.near_range_m"},
       policy || paper || raw,
       "a policy, or a reward other than release,"},
  };
}

bool Sets(const std::string& override, const std::string& key) {
  return override.rfind(key + "=", 0) == 0;
}

/// Numbers of the observation have a table of their readers.
bool ReadsOfObservation(const Reader& r, const std::string& key) {
  switch (agent::ReaderOf(key)) {
    case agent::ObservationReader::kTask:
      return true;
    case agent::ObservationReader::kPolicy:
      return r.observes || r.entities;
    case agent::ObservationReader::kVectorPolicy:
      return r.observes;
  }
  return true;
}

/// What reads this override instead of `r`; empty if `r` reads it.
std::string OtherReader(const Reader& r, const Chosen& s, const std::string& override) {
  for (const Rule& rule : RulesOf(r, s)) {
    if (rule.read) continue;
    for (const std::string& key : rule.keys) {
      if (Sets(override, key)) return rule.what;
    }
  }
  const bool observation = override.rfind("observation.", 0) == 0;
  if (observation && !ReadsOfObservation(r, override.substr(0, override.find('=')))) {
    return r.entities ? "a policy over the observation" : "a policy";
  }
  return "";
}

void Refuse(const std::string& override, const std::string& what, const std::string& name) {
  throw UserError("'" + override + "': only " + what + " reads this, but " + name + " decides");
}

}  // namespace

void RefuseUnread(const agent::Decider& decider, const Chosen& chosen,
                  const std::vector<std::string>& overrides) {
  if (IsForeign(decider)) return;
  const Reader reader = ReaderOf(decider);
  for (const std::string& text : overrides) {
    const std::string other = OtherReader(reader, chosen, text);
    if (!other.empty()) Refuse(text, other, reader.name);
  }
}

void RefuseUnreadInTraining(const std::string& teacher, const Chosen& chosen,
                            const std::vector<std::string>& overrides) {
  Reader trained;
  trained.name = "a policy over the observation";
  trained.observes = true;
  std::optional<agent::Decider> taught;
  if (!teacher.empty()) taught = agent::MakeDecider(teacher, chosen.model);
  if (taught && IsForeign(*taught)) return;
  for (const std::string& text : overrides) {
    const std::string other = OtherReader(trained, chosen, text);
    if (other.empty() || (taught && OtherReader(ReaderOf(*taught), chosen, text).empty())) {
      continue;
    }
    Refuse(text, other, trained.name);
  }
}

}  // namespace stg::env
