#include "localizers.hpp"

namespace stg::agent {
namespace {

constexpr char kUncorrected[] = "uncorrected";

/// Takes every position as it was reported.
class Uncorrected : public Localizer {
 public:
  void Reset() override {}
  void Hear(const NeighbourState&, const acoustics::Reception&) override {}
  void HearAnswer(const acoustics::Reception&) override {}
  void Advance(TimeNs, const OwnReckoning&) override {}
  PlaneError own() const override { return {}; }
  PlaneError ahead(double) const override { return {}; }
  int fixes() const override { return 0; }
  TimeNs fixed() const override { return -1; }
  PlaneError relative(int, TimeNs) const override { return {}; }
  PlaneError current() const override { return {}; }
  void Tell(NeighbourState*) const override {}
  Vec3<double> NearTo(int) const override { return {}; }
};

std::unique_ptr<Localizer> MakeUncorrected(const AgentModel&, const int&) {
  return std::make_unique<Uncorrected>();
}

}  // namespace

LocalizerRegistry& Localizers() {
  static LocalizerRegistry registry("localizer", {
                                                     {kUncorrected, MakeUncorrected},
                                                     {"ranges", MakeRangeLocalizer},
                                                 });
  return registry;
}

bool AgentModel::locates() const { return localization.kind != kUncorrected; }

std::unique_ptr<Localizer> MakeLocalizer(const AgentModel& model, int self) {
  if (!model.locates()) return nullptr;
  return Localizers().Make(model.localization.kind, model.localization.kinds, model, self);
}

}  // namespace stg::agent
