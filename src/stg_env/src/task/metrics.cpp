#include "stg_env/task/metrics.hpp"

#include <algorithm>
#include <cmath>

namespace stg::task {

std::vector<std::pair<std::string, double>> FieldMetrics::Items() const {
  std::vector<std::pair<std::string, double>> items{{"estimate_rmse", estimate_rmse},
                                                    {"nees", nees},
                                                    {"estimate_known", estimate_known},
                                                    {"information_age", information_age},
                                                    {"band_share", band_share},
                                                    {"worst_band_share", worst_band_share},
                                                    {"time_lost", time_lost},
                                                    {"time_to_reacquire", time_to_reacquire},
                                                    {"losses", losses},
                                                    {"spread", spread},
                                                    {"near_pairs", near_pairs},
                                                    {"min_altitude", min_altitude},
                                                    {"min_clearance", min_clearance},
                                                    {"groundings", groundings},
                                                    {"collisions", collisions},
                                                    {"packets", packets},
                                                    {"packet_loss", packet_loss},
                                                    {"modem_energy", modem_energy},
                                                    {"propulsion_energy", propulsion_energy}};
  for (const auto& item : estimates.Items()) items.push_back(item);
  for (const auto& item : search.Items()) items.push_back(item);
  if (navigation) {
    for (const auto& item : navigation->Items()) items.push_back(item);
  }
  if (pings) {
    items.emplace_back("pings", pings->pings);
    items.emplace_back("ping_loss", pings->loss);
    items.emplace_back("airtime_share", pings->airtime_share);
  }
  return items;
}

std::vector<std::pair<std::string, double>> EpisodeMetrics::Items() const {
  std::vector<std::pair<std::string, double>> items{
      {"return", episode_return},
      {"tail_distance", tail_distance},
      {"tracking_error", tracking_error},
      {"lost_rate", lost_rate},
      {"action_norm", action_norm},
      {"saturation_rate", saturation_rate},
      {"control_cost", control_cost},
      {"communication_quality", communication_quality},
      {"band_rate", band_rate},
      {"colliding_pairs", colliding_pairs},
      {"tail_colliding_pairs", tail_colliding_pairs},
      {"min_separation", min_separation},
      {"time_to_band", time_to_band},
      {"mean_error", mean_error},
      {"whole_lost_rate", whole_lost_rate},
      {"reward_track", reward_track},
      {"reward_observation", reward_observation},
      {"reward_coordination", reward_coordination},
      {"reward_communication", reward_communication},
      {"reward_semantic", reward_semantic},
      {"reward_separation", reward_separation}};
  if (!field) return items;
  for (const auto& item : field->Items()) items.push_back(item);
  return items;
}

bool OfTail(const std::string& metric) {
  return metric == "tail_distance" || metric == "tracking_error" || metric == "lost_rate" ||
         metric == "band_rate" || metric == "tail_colliding_pairs" || metric == "own_rmse_tail" ||
         metric == "world_rmse_tail" || metric == "navigation_rmse_tail";
}

double MetricSummary::Mean(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? 0.0 : mean[static_cast<size_t>(found - names.begin())];
}

double MetricSummary::Std(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? 0.0 : std[static_cast<size_t>(found - names.begin())];
}

void MetricSummary::Append(const std::string& name, double its_mean, double its_std) {
  names.push_back(name);
  mean.push_back(its_mean);
  std.push_back(its_std);
}

MetricSummary Summarise(const std::vector<EpisodeMetrics>& episodes) {
  MetricSummary s;
  s.episodes = static_cast<int>(episodes.size());
  const EpisodeMetrics any = episodes.empty() ? EpisodeMetrics{} : episodes.front();
  for (const auto& item : any.Items()) s.names.push_back(item.first);
  s.mean.assign(s.names.size(), 0.0);
  s.std.assign(s.names.size(), 0.0);
  const double n = static_cast<double>(episodes.size());
  if (episodes.empty()) return s;
  for (const auto& e : episodes) {
    const auto items = e.Items();
    for (size_t k = 0; k < items.size(); ++k) s.mean[k] += items[k].second / n;
  }
  if (episodes.size() < 2) return s;
  for (const auto& e : episodes) {
    const auto items = e.Items();
    for (size_t k = 0; k < items.size(); ++k) {
      const double d = items[k].second - s.mean[k];
      s.std[k] += d * d / (n - 1.0);
    }
  }
  for (double& v : s.std) v = std::sqrt(v);
  return s;
}

}  // namespace stg::task
