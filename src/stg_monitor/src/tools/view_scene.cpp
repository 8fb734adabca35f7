/// Reads a resolved scenario from standard input. Writes the part that the browser's view draws, as
/// JSON in one line. This is for recordings of programs without a scenario, such as bags.
/// Exit status: 0 done, 2 the text is no scenario.

#include <exception>
#include <iostream>
#include <iterator>
#include <string>

#include "auv_common/config/loader.hpp"
#include "stg_env/record/scene.hpp"
#include "stg_env/scenario/scenario.hpp"

int main() {
  try {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    const auto scenario =
        stg::config::LoadText<stg::Scenario>(text, "the scenario", stg::config::Unread::kPassOver);
    std::cout << stg::env::SceneOf(scenario.judge(), scenario.channel).dump() << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "view_scene: " << e.what() << "\n";
    return 2;
  }
}
