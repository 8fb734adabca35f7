#pragma once

#include <ros/subscriber.h>
#include <ros/time.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded_trainer.hpp"

namespace stg::nodes {

/// What the trainer node trains: it records episodes, judges them, and learns from the good ones.
class OnlineLearner {
 public:
  virtual ~OnlineLearner() = default;
  OnlineLearner() = default;
  OnlineLearner(const OnlineLearner&) = delete;
  OnlineLearner& operator=(const OnlineLearner&) = delete;

  /// A judged episode. If it has no flaw, the learner keeps it for the next update.
  struct Episode {
    std::uint32_t number = 0;
    std::string source;
    learn::Finding finding;
  };
  /// Content of one bag.
  struct Bag {
    std::vector<Episode> episodes;
    std::uint64_t foreign_messages = 0;
    std::string error;  ///< reason why the bag, or a part of it, could not be used
  };
  /// The topics that the node needs from a live run.
  struct Hooks {
    /// Whether messages of this episode and stamp count.
    std::function<bool(std::uint32_t episode, const ros::Time& stamp)> wanted;
    std::function<void(int agent, const std::string& policy)> flown;  ///< at each decision
    std::function<void(const ros::Time& stamp)> time;
  };

  virtual std::vector<ros::Subscriber> Subscribe(const Hooks& hooks) = 0;
  /// Drops the records of unfinished episodes.
  virtual void Restart() = 0;
  /// The episodes that ended since the last call.
  virtual std::vector<Episode> TakeDone() = 0;
  virtual Bag ReadBag(const std::string& path) = 0;
  /// Learns from the kept episodes, at least one, and forgets them.
  virtual learn::RecordedTrainer::Progress Update() = 0;

  virtual const std::string& policy_id() const = 0;
  virtual std::string policy_path() const = 0;
  virtual std::int64_t updates() const = 0;
  virtual std::int64_t env_steps() const = 0;
};

}  // namespace stg::nodes
