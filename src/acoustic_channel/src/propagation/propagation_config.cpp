#include "acoustic_channel/propagation/propagation_config.hpp"

#include <string>
#include <utility>
#include <vector>

namespace stg::acoustics {

void Describe(PropagationConfig* c, config::Table* t) {
  t->Section("propagation");
  t->Add("spreading", &c->spreading, config::Within(0.5, 3.0), "-",
         "k of the spreading loss 10 k lg d of each path; use 2 with several paths");
  t->Add("paths", &c->paths, config::Within(1, 1024), "-",
         "number of sound paths: the direct one, then reflections at surface and bottom, in this "
         "order");
  t->Add("rician_k", &c->rician_k, config::NonNegative(1e9), "-",
         "ratio of direct to scattered power in the fading of a packet where paths is 1; otherwise "
         "the paths determine it");
  t->Add("wave_height_rms_m", &c->wave_height_rms_m, config::NonNegative(10.0), "m",
         "RMS height of the waves, which weaken the reflections at the surface");
  t->Add("bottom_density_ratio", &c->bottom_density_ratio, config::Within(0.1, 10.0), "-",
         "ratio of the bottom's density to the water's");
  t->Add("bottom_speed_ratio", &c->bottom_speed_ratio, config::Within(0.1, 10.0), "-",
         "ratio of the bottom's sound speed to the water's");
  t->Add("bottom_loss_db", &c->bottom_loss_db, config::NonNegative(20.0), "dB/wavelength",
         "absorption in the bottom");
  t->Add("shadow_db", &c->shadow_db, config::NonNegative(300.0), "dB",
         "loss where terrain or an obstacle blocks the direct line");
  t->Add("shadowing_db", &c->shadowing_db, config::NonNegative(40.0), "dB",
         "standard deviation of the slow fading of a link");
  t->Add("shadowing_time_s", &c->shadowing_time_s, config::Positive(1e6), "s",
         "time in which the autocorrelation of the slow fading falls to 1/e");
  const std::string section = "channel.physical.propagation.";
  const auto own = [&](const char* key, std::vector<std::string> names) {
    t->Own(section + key, {"sound paths", std::move(names), section + "paths", [c] {
                             std::vector<std::string> paths{"direct"};
                             if (c->paths == 1) return std::vector<std::string>{"direct alone"};
                             if (c->paths > 1) paths.emplace_back("surface");
                             if (c->paths > 2) paths.emplace_back("bottom");
                             return paths;
                           }});
  };
  own("rician_k", {"direct alone"});
  own("wave_height_rms_m", {"surface"});
  for (const char* key : {"bottom_density_ratio", "bottom_speed_ratio", "bottom_loss_db"}) {
    own(key, {"bottom"});
  }
  t->Own(section + "shadowing_time_s",
         {"slow fading", {"on"}, section + "shadowing_db", [c] {
            return std::vector<std::string>{c->shadowing_db > 0.0 ? "on" : "off"};
          }});
}

}  // namespace stg::acoustics
