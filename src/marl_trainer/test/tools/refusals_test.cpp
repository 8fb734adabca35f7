#include <initializer_list>

#include "cli_fixture.hpp"

namespace stg::env {
namespace {

TEST_F(CommandLine, WhatHasNoEffectIsRefusedWithASentence) {
  const std::string onnx = "--policy " STG_SCENARIO_FOLDER "/../policies/field.onnx";
  const std::string train = "--out " + folder_ + "/run ";
  struct Case {
    const char* program;
    std::string arguments, sentence;
  };
  for (
      const Case& c : std::initializer_list<Case>{
          {STG_EVALUATE, "--policy pursuit:gain=1 --gain 3",
           "--gain: --policy 'pursuit:gain=1' states this constant, too; leave out one of the two"},
          {STG_EVALUATE, "--policy encircle --gain 3",
           "--gain: belongs to contain | formation | pursuit | pursuit_separated, but this "
           "evaluation flies 'encircle'"},
          {STG_EVALUATE, onnx + " --scenario field --privileged",
           "privileged: only a built-in controller can read true states, but '"},
          {STG_EVALUATE, "--policy pursuit --scenario medium_release --privileged",
           "privileged: the scenario has the mode truth"},
          {STG_EVALUATE, "--policy idle --record-episodes 2",
           "--record-episodes requires --record"},
          {STG_EVALUATE, "--policy idle --variant tau6 --set control.interface=velocity3",
           "the variant tau6 sets control.interface=tau6"},
          {STG_EVALUATE, "--policy idle --set control.action_scale=0.2",
           "only a training reads this key, but evaluate does not train"},
          {STG_EVALUATE, "--policy pursuit --set observation.graph=false",
           "only a policy reads this, but 'pursuit' decides"},
          {STG_EVALUATE, "--policy pursuit --set observation.error_scale_m=2",
           "only a policy reads this, but 'pursuit' decides"},
          {STG_EVALUATE, "--policy encircle --scenario field --set believed.sea.bottom_m=50",
           "only a policy over entities reads this, but 'encircle' decides"},
          {STG_EVALUATE, "--policy encircle --scenario field --set track.search_cell_m=100",
           "only a policy over entities or a search law reads this, but 'encircle' decides"},
          {STG_EVALUATE, "--policy encircle --scenario field --set track.lost_std_m=1",
           "only a policy, or the assignment free, reads this"},
          {STG_EVALUATE, "--policy pursuit --set believed.sensing.range_m=5",
           "only a policy or a search law reads this"},
          {STG_EVALUATE,
           "--policy encircle --scenario field --set channel.physical.modem.queue=fifo",
           "belongs to the waiting packets 'csma' or 'ping'"},
          {STG_EVALUATE, "--policy pursuit:repulsion-range=0.5",
           "belongs to the repulsion 'above 0'"},
          {STG_EVALUATE, "--policy encircle:horizon=0 --scenario field", "horizon"},
          {STG_TRAIN, train + "--variant semantic --set observation.links=false",
           "the variant semantic chose"},
          {STG_EVALUATE,
           "--policy encircle --scenario field --set believed.sensing.detection_probability=0.5",
           "belongs to the search 'with a map'"},
          {STG_EVALUATE, "--policy encircle --scenario field --set reward.terms.obstacle.weight=2",
           "belongs to the sea 'obstacles'"},
          {STG_EVALUATE, "--policy encircle --scenario field --set vehicle.max_rate_radps=[1,1,1]",
           "only a policy over the observation, or a vehicle that limits its rates, reads this, "
           "but "
           "'encircle' decides"},
          {STG_EVALUATE, "--policy pursuit --scenario field --set believed.sea.auv_depth_m=[30,40]",
           "or a law that keeps off the bottom and obstacles, reads this"},
          {STG_EVALUATE, "--policy encircle --scenario field20 --set sea.bottom_m=110",
           "a sea with the terrain flat, reads this"},
          {STG_EVALUATE,
           "--policy pursuit --scenario medium_release --set observation.near_range_m=0.2",
           "a reward other than release, reads this"},
          {STG_EVALUATE, "--policy pursuit --scenario medium_release --set channel.range_m=0.4",
           "the paper's reward, reads this"},
          {STG_EVALUATE, "--policy idle --privileged", "privileged: 'idle' reads no states"},
          {STG_EVALUATE,
           "--policy encircle --scenario field --set navigation.kind=perfect --set "
           "track.measurements.observers=rates",
           "track.measurements.observers: belongs to the navigation system 'dead_reckoning'"},
          {STG_EVALUATE,
           "--policy encircle --scenario deep --condition craft_ping --set "
           "believed.channel.physical.modem.clock_drift_std_ppm=1",
           "belongs to the ranging 'one_way'"},
          {STG_TRAIN, train + "--set track.search_cell_m=0.1",
           "only a policy over entities or a search law reads this, but a policy over the "
           "observation decides"},
          {STG_TRAIN, train + "--variant tau6 --set control.rate_gain=5",
           "only a law, or the interface velocity3, reads this"},
          {STG_TRAIN_SWARM, train + "--envs 16 --leaving false",
           "--leaving: has no effect with fewer than 32 environments (--envs)"},
          {STG_EVALUATE, "--policy idle --set reset.curriculum=true",
           "only a training reads this key, but evaluate does not train"},
          {STG_EVALUATE, "--policy idle --set seed=1 --set seed=2",
           "seed: is also set by --set 'seed=1'"},
          {STG_EVALUATE, "--policy idle --scenario field --condition foo",
           "the scenario 'field' has no condition of this name; it has nominal, clutter, "},
          {STG_BENCH_ENV, "--set reset.curriculum=true", "only a training reads this key"},
          {STG_BENCH_ENV, "--set critic.far_scale_m=2", "only a training reads this key"},
          {STG_BENCH_ENV, "--scaling --set agents=3", "--scaling sets this key"},
          {STG_TRAIN, train + "--privileged-teacher true",
           "--privileged-teacher: belongs to the training 'with imitation'; this command chose "
           "'without imitation' (--imitate)"},
          {STG_TRAIN, train + "--imitation-focus 2", "--imitation-focus: belongs to the training"},
          {STG_TRAIN, train + "--imitation-share 0.5",
           "--imitation-share: belongs to the training"},
          {STG_TRAIN,
           train + "--scenario medium_release --imitate pursuit --imitation-steps 100 "
                   "--privileged-teacher true",
           "has the mode truth"},
          {STG_TRAIN, train + "--algorithm masac --alpha-lr 0 --target-entropy -5",
           "--target-entropy: belongs to the weight of the entropy 'adjusted'"},
          {STG_TRAIN, train + "--set observation.graph=false --set observation.link_available=0.9",
           "observation.link_available: belongs to the task graph"},
          {STG_TRAIN, train + "--algorithm masac --clip 0.1",
           "--clip: belongs to mappo | ippo | happo, but this training uses masac (--algorithm)"},
          {STG_TRAIN, train + "--noise-min 0.1", "but this training uses mappo"},
          {STG_TRAIN, train + "--algorithm ippo --set critic.far_scale_m=3",
           "this training uses ippo, which has none"},
          {STG_TRAIN, train + "--variant semantic --set observation.graph=true",
           "the variant semantic sets observation.graph=false"},
          {STG_TRAIN, train + "--variant semantic --set reward.weights.semantic=0.1",
           "the variant semantic sets reward.weights.semantic=0.0"},
          {STG_TRAIN_SWARM, train + "--without edges",
           "the network 'pool' does not read edges; --network graph does"},
          {STG_TRAIN_SWARM, train + "--entropy 0.1",
           "--entropy: belongs to the network 'graph'; this command chose 'pool' (--network)"},
          {STG_TRAIN_SWARM, train + "--last-entropy 0.1", "--last-entropy: belongs to the network"},
      }) {
    const Result r = Run(c.program, c.arguments);
    EXPECT_EQ(r.code, 2) << c.arguments << r.out;
    EXPECT_NE(r.err.find(c.sentence), std::string::npos) << c.arguments << "\n" << r.err;
    EXPECT_EQ(r.out.find('{'), std::string::npos) << r.out;
  }
  EXPECT_FALSE(fs::exists(folder_ + "/run"));
}

TEST_F(CommandLine, TheHelpListsTheVariants) {
  for (const char* program : {STG_EVALUATE, STG_TRAIN}) {
    EXPECT_NE(Run(program, "--help").out.find("{stg,semantic,velocity3,tau6}=stg"),
              std::string::npos);
    EXPECT_EQ(Run(program, "--policy idle --out x --variant tau").code, 2);
  }
  const std::string help = Run(STG_TRAIN, "--algorithm masac --help").out;
  EXPECT_EQ(help.find("--clip "), std::string::npos) << "masac has no such option";
}

}  // namespace
}  // namespace stg::env
