#pragma once

#include <auv_msgs/LinkStates.h>

#include <string>
#include <vector>

#include "stg_env/nodes/episode_judge.hpp"

namespace stg::nodes {

/// Shows the run in the terminal. It redraws a table in place if standard output is a terminal;
/// otherwise it prints one line per second.
class LiveTable {
 public:
  /// @param link_available smallest quality of a usable link
  LiveTable(const RunConfig& run, double link_available, int episodes);

  /// Stores data of the agents and the channel for the next drawing.
  void SetPhase(int agent, int phase) { phases_[static_cast<std::size_t>(agent)] = phase; }
  void SetLinks(const auv_msgs::LinkStates& links);

  /// Draws if a drawing is due. @param now_s simulated time since step 0 of the episode [s]
  void Tick(const EpisodeJudge& judge, double now_s);

  /// Leaves the table in place and prints an episode's metrics below it.
  void PrintEpisode(const auv_msgs::EpisodeSummary& summary, const task::EpisodeMetrics& metrics);
  /// Prints mean and standard deviation over all episodes so far.
  void PrintRun(const std::vector<task::EpisodeMetrics>& episodes) const;

 private:
  std::string Table(const EpisodeJudge& judge, double now_s) const;
  std::string Line(const EpisodeJudge& judge, double now_s) const;

  RunConfig run_;
  double link_available_;
  int episodes_;
  bool terminal_;
  int drawn_lines_ = 0;
  ros::WallTime drawn_;
  double drawn_s_ = 0.0, speed_ = 0.0;
  std::uint32_t drawn_episode_ = 0;
  std::vector<int> phases_;            ///< [agents], -1: not received yet
  std::vector<double> age_, quality_;  ///< [agents], mean over incoming links
  std::vector<int> live_links_;        ///< [agents], incoming links with usable quality
};

}  // namespace stg::nodes
