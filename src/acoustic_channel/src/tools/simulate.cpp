#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "acoustic_channel/log/packet_log.hpp"
#include "acoustic_channel/offline/simulation.hpp"
#include "acoustic_channel/offline/simulation_file.hpp"
#include "auv_common/command_line.hpp"
#include "auv_common/config/yaml_tree.hpp"
#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "auv_common/folder_lock.hpp"
#include "auv_common/program.hpp"
#include "auv_common/stop_signals.hpp"

namespace {

using stg::acoustics::SimulationFile;
using stg::acoustics::SimulationSummary;

void MakeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error)) {
    throw stg::UserError(folder + ": cannot be written");
  }
}

/// packets.csv while it is being written. The file of an earlier simulation stays until Commit.
class PacketFile {
 public:
  /// Opens an empty file. Throws UserError if this fails.
  PacketFile(const std::string& folder, const std::vector<std::string>& nodes)
      : file_(folder + "/packets.csv", "the packets"),
        out_(file_.temporary()),
        log_(&out_, static_cast<int>(nodes.size()), nodes) {
    if (!out_) file_.Fail(std::strerror(errno));
  }
  stg::acoustics::PacketLog* log() { return &log_; }
  /// Throws UserError if rows were lost, because it is useless to continue.
  void Check() const {
    if (!out_) file_.Fail("rows are lost, is the disk full?");
  }
  void Commit() {
    out_.close();
    Check();
    file_.Commit();
  }

 private:
  stg::DurableFile file_;
  std::ofstream out_;
  stg::acoustics::PacketLog log_;
};

/// Removes a file of an earlier simulation. Together with the new summary it would be taken for a
/// new one.
void Remove(const std::string& folder, const std::string& name) {
  std::error_code error;
  std::filesystem::remove(std::filesystem::path(folder) / name, error);
  if (error) throw stg::UserError(folder + "/" + name + ": cannot be removed");
}

/// Contents of the tracks, by name. Tracks in other folders are not included, because the copy of
/// the simulation refers to them as the original file does.
std::map<std::string, std::string> ReadTracks(const SimulationFile& file, const std::string& path) {
  std::map<std::string, std::string> texts;
  const auto folder = std::filesystem::path(path).parent_path();
  for (const auto& node : file.nodes) {
    const std::filesystem::path name = node.track_file;
    if (name.empty() || name != name.filename() || name == "packets.csv") continue;
    texts[name] = stg::config::ReadBoundedFile((folder / name).string());
  }
  return texts;
}

nlohmann::json ToJson(const SimulationSummary& s, const SimulationFile& file, bool whole) {
  using stg::acoustics::DropReason;
  const auto id = [&](int node) { return file.nodes[static_cast<std::size_t>(node)].id; };
  nlohmann::json drops = nlohmann::json::object();
  for (std::size_t r = 1; r < s.drops.size(); ++r) {
    if (s.drops[r] > 0) {
      drops[stg::acoustics::ToString(static_cast<DropReason>(r))] = s.drops[r];
    }
  }
  nlohmann::json receivers = nlohmann::json::array(), links = nlohmann::json::array();
  nlohmann::json energy = nlohmann::json::object();
  for (std::size_t i = 0; i < s.receivers.size(); ++i) {
    receivers.push_back({{"id", id(static_cast<int>(i))},
                         {"delivered", s.receivers[i].delivered},
                         {"throughput", s.receivers[i].throughput}});
    energy[std::to_string(id(static_cast<int>(i)))] = s.energy_j[i];
  }
  for (const auto& link : s.links) {
    links.push_back({{"source", id(link.source)},
                     {"destination", id(link.destination)},
                     {"delivered", link.delivered},
                     {"average_age_s", link.average_age_s},
                     {"peak_age_s", link.peak_age_s}});
  }
  const double ratio =
      s.expected == 0 ? 0.0 : static_cast<double>(s.delivered) / static_cast<double>(s.expected);
  return {{"model", file.channel.model},
          {"access", file.channel.access},
          {"duration_s", s.duration_s},
          {"finished", whole},
          {"offered", s.offered},
          {"transmitted", s.transmitted},
          {"delivered", s.delivered},
          {"in_flight", s.in_flight},
          {"drops", drops},
          {"delivery_ratio", ratio},
          {"receivers", receivers},
          {"links", links},
          {"energy_j", energy}};
}

