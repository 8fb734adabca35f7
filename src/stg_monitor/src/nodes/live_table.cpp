#include "live_table.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace stg::nodes {
namespace {

constexpr int kMaxRows = 24;  // more AUVs do not fit on a screen
constexpr const char* kPhases[] = {"search", "approach", "stable", "lost"};

const char* PhaseName(int phase) { return phase >= 0 && phase < 4 ? kPhases[phase] : "-"; }

__attribute__((format(printf, 1, 2))) std::string Format(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

LiveTable::LiveTable(const RunConfig& run, double link_available, int episodes)
    : run_(run),
      link_available_(link_available),
      episodes_(episodes),
      terminal_(isatty(STDOUT_FILENO) != 0),
      phases_(static_cast<std::size_t>(run.agents), -1),
      age_(phases_.size(), 0.0),
      quality_(phases_.size(), 0.0),
      live_links_(phases_.size(), 0) {}

void LiveTable::SetLinks(const auv_msgs::LinkStates& links) {
  std::fill(age_.begin(), age_.end(), 0.0);
  std::fill(quality_.begin(), quality_.end(), 0.0);
  std::fill(live_links_.begin(), live_links_.end(), 0);
  const double others = std::max(1, run_.agents - 1);
  for (const auto& link : links.links) {
    const auto i = static_cast<std::size_t>(link.destination);
    if (i >= age_.size()) continue;
    age_[i] += link.age / others;
    quality_[i] += link.quality / others;
    if (link.quality > link_available_) ++live_links_[i];
  }
}

void LiveTable::Tick(const EpisodeJudge& judge, double now_s) {
  const ros::WallTime wall = ros::WallTime::now();
  const double elapsed = (wall - drawn_).toSec();
  if (!judge.started() || elapsed < (terminal_ ? 0.2 : 1.0)) return;
  if (drawn_episode_ == judge.episode() && now_s > drawn_s_) speed_ = (now_s - drawn_s_) / elapsed;
  drawn_ = wall;
  drawn_s_ = now_s;
  drawn_episode_ = judge.episode();
  const std::string text = terminal_ ? Table(judge, now_s) : Line(judge, now_s);
  if (terminal_ && drawn_lines_ > 0) std::printf("\033[%dA\033[J", drawn_lines_);
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
  drawn_lines_ = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

std::string LiveTable::Table(const EpisodeJudge& judge, double now_s) const {
  std::string text = Format("\033[1m%s\033[0m  %s  episode %u", run_.name.c_str(),
                            judge.policy_id().c_str(), judge.episode() + 1);
  if (episodes_ > 0) text += Format("/%d", episodes_);
  text += Format("  t %.1f of %.1f s  %.1f x real time\n", now_s,
                 run_.time.episode_steps * run_.decision_dt_s(), speed_);
  text += " AUV  phase     distance [m]  error [m]  links  quality  age [s]\n";
  const int rows = std::min(run_.agents, kMaxRows);
  for (int i = 0; i < rows; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const auto& k = judge.tracking(i);
    text += Format(" %3d  %-8s  %12.4f  %9.4f  %2d/%-2d  %7.2f  %7.2f\n", i, PhaseName(phases_[u]),
                   k.distance, k.error, live_links_[u], run_.agents - 1, quality_[u], age_[u]);
  }
  if (rows < run_.agents) text += Format(" ... and %d more\n", run_.agents - rows);
  return text;
}

std::string LiveTable::Line(const EpisodeJudge& judge, double now_s) const {
  double distance = 0.0, error = 0.0;
  int count[4] = {}, links = 0;
  for (int i = 0; i < run_.agents; ++i) {
    const auto u = static_cast<std::size_t>(i);
    distance += judge.tracking(i).distance / run_.agents;
    error += judge.tracking(i).error / run_.agents;
    if (phases_[u] >= 0 && phases_[u] < 4) ++count[phases_[u]];
    links += live_links_[u];
  }
  return Format(
      "episode %u  t %6.1f s  search %d approach %d stable %d lost %d  distance %.4f m  error "
      "%.4f m  links %d/%d  age %.2f s  %.1f x real time\n",
      judge.episode() + 1, now_s, count[0], count[1], count[2], count[3], distance, error, links,
      run_.agents * (run_.agents - 1), Mean(age_), speed_);
}

void LiveTable::PrintEpisode(const auv_msgs::EpisodeSummary& s,
                             const task::EpisodeMetrics& metrics) {
  std::printf(
      "\nepisode %u, seed %llu, %u steps%s, policy %s, %u deadline misses, %u of the channel\n",
      s.episode + 1, static_cast<unsigned long long>(s.seed), s.steps,
      s.complete ? "" : " (incomplete)", s.policy_id.c_str(), s.deadline_misses, s.channel_misses);
  const bool cut = metrics.steps <= run_.time.episode_steps - run_.time.tail_steps;
  for (const auto& item : metrics.Items()) {
    if (cut && task::OfTail(item.first)) {
      std::printf("  %-22s %12s\n", item.first.c_str(), "-");
    } else {
      std::printf("  %-22s %12.5f\n", item.first.c_str(), item.second);
    }
  }
  std::fflush(stdout);
  drawn_lines_ = 0;
}

void LiveTable::PrintRun(const std::vector<task::EpisodeMetrics>& episodes) const {
  if (episodes.size() < 2) return;
  const task::MetricSummary summary = task::Summarise(episodes);
  std::printf("\n%d episodes: mean +- standard deviation\n", summary.episodes);
  for (std::size_t k = 0; k < summary.names.size(); ++k) {
    std::printf("  %-22s %12.5f +- %.5f\n", summary.names[k].c_str(), summary.mean[k],
                summary.std[k]);
  }
  std::fflush(stdout);
}

}  // namespace stg::nodes
