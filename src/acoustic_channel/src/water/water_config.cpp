#include "acoustic_channel/water/water_config.hpp"

#include <string>
#include <vector>

namespace stg::acoustics {

void Describe(WaterConfig* c, config::Table* t) {
  t->Section("water");
  t->Add("surface_z_m", &c->surface_z_m, config::Within(-1e4, 1e4), "m, world",
         "height of the water's surface, from which depths are measured");
  t->Add("depth_m", &c->depth_m, config::Positive(1e6), "m",
         "depth of the flat bottom, which reflects sound where propagation.paths is above 1");
  t->Add("temperature_c", &c->temperature_c, config::Within(-2.0, 30.0), "deg C",
         "of the water, for sound speed and for absorption by francois_garrison");
  t->Add("salinity_psu", &c->salinity_psu, config::Within(25.0, 40.0), "psu",
         "of the water, for sound speed and for absorption by francois_garrison");
  t->Add("ph", &c->ph, config::Within(7.0, 9.0), "-",
         "of the water, for absorption by francois_garrison");
  t->AddOptional("sound_speed", config::Enum(&c->sound_speed, {"mackenzie", "profile"}),
                 "mackenzie", config::kNone, "-",
                 "by Mackenzie's equation of temperature, salinity and depth, or a profile");
  t->Add("profile_depths_m", config::Numbers(&c->profile_depths_m), config::NonNegative(12000.0),
         "m", "profile: depths of its knots, ascending; linear between, constant outside");
  t->Add("profile_speeds_mps", config::Numbers(&c->profile_speeds_mps),
         config::Within(1300.0, 1700.0), "m/s", "profile: sound speed at its knots");
  t->AddOptional(
      "absorption", config::Enum(&c->absorption, {"thorp", "francois_garrison"}), "thorp",
      config::kNone, "-",
      "formula of the absorption of sound; thorp is for 4 deg C, whatever the temperature");
  const std::string water = "channel.physical.water.";
  const std::string speed = water + "sound_speed", absorption = water + "absorption";
  const auto chosen = [c] {
    return std::vector<std::string>{
        c->sound_speed == WaterConfig::SoundSpeed::kProfile ? "profile" : "mackenzie",
        c->absorption == WaterConfig::Absorption::kThorp ? "thorp" : "francois_garrison"};
  };
  for (const char* key : {"temperature_c", "salinity_psu"}) {
    t->Own(water + key,
           {"formula", {"mackenzie", "francois_garrison"}, speed, chosen, {absorption}});
  }
  t->Own(water + "ph", {"absorption", {"francois_garrison"}, absorption, [chosen] {
                          return std::vector<std::string>{chosen().back()};
                        }});
  for (const char* key : {"profile_depths_m", "profile_speeds_mps"}) {
    t->Own(water + key, {"sound speed", {"profile"}, speed, [chosen] {
                           return std::vector<std::string>{chosen().front()};
                         }});
  }
}

std::optional<config::Violation> FindConflict(const WaterConfig& c) {
  for (std::size_t i = 1; i < c.profile_depths_m.size(); ++i) {
    if (c.profile_depths_m[i] <= c.profile_depths_m[i - 1]) {
      return config::Violation{{"channel.physical.water.profile_depths_m"}, "depths must ascend"};
    }
  }
  return {};
}

}  // namespace stg::acoustics