/// Shows the progress on a terminal, twice per second of wall time.
class Progress {
 public:
  Progress(double duration_s, bool on) : duration_s_(duration_s), on_(on) {}
  void At(double t_s) {
    const auto now = Clock::now();
    if (!on_ || now - shown_ < std::chrono::milliseconds(500)) return;
    shown_ = now;
    const double wall_s = std::chrono::duration<double>(now - start_).count();
    std::fprintf(stderr, "\r%.0f / %.0f s, %.0f times real time   ", t_s, duration_s_,
                 t_s / wall_s);
    drawn_ = true;
  }
  ~Progress() {
    if (drawn_) std::fprintf(stderr, "\n");
  }

 private:
  using Clock = std::chrono::steady_clock;
  double duration_s_;
  bool on_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), shown_ = start_;
};

/// Exit status: 0, or kStopped if it was interrupted. Results of an earlier simulation in the
/// folder stay until this one is complete.
int Simulate(const std::string& path, const std::string& folder, bool quiet, bool log_packets,
             const std::atomic<int>& stop) {
  const SimulationFile file = stg::acoustics::LoadSimulation(path);
  std::vector<std::string> names;
  for (const auto& node : file.nodes) names.push_back(std::to_string(node.id));
  MakeFolder(folder);
  const stg::FolderLock lock(folder);
  const std::string input = stg::config::ReadBoundedFile(path);
  const auto tracks = ReadTracks(file, path);

  std::optional<PacketFile> packets;
  if (log_packets) packets.emplace(folder, names);
  const auto start = std::chrono::steady_clock::now();
  stg::acoustics::Simulation simulation(file, packets ? packets->log() : nullptr);
  bool whole = true;
  {
    Progress progress(file.duration_s, !quiet && isatty(STDERR_FILENO) != 0);
    while (simulation.Step()) {
      if (packets) packets->Check();
      if (stop != 0) {
        whole = false;
        break;
      }
      progress.At(simulation.time_s());
    }
  }
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const SimulationSummary summary = simulation.Summary();
  const nlohmann::json json = ToJson(summary, file, whole);
  if (packets) {
    packets->Commit();
  } else {
    Remove(folder, "packets.csv");
  }
  stg::WriteDurably(input, folder + "/simulation.yaml", "the copy of the simulation");
  for (const auto& [name, text] : tracks) {
    stg::WriteDurably(text, folder + "/" + name, "the copy of a track");
  }
  stg::WriteDurably(json.dump(1) + "\n", folder + "/summary.json", "the summary");
  if (!quiet) {
    std::printf("%s: %zu nodes, %.1f s of %s with %s in %.2f s%s\n", path.c_str(), names.size(),
                summary.duration_s, file.channel.model.c_str(), file.channel.access.c_str(), wall_s,
                whole ? "" : " (interrupted)");
    std::printf("  offered %llu packets, transmitted %llu, delivered %llu of %llu receptions\n",
                static_cast<unsigned long long>(summary.offered),
                static_cast<unsigned long long>(summary.transmitted),
                static_cast<unsigned long long>(summary.delivered),
                static_cast<unsigned long long>(summary.expected));
    for (const auto& [reason, count] : json["drops"].items()) {
      std::printf("  dropped, %s: %s receptions\n", reason.c_str(), count.dump().c_str());
    }
  }
  try {
    stg::PrintResult(json);
  } catch (const stg::UserError&) {
    // Everything is written, and after the terminal was closed there may be no reader.
    if (whole) throw;
  }
  return whole ? 0 : stg::kStopped;
}

}  // namespace

/// Simulates a network with nodes, motion and traffic from a file. Writes a packet log as CSV; the
/// last line is the summary as one JSON object.
int main(int argc, char** argv) {
  stg::CommandLine app(
      "simulate",
      "Runs an acoustic network from a file (docs/simulate.md) and writes DIR/packets.csv, "
      "DIR/summary.json and a copy of the file. The last line printed is the summary as JSON.");
  std::string path, folder;
  bool quiet = false, summary_only = false;
  app.Add("file", &path, "YAML file: duration_s, seed, channel, nodes, traffic").Required();
  app.Add("--out", &folder, "folder for the results, created if necessary").Required();
  app.Add("--quiet", &quiet, "print only the summary");
  app.Add("--summary-only", &summary_only, "do not write packets.csv, and remove an existing one");
  app.AddPlugins();
  const std::atomic<int>& stop = stg::HeedStopSignals();
  return app.Run(argc, argv, [&] { return Simulate(path, folder, quiet, !summary_only, stop); });
}
