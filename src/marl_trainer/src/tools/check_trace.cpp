#include <iostream>
#include <nlohmann/json.hpp>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "stg_env/env/trace.hpp"
#include "stg_env/scenario/scenario.hpp"

/// Replays golden traces. The last line is JSON. Exit status 1: beyond the tolerance; 2: unusable
/// input.
int main(int argc, char** argv) {
  stg::CommandLine app(
      "check_trace",
      "Replays a trace of the release's simulator in this simulator and compares every column");
  std::vector<std::string> folders;
  std::string scenario = "medium_release";
  double tolerance = 1e-5;
  app.Add("folder", &folders, "folder with config.yaml and steps.csv").Required();
  app.Add("--scenario", &scenario,
          "scenario that gives the settings missing in the trace's config.yaml")
      .ShowDefault();
  app.Add("--tolerance", &tolerance, "largest absolute error allowed").ShowDefault();
  return app.Run(argc, argv, [&] {
    stg::CheckOption("--tolerance", tolerance, 0.0, 1e6);
    const stg::Scenario base = stg::LoadNamedScenario(stg::config::ScenarioFolder(), scenario);
    double worst = 0.0;
    nlohmann::json traces = nlohmann::json::array();
    for (const auto& folder : folders) {
      const stg::env::TraceError e =
          stg::env::ReplayTrace(stg::env::LoadTrace(folder, base), tolerance);
      worst = std::max(worst, e.max_abs_error);
      traces.push_back(
          {{"trace", folder},
           {"max_abs_error", e.max_abs_error},
           {"by_group", e.by_group},
           {"steps", e.steps},
           {"worst",
            {{"column", e.worst_column}, {"step", e.worst_step}, {"agent", e.worst_agent}}}});
      for (const auto& [column, error] : e.by_column) {
        if (!(error <= tolerance)) std::cout << "  " << column << ": " << error << "\n";
      }
      if (e.first_bad_step >= 0) {
        std::cout << "  first past " << tolerance << ": " << e.first_bad_column << ", step "
                  << e.first_bad_step << "\n";
      }
      std::cout << folder << ": " << e.steps << " steps, largest error " << e.max_abs_error << " ("
                << e.worst_column << ", step " << e.worst_step << ", agent " << e.worst_agent
                << ")\n";
    }
    stg::PrintResult(nlohmann::json{{"max_abs_error", worst},
                                    {"tolerance", tolerance},
                                    {"pass", worst <= tolerance},
                                    {"traces", traces}});
    return worst <= tolerance ? 0 : 1;
  });
}
