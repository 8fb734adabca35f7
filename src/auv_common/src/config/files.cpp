#include "auv_common/config/files.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "auv_common/error.hpp"

namespace stg::config {
namespace {

namespace fs = std::filesystem;

bool IsPath(const std::string& name) {
  const std::string ending = ".yaml";
  return name.find('/') != std::string::npos ||
         (name.size() > ending.size() &&
          name.compare(name.size() - ending.size(), ending.size(), ending) == 0);
}

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// Names of the YAML files in a folder that begin with `prefix`, without this prefix.
std::set<std::string> NamesIn(const fs::path& folder, const std::string& prefix) {
  std::set<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string stem = it->path().stem().string();
    if (it->path().extension() == ".yaml" && stem.rfind(prefix, 0) == 0) {
      names.insert(stem.substr(prefix.size()));
    }
  }
  return names;
}

std::string ListOf(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// The sources of the workspace are at <entry>/stg_bringup, or at
/// <entry>/<repository>/src/stg_bringup if the repository was cloned into a larger workspace.
std::vector<fs::path> CandidatesUnder(const fs::path& entry) {
  std::vector<fs::path> candidates;
  if (entry.filename() == "stg_bringup") candidates.push_back(entry / "scenarios");
  candidates.push_back(entry / "stg_bringup" / "scenarios");
  std::error_code error;
  for (fs::directory_iterator it(entry, error), end; !error && it != end; it.increment(error)) {
    if (!IsFolder(it->path())) continue;
    candidates.push_back(it->path() / "stg_bringup" / "scenarios");
    candidates.push_back(it->path() / "src" / "stg_bringup" / "scenarios");
  }
  return candidates;
}

/// The folder of the scenarios in an installation, relative to its prefix.
constexpr char kInstalled[] = "share/stg_bringup/scenarios";

/// The folder of the library, program or Python module that contains this code.
fs::path FolderOfThisCode() {
  Dl_info info{};
  if (dladdr(kInstalled, &info) == 0) return {};
  std::error_code error;
  return fs::canonical(info.dli_fname, error).parent_path();
}

}  // namespace

std::string ScenarioFolder() {
  if (const char* folder = std::getenv("STG_SCENARIOS"); folder != nullptr && *folder != '\0') {
    if (!IsFolder(folder)) {
      throw UserError("STG_SCENARIOS: " + std::string(folder) + " is not a folder");
    }
    return folder;
  }
  const fs::path code = FolderOfThisCode();
  for (const fs::path& folder : {code, code.parent_path()}) {
    if (!folder.empty() && IsFolder(folder / kInstalled)) return (folder / kInstalled).string();
  }
  const char* package_path = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream entries(package_path != nullptr ? package_path : "");
  for (std::string entry; std::getline(entries, entry, ':');) {
    if (entry.empty()) continue;
    for (const fs::path& candidate : CandidatesUnder(entry)) {
      if (IsFolder(candidate)) return candidate.string();
    }
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (fs::path folder : {code, program}) {
    for (; folder.has_relative_path(); folder = folder.parent_path()) {
      for (const char* relative : {kInstalled, "src/stg_bringup/scenarios"}) {
        if (IsFolder(folder / relative)) return (folder / relative).string();
      }
    }
  }
  throw UserError(
      "no folder with scenarios found; tried STG_SCENARIOS (not set), stg_bringup/scenarios on "
      "ROS_PACKAGE_PATH (" +
      std::string(package_path != nullptr ? package_path : "not set") + "), " + kInstalled +
      " and src/stg_bringup/scenarios in the folders above " + code.string() + " and " +
      program.string());
}

std::vector<std::string> ConditionNames(const std::string& folder) {
  std::set<std::string> names;
  std::error_code error;
  const fs::path root = fs::path(folder) / "conditions";
  for (fs::recursive_directory_iterator it(root, error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().extension() != ".yaml") continue;
    const std::string stem = it->path().stem().string();
    names.insert(it.depth() > 0 ? stem : stem.substr(stem.find('_') + 1));
  }
  std::vector<std::string> all{"nominal"};
  all.insert(all.end(), names.begin(), names.end());
  return all;
}

Source NamedSource(const std::string& folder, const std::string& scenario,
                   const std::string& condition, const std::vector<std::string>& overrides) {
  const fs::path root(folder);
  const fs::path file = IsPath(scenario) ? fs::path(scenario) : root / (scenario + ".yaml");
  std::error_code error;
  if (!IsPath(scenario) && !fs::exists(file, error)) {
    throw UserError("scenario " + Quoted(scenario) + ": no file " + file.string() + "; there are " +
                    ListOf(NamesIn(root, "")));
  }
  if (condition == "nominal") return {file.string(), {}, overrides};
  if (IsPath(condition)) return {file.string(), {condition}, overrides};
  std::set<std::string> others;
  for (const std::string& name : NamesOfBases(file.string())) {
    const fs::path own = root / "conditions" / name;
    const fs::path overlay = own / (condition + ".yaml");
    if (fs::exists(overlay, error)) return {file.string(), {overlay.string()}, overrides};
    others.merge(NamesIn(own, ""));
  }
  const std::string stage = FindScalar(file.string(), "reset.stage").value_or("medium") + "_";
  const fs::path overlay = root / "conditions" / (stage + condition + ".yaml");
  if (!fs::exists(overlay, error)) {
    others.merge(NamesIn(root / "conditions", stage));
    throw UserError("condition " + Quoted(condition) + ": the scenario " + Quoted(scenario) +
                    " has no condition of this name; it has nominal, " + ListOf(others));
  }
  return {file.string(), {overlay.string()}, overrides};
}

}  // namespace stg::config
