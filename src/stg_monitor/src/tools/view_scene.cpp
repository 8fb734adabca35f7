/// Reads a resolved scenario from standard input and writes what of it the browser's view draws, as
/// JSON in one line: for recordings whose program had no scenario at hand, such as bags.
/// Exit status: 0 done, 2 the text is no scenario.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>

#include "auv_common/error.hpp"
#include "stg_env/record/scene.hpp"

namespace {

/// A file of its own for the scenario, which the loader reads from files only.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() /
            ("stg_scenario_" + std::to_string(random()) + std::to_string(random()) + ".yaml");
    std::ofstream out(path_);
    if (!(out << text).flush()) throw stg::UserError(path_.string() + ": cannot be written");
  }
  ~TemporaryFile() {
    std::error_code error;
    std::filesystem::remove(path_, error);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace

int main() {
  try {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    const TemporaryFile file(text);
    std::cout << stg::env::SceneOf(stg::LoadScenario(file.path())).dump() << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "view_scene: " << e.what() << "\n";
    return 2;
  }
}
