// A learning algorithm of your own: random search over a linear policy. See
// docs/how_to/add_an_algorithm.md.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_common/plugin.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"
#include "marl_trainer/learn/run/trainer.hpp"

namespace {

using namespace stg;
using namespace stg::learn;

struct HillClimbingConfig : AlgorithmConfig {
  double step = 0.05;

  std::unique_ptr<AlgorithmConfig> Clone() const override {
    return std::make_unique<HillClimbingConfig>(*this);
  }
  void Describe(config::Table* table) override {
    table->Add("step", &step, {1e-6, 10}, "-", "standard deviation of the candidates' weights");
  }
  std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                  const Team& team) const override;
};

/// Every environment flies its own candidate for a whole collection: the best policy so far with
/// noise on its weights. The candidate with the highest reward is the next best policy.
class HillClimbing : public Algorithm {
 public:
  HillClimbing(const HillClimbingConfig& config, const TrainConfig& common, const Problem& problem)
      : config_(config), seed_(common.seed), problem_(problem), actor_(Linear(problem)) {
    best_.assign(actor_.parameters(), 0.0F);
  }

  void Begin(const Collection& collection) override {
    candidates_.clear();
    earned_.clear();
    first_.clear();
    for (const Shard& shard : collection.shards) {
      first_.push_back(shard.first_env);
      for (int e = 0; e < shard.envs; ++e) {
        candidates_.push_back(Candidate(collection.number, shard.first_env + e));
        earned_.push_back(0.0);
      }
    }
  }

  void Act(const Decision& decision, const Actions& out) override {
    for (int e = 0; e < decision.envs; ++e) {
      const std::vector<float>& p =
          decision.explore == nullptr ? best_ : candidates_[Index(decision.explore->first_env + e)];
      Mlp::Workspace workspace(actor_.mean(), problem_.agents);
      actor_.mean().Forward(
          p.data(), decision.observations + Index(e * problem_.agents * problem_.observation_size),
          problem_.agents, &workspace);
      const int count = problem_.agents * problem_.action_size;
      std::copy_n(workspace.output(), count, out.actions + Index(e * count));
    }
  }

  void Observe(const Transition& t) override {
    for (int e = 0; e < t.envs; ++e) {
      earned_[Index(first_[Index(t.shard)] + e)] += static_cast<double>(t.team_rewards[e]);
    }
  }

  UpdateReport Update(const UpdateContext&) override {
    const auto most = std::max_element(earned_.begin(), earned_.end());
    best_ = candidates_[Index(static_cast<int>(most - earned_.begin()))];
    UpdateReport report;
    report.values = {*most};
    return report;
  }

  void Save(Archive* archive) const override { archive->Put("best", best_); }
  void Load(const Archive& archive) override { best_ = archive.Floats("best", best_.size()); }
  std::vector<ReportColumn> Columns() const override { return {{"earned", "earned", 1}}; }
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override {
    Normaliser raw;
    raw.mean.assign(Index(problem_.observation_size), 0.0F);
    raw.std.assign(raw.mean.size(), 1.0F);
    raw.clip = 1e6F;
    return {actor_.ToPolicy(best_.data(), raw, metadata)};
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }
  static NetworkSpec Linear(const Problem& problem) {
    NetworkSpec spec;
    spec.inputs = problem.observation_size;
    spec.outputs = problem.action_size;
    spec.squash = static_cast<float>(problem.action_scale);
    return spec;
  }

  /// The draw depends on these numbers and not on the state of a generator. So any shard and any
  /// resumed run get the same candidate.
  std::vector<float> Candidate(std::uint32_t collection, int env) const {
    std::vector<float> p = best_;
    if (env == 0) return p;  // the best policy so far also competes
    Random random(seed_, Stream::kPolicy, collection, 0, static_cast<std::uint32_t>(env));
    for (float& x : p) x += static_cast<float>(config_.step * random.Normal());
    return p;
  }

  const HillClimbingConfig config_;
  const std::uint64_t seed_;
  const Problem problem_;
  const GaussianActor actor_;
  std::vector<float> best_;
  std::vector<int> first_;                      // environment of each shard
  std::vector<std::vector<float>> candidates_;  // by environment
  std::vector<double> earned_;
};

std::unique_ptr<Algorithm> HillClimbingConfig::Make(const TrainConfig& common,
                                                    const Problem& problem, const Team&) const {
  return std::make_unique<HillClimbing>(*this, common, problem);
}

/// Trains for some collections and returns the return of the last validation.
double Train(const Scenario& scenario, TrainSetup setup, int collections, int workers,
             const std::string& out, Archive* end) {
  setup.common.steps = std::int64_t{setup.common.envs} * setup.common.horizon * collections;
  std::ostringstream log;
  Trainer::Options options;
  options.out = out;
  options.workers = workers;
  options.log = &log;
  Trainer trainer(scenario, setup, options);
  trainer.Run();
  trainer.algorithm().Save(end);
  return trainer.state().best_return;
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { Algorithms().Add("hill_climbing", std::make_unique<HillClimbingConfig>); }

int main() {
  stg_plugin_register();

  const TemporaryFolder temporary;
  const std::string folder = temporary.path().string();
  const Scenario scenario = LoadNamedScenario(config::ScenarioFolder(), "medium_release", "nominal",
                                              {"time.episode_steps=100", "time.tail_steps=40"});
  TrainSetup setup("hill_climbing", "fast");
  setup.common.envs = 32;
  setup.common.horizon = 100;  // the whole episode, by which a candidate is judged
  setup.common.stagger = false;
  setup.common.validation_episodes = 16;
  Archive one, two, first;
  const double untrained = Train(scenario, setup, 1, 1, folder + "/first", &first);
  const double trained = Train(scenario, setup, 12, 1, folder + "/one", &one);
  Train(scenario, setup, 12, 2, folder + "/two", &two);
  std::printf("return %.1f after one collection, %.1f after twelve\n", untrained, trained);
  // The return increases, and two workers give the same result as one, bit for bit.
  return trained > untrained && one == two ? 0 : 1;
}
