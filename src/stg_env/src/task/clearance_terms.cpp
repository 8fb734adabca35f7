#include "terms.hpp"

namespace stg::task {
namespace {

/// Minus the share of a margin that is missing to something to be kept clear of: 0 from the margin
/// on, -1 in contact. 0 where there is no open water.
/// @param of one of FieldState's lengths
struct ClearanceTerm {
  double margin_m;

  template <class T>
  T Of(const TermInput<T>& in, T FieldState<T>::*of) const {
    if (in.swarm.field == nullptr) return T(0.0);
    const T& length = (*in.swarm.field)[static_cast<std::size_t>(in.agent)].*of;
    return -Clip(T(1.0) - length * T(1.0 / margin_m), T(0.0), T(1.0));
  }
};

/// Altitude above the bottom; the margin is that of survey vehicles over rough ground, 10 m.
struct SeabedTerm : TermOf<SeabedTerm> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    return ClearanceTerm{10.0}.Of(in, &FieldState<T>::altitude_m);
  }
};

/// Distance to the nearest obstacle; the margin is the turning circle of a torpedo, 25 m.
struct ObstacleTerm : TermOf<ObstacleTerm> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    return ClearanceTerm{25.0}.Of(in, &FieldState<T>::clearance_m);
  }
};

}  // namespace

std::unique_ptr<const RewardTerm> MakeSeabedTerm(const JudgeConfig&) {
  return std::make_unique<SeabedTerm>();
}

std::unique_ptr<const RewardTerm> MakeObstacleTerm(const JudgeConfig&) {
  return std::make_unique<ObstacleTerm>();
}

}  // namespace stg::task
