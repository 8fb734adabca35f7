#pragma once

#include <string>
#include <vector>

#include "auv_common/registry.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::task {

struct JudgeConfig;

/// Input of a reward term: one AUV after a decision.
template <class T>
struct TermInput {
  const SwarmState<T>& swarm;
  int agent;
  const Tracking<T>& tracking;    ///< of this AUV
  const Effort<T>& previous_tau;  ///< of this AUV, the decision before
  const Effort<T>& previous_action;
};

/// A term that is added to the paper's reward, times its weight (`reward.terms.<name>`). It is
/// evaluated for one swarm (double) and for kLanes swarms at once (Pack); write it once, as a
/// template, see TermOf. It has no memory; all that it may compare is in its input.
class RewardTerm {
 public:
  virtual ~RewardTerm() = default;
  virtual double Evaluate(const TermInput<double>& in) const = 0;
  virtual Pack Evaluate(const TermInput<Pack>& in) const = 0;
};

/// Makes a RewardTerm of a class with a member `template <class T> T Of(const TermInput<T>&)
/// const`.
template <class Term>
class TermOf : public RewardTerm {
 public:
  double Evaluate(const TermInput<double>& in) const final { return self().Of(in); }
  Pack Evaluate(const TermInput<Pack>& in) const final { return self().Of(in); }

 private:
  const Term& self() const { return static_cast<const Term&>(*this); }
};

/// The names below `reward.terms`. A term is a new file and one line in src/task/reward_terms.cpp;
/// a program adds terms of its own before it loads a scenario.
using RewardTermRegistry = Registry<const RewardTerm, const JudgeConfig&>;
RewardTermRegistry& RewardTermsByName();

/// Names of the suite's terms that are always 0 between walls.
std::vector<std::string> TermsOfOpenWater();

}  // namespace stg::task
