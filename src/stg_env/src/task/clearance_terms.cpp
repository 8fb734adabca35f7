#include "stg_env/task/reward_term.hpp"

namespace stg::task {
namespace {

/// The default is a usual altitude of survey vehicles over rough ground.
struct SeabedOptions {
  double margin_m = 10.0;
};

/// The default is the turning circle of a torpedo.
struct ObstacleOptions {
  double margin_m = 25.0;
};

void Describe(SeabedOptions* o, config::Table* t) {
  t->Add("margin_m", &o->margin_m, config::Positive(1e4), "m",
         "altitude above the bottom above which the term is 0");
}

void Describe(ObstacleOptions* o, config::Table* t) {
  t->Add("margin_m", &o->margin_m, config::Positive(1e4), "m",
         "distance to the nearest obstacle beyond which the term is 0");
}

/// Minus the missing share of a margin to an obstruction: 0 at the margin and beyond, -1 in
/// contact. 0 if there is no open water.
/// @param of a length of FieldState
struct ClearanceTerm {
  double margin_m;

  template <class T>
  T Of(const TermInput<T>& in, T FieldState<T>::*of) const {
    if (in.swarm.field == nullptr) return T(0.0);
    const T& length = (*in.swarm.field)[static_cast<std::size_t>(in.agent)].*of;
    return -Clip(T(1.0) - length * T(1.0 / margin_m), T(0.0), T(1.0));
  }
};

/// Term for the altitude above the bottom.
struct SeabedTerm : TermOf<SeabedTerm> {
  explicit SeabedTerm(const SeabedOptions& options) : clearance{options.margin_m} {}

  ClearanceTerm clearance;

  template <class T>
  T Of(const TermInput<T>& in) const {
    return clearance.Of(in, &FieldState<T>::altitude_m);
  }
};

/// Term for the distance to the nearest obstacle.
struct ObstacleTerm : TermOf<ObstacleTerm> {
  explicit ObstacleTerm(const ObstacleOptions& options) : clearance{options.margin_m} {}

  ClearanceTerm clearance;

  template <class T>
  T Of(const TermInput<T>& in) const {
    return clearance.Of(in, &FieldState<T>::clearance_m);
  }
};

std::unique_ptr<const RewardTerm> MakeSeabedTerm(const SeabedOptions& options, const JudgeConfig&) {
  return std::make_unique<SeabedTerm>(options);
}

std::unique_ptr<const RewardTerm> MakeObstacleTerm(const ObstacleOptions& options,
                                                   const JudgeConfig&) {
  return std::make_unique<ObstacleTerm>(options);
}

}  // namespace

RewardTermRegistry::Entry SeabedTermEntry() { return {"seabed", MakeSeabedTerm}; }
RewardTermRegistry::Entry ObstacleTermEntry() { return {"obstacle", MakeObstacleTerm}; }

}  // namespace stg::task
