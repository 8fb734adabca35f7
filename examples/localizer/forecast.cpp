// A localizer of your own: it corrects the reckoned position by a forecast of the current. A log
// without a bottom does not measure the current, so the reckoned position stays behind. See
// docs/how_to/in_this_repository.md.

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "auv_common/config/files.hpp"
#include "auv_common/plugin.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_env/env/evaluation.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

using namespace stg;
using namespace stg::agent;

struct ForecastOptions {
  std::array<double, 2> current_mps{0.0, 0.0};  // east, north
  double std_mps = 0.1;
};

void Describe(ForecastOptions* o, config::Table* t) {
  t->Add("current_mps", config::Numbers(&o->current_mps), config::Within(-10, 10), "m/s, world ENU",
         "east and north component of the forecast current");
  t->Add("std_mps", &o->std_mps, config::NonNegative(10), "m/s",
         "standard deviation of each component of the forecast");
}

class Forecast : public Localizer {
 public:
  explicit Forecast(const ForecastOptions& options) : options_(options) {}

  void Reset() override { *this = Forecast(options_); }
  void Hear(const NeighbourState&, const acoustics::Reception&) override {}
  void HearAnswer(const acoustics::Reception&) override {}
  void Advance(TimeNs now, const OwnReckoning& own) override {
    if (!started_) start_std_m_ = own.position_std_m;
    started_ = true;
    now_ = now;
    own_ = own;
  }

  PlaneError own() const override { return ahead(0.0); }
  PlaneError ahead(double ahead_s) const override {
    const double t = Seconds(now_) + ahead_s, spread = options_.std_mps * t;
    const double variance = start_std_m_ * start_std_m_ + spread * spread;
    return {-options_.current_mps[0] * t, -options_.current_mps[1] * t, variance, 0.0, variance};
  }
  /// The current carries all AUVs alike, so only the errors of their starts differ.
  PlaneError relative(int /*id*/, TimeNs /*at*/) const override {
    const double variance = 2.0 * start_std_m_ * start_std_m_;
    return {0.0, 0.0, variance, 0.0, variance};
  }
  PlaneError current() const override {
    const double variance = options_.std_mps * options_.std_mps;
    return {options_.current_mps[0], options_.current_mps[1], variance, 0.0, variance};
  }
  int fixes() const override { return 0; }
  TimeNs fixed() const override { return -1; }
  void Tell(NeighbourState*) const override {}
  /// No AUV is far from a place where it can be received.
  Vec3<double> NearTo(int /*id*/) const override { return own_.p_WB; }

 private:
  ForecastOptions options_;
  bool started_ = false;
  TimeNs now_ = 0;
  double start_std_m_ = 0.0;  // of each horizontal component
  OwnReckoning own_;
};

std::unique_ptr<Localizer> MakeForecast(const ForecastOptions& options, const AgentModel& /*model*/,
                                        const int& /*self*/) {
  return std::make_unique<Forecast>(options);
}

/// Error of the AUVs' own positions [m] after ten minutes in a current of 0.3 m/s to the east.
double Error(const std::string& forecast) {
  const Scenario scenario = LoadNamedScenario(
      config::ScenarioFolder(), "deep", "nominal",
      {"current.velocity_mps=[0.3,0,0]", "current.random_mps=[0,0]", "time.episode_steps=600",
       "time.tail_steps=60", "localization.kind=forecast",
       "localization.forecast.current_mps=" + forecast});
  env::EvaluationOptions options;
  options.episodes = 1;
  const auto episodes = env::Evaluate(
      env::EnvFactory(scenario), agent::MakeDecider("pursuit", scenario.model()), options, nullptr);
  return episodes.front().field->navigation->rmse_tail;
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { Localizers().Add("forecast", MakeForecast); }

int main() {
  stg_plugin_register();

  const double without = Error("[0,0]"), with = Error("[0.3,0]");
  std::printf("error of the own positions after ten minutes: %.1f m, with the forecast %.1f m\n",
              without, with);
  // The current carries an AUV 180 m in ten minutes. The other errors of its instruments remain.
  return without > 150.0 && with < 15.0 ? 0 : 1;
}
