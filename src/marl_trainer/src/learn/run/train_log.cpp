#include "marl_trainer/learn/run/train_log.hpp"

#include <algorithm>
#include <cassert>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/checked_json.hpp"

namespace stg::learn {
namespace {

constexpr double kPoor = 0.05;         // from this share of losses on a policy is called poor
constexpr double kLineInterval = 2.0;  // [s] between progress lines without a validation
const std::pair<const char*, double> kThresholds[] = {
    {"1000", 1000.0}, {"1020", 1020.0}, {"1030", 1030.0}, {"1040", 1040.0}};

/// Name and value of every column except those of the algorithm and the validation.
std::vector<std::pair<const char*, double>> CommonColumns(const TrainRecord& r) {
  return {{"env_steps", static_cast<double>(r.env_steps)},
          {"collection", static_cast<double>(r.collections)},
          {"wall_seconds", r.wall_seconds},
          {"episodes", r.episodes},
          {"train_return", r.train_return},
          {"train_tail_distance", r.train_tail_distance},
          {"train_lost_rate", r.train_lost_rate},
          {"reward", r.reward},
          {"env_seconds", r.env_seconds},
          {"inference_seconds", r.inference_seconds},
          {"update_seconds", r.update_seconds},
          {"validation_seconds", r.validation_seconds}};
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// Collections are never cut, so the last one may exceed the total.
double PercentDone(std::int64_t steps, std::int64_t total) {
  return 100.0 * std::min(1.0, static_cast<double>(steps) / static_cast<double>(total));
}

/// Rows from before an interruption that the resumed run does not write again.
std::string KeptRows(const std::string& path, std::int64_t resume_at) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return "";
  if (!std::filesystem::is_regular_file(path, error)) {
    throw UserError(path + ": not a regular file");
  }
  std::ifstream in(path);
  if (!in) throw UserError(path + ": cannot be read");
  std::string kept, line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    try {
      if (std::stoll(line) <= resume_at) kept += line + "\n";
    } catch (const std::exception&) {
      break;  // a line was cut off by a crash; the resumed run writes the next ones again
    }
  }
  return kept;
}

}  // namespace

std::string ReportText(const std::vector<ReportColumn>& columns,
                       const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].label.empty()) continue;
    char number[48];
    std::snprintf(number, sizeof number, " %.*f", columns[i].decimals, values[i]);
    text += (text.empty() ? "" : " ") + columns[i].label + number;
  }
  return text;
}

TrainLog::TrainLog(const std::string& out, std::vector<ReportColumn> columns,
                   std::int64_t resume_at, std::int64_t total_steps, std::ostream* lines)
    : out_(out),
      csv_path_(out + "/progress.csv"),
      columns_(std::move(columns)),
      total_steps_(total_steps),
      lines_(lines) {
  // Writes all or nothing: the earlier rows must not be lost if the disk is full now.
  const std::string kept = resume_at >= 0 ? KeptRows(csv_path_, resume_at) : "";
  WriteDurably(Header() + kept, csv_path_, "the progress");
  csv_.open(csv_path_, std::ios::app);
  Flush();
}

void TrainLog::Flush() {
  if (!csv_.flush()) throw UserError(csv_path_ + ": cannot write the progress");
}

std::string TrainLog::Header() const {
  std::string header;
  for (const auto& column : CommonColumns(TrainRecord())) header += std::string(column.first) + ",";
  for (const ReportColumn& column : columns_) header += column.name + ",";
  for (const auto& item : task::EpisodeMetrics().Items()) {
    header += "validation_" + item.first + ",";
  }
  header += "validation_scenario_return\n";
  return header;
}

void TrainLog::Add(const TrainRecord& r) {
  assert(r.algorithm.size() == columns_.size());
  if (line_wall_ < 0.0) {
    line_wall_ = began_wall_ = wall_seconds_;
    line_steps_ = began_steps_ = env_steps_;
  }
  env_seconds_ += r.env_seconds;
  inference_seconds_ += r.inference_seconds;
  update_seconds_ += r.update_seconds;
  validation_seconds_ += r.validation_seconds;
  update_flops_ += r.update_flops;
  wall_seconds_ = r.wall_seconds;
  env_steps_ = r.env_steps;
  line_env_ += r.env_seconds;
  line_inference_ += r.inference_seconds;
  line_update_ += r.update_seconds;

  std::string row;
  for (const auto& column : CommonColumns(r)) row += Number(column.second) + ",";
  for (const double value : r.algorithm) row += Number(value) + ",";
  for (const auto& item : task::EpisodeMetrics().Items()) {
    row += (r.validated ? Number(r.validation.Mean(item.first)) : "") + ",";
  }
  row += (r.validated ? Number(r.validation.Mean("scenario_return")) : "") + "\n";
  csv_ << row;

  if (r.validated) {
    Flush();
    last_validation_.clear();
    for (std::size_t i = 0; i < r.validation.names.size(); ++i) {
      last_validation_[r.validation.names[i]] = r.validation.mean[i];
    }
    const double value = r.validation.Mean("return");
    const double judged = r.validation.Mean("scenario_return");
    const bool kept = r.validation.Mean("lost_rate") == 0.0;
    const Moment now{r.wall_seconds, r.env_steps};
    if (kept) reached_.emplace("no_loss", now);
    for (const auto& [name, threshold] : kThresholds) {
      if (judged >= threshold && kept) reached_.emplace(name, now);
    }
    if (best_validation_.empty() || value > best_validation_.at("return")) {
      best_validation_ = last_validation_;
      best_steps_ = r.env_steps;
    }
  }
  if (r.validated || r.wall_seconds - line_wall_ >= kLineInterval) PrintLine(r);
}

void TrainLog::PrintLine(const TrainRecord& r) {
  const double elapsed = std::max(r.wall_seconds - line_wall_, 1e-9);
  const double rate = static_cast<double>(r.env_steps - line_steps_) / elapsed;
  const double left = static_cast<double>(std::max<std::int64_t>(total_steps_ - r.env_steps, 0));
  const double so_far = static_cast<double>(r.env_steps - began_steps_) /
                        std::max(r.wall_seconds - began_wall_, 1e-9);
  char text[400];
  std::snprintf(text, sizeof text, "%5.1f%% %9" PRId64 " steps %6.1f s  %6.0f steps/s  ETA %4.0f s",
                PercentDone(r.env_steps, total_steps_), r.env_steps, r.wall_seconds, rate,
                left / std::max(so_far, 1.0));
  *lines_ << text;
  if (r.validated) {
    std::snprintf(text, sizeof text, " | return %7.1f tail %.4f m lost %.3f contacts %.2f",
                  r.validation.Mean("return"), r.validation.Mean("tail_distance"),
                  r.validation.Mean("lost_rate"), r.validation.Mean("tail_colliding_pairs"));
    *lines_ << text;
    if (r.validation.Mean("scenario_return") != r.validation.Mean("return")) {
      std::snprintf(text, sizeof text, " (scenario's return %.1f)",
                    r.validation.Mean("scenario_return"));
      *lines_ << text;
    }
  } else {
    std::snprintf(text, sizeof text, " | reward %.4f", r.reward);
    *lines_ << text;
  }
  std::snprintf(text, sizeof text, " | env %.0f%% inf %.0f%% upd %.0f%%",
                100.0 * line_env_ / elapsed, 100.0 * line_inference_ / elapsed,
                100.0 * line_update_ / elapsed);
  const std::string report = ReportText(columns_, r.algorithm);
  *lines_ << (report.empty() ? "" : " | ") << report;
  *lines_ << text << std::endl;
  line_wall_ = r.wall_seconds;
  line_steps_ = r.env_steps;
  line_env_ = line_inference_ = line_update_ = 0.0;
}

void TrainLog::Conclude() const {
  if (best_steps_ < 0) return;
  const auto folder = std::filesystem::absolute(out_).lexically_normal();
  const std::string policy = (folder / "policy_best.onnx").string();
  const double lost = best_validation_.at("lost_rate");
  char text[200];
  std::snprintf(
      text, sizeof text,
      "best of the validations: at %" PRId64 " steps, return %.1f, tail %.4f m, lost %.3f",
      best_steps_, best_validation_.at("return"), best_validation_.at("tail_distance"), lost);
  *lines_ << text << "\n  it is   " << policy
          << "\n  fly it  ./stg run medium scenario:=" << (folder / "scenario.yaml").string()
          << " policy:=" << policy << std::endl;
  if (lost >= kPoor) {
    *lines_ << "  it is a poor policy: a target is lost in " << std::lround(100.0 * lost)
            << " % of the last part of its episodes; evaluate a controller beside it, such as "
               "--policy encircle in open water, pursuit_separated elsewhere"
            << std::endl;
  }
}

void TrainLog::WriteSummary(const std::vector<NetworkSize>& networks, int workers,
                            double peak_flops, const std::string& stopped,
                            const Communicator& ranks) const {
  nlohmann::ordered_json json;
  json["stopped"] = stopped;
  json["env_steps"] = env_steps_;
  json["wall_seconds"] = wall_seconds_;
  json["env_steps_per_second"] = static_cast<double>(env_steps_) / std::max(wall_seconds_, 1e-9);
  json["workers"] = workers;
  for (const NetworkSize& network : networks) json["parameters"][network.name] = network.parameters;
  const Communicator::Traffic& traffic = ranks.traffic();
  json["ranks"] = ranks.size();
  json["communication"] = {
      {"bytes_sent", traffic.bytes}, {"calls", traffic.calls}, {"seconds", traffic.seconds}};
  for (const char* name : {"no_loss", "1000", "1020", "1030", "1040"}) {
    const auto found = reached_.find(name);
    if (found == reached_.end()) {
      json["time_to_threshold"][name] = nullptr;
    } else {
      json["time_to_threshold"][name] = {{"seconds", found->second.seconds},
                                         {"env_steps", found->second.steps}};
    }
  }
  json["last_validation"] = last_validation_;
  json["best_validation"] = best_validation_;
  const double known = env_seconds_ + inference_seconds_ + update_seconds_ + validation_seconds_;
  json["phase_seconds"] = {{"environment", env_seconds_},
                           {"inference", inference_seconds_},
                           {"update", update_seconds_},
                           {"validation", validation_seconds_},
                           {"other", std::max(wall_seconds_ - known, 0.0)}};
  json["update_flops_per_env_step"] =
      update_flops_ / static_cast<double>(std::max<std::int64_t>(env_steps_, 1));
  const double rate = update_flops_ / std::max(update_seconds_, 1e-9);
  json["update_gflops"] = rate * 1e-9;
  json["peak_sgemm_gflops"] = peak_flops * 1e-9;
  json["update_share_of_peak"] = rate / peak_flops;
  WriteDurably(json.dump(2) + "\n", out_ + "/summary.json", "the summary");
}

std::string TrainLog::Save() const {
  nlohmann::json json;
  for (const auto& [name, moment] : reached_)
    json["reached"][name] = {moment.seconds, moment.steps};
  json["last"] = last_validation_;
  json["best"] = best_validation_;
  json["best_steps"] = best_steps_;
  json["seconds"] = {env_seconds_,        inference_seconds_, update_seconds_,
                     validation_seconds_, update_flops_,      wall_seconds_};
  json["env_steps"] = env_steps_;
  return json.dump();
}

void TrainLog::Load(const std::string& text) {
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.contains("reached")) {
      for (const auto& [name, value] : json.at("reached").items()) {
        Moment& moment = reached_[name];
        moment.seconds = value.at(0).get<double>();
        TakeJson(value.at(1), &moment.steps);
      }
    }
    json.at("last").get_to(last_validation_);
    json.at("best").get_to(best_validation_);
    const auto& s = json.at("seconds");
    env_seconds_ = s.at(0).get<double>();
    inference_seconds_ = s.at(1).get<double>();
    update_seconds_ = s.at(2).get<double>();
    validation_seconds_ = s.at(3).get<double>();
    update_flops_ = s.at(4).get<double>();
    wall_seconds_ = s.at(5).get<double>();
    TakeMember(json, "env_steps", &env_steps_);
    if (json.contains("best_steps")) TakeMember(json, "best_steps", &best_steps_);
  } catch (const std::exception& error) {
    throw UserError(std::string("checkpoint: the log cannot be read: ") + error.what());
  }
}

}  // namespace stg::learn
