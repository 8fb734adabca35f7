#include "acoustic_channel/propagation/propagation_config.hpp"

namespace stg::acoustics {

void Describe(PropagationConfig* c, config::Table* t) {
  t->Section("channel.propagation");
  t->AddOptional("spreading", &c->spreading, "1.5", config::Within(0.5, 3.0), "-",
                 "k of the spreading loss 10 k lg d of every path; with several paths best 2");
  t->AddOptional("paths", &c->paths, "1", config::Within(1, 1024), "-",
                 "paths of sound that count: the straight one, then reflections at surface and "
                 "bottom in their order");
  t->AddOptional("rician_k", &c->rician_k, "10.0", config::NonNegative(1e9), "-",
                 "direct over scattered power for the fading of a packet, where paths is 1; "
                 "otherwise it follows from the paths");
  t->AddOptional("wave_height_rms_m", &c->wave_height_rms_m, "0.1", config::NonNegative(10.0), "m",
                 "waves, which weaken what the surface reflects");
  t->AddOptional("bottom_density_ratio", &c->bottom_density_ratio, "1.9", config::Within(0.1, 10.0),
                 "-", "density of the bottom over the water's");
  t->AddOptional("bottom_speed_ratio", &c->bottom_speed_ratio, "1.1", config::Within(0.1, 10.0),
                 "-", "sound speed of the bottom over the water's");
  t->AddOptional("bottom_loss_db", &c->bottom_loss_db, "0.8", config::NonNegative(20.0),
                 "dB/wavelength", "absorption in the bottom");
  t->AddOptional("shadow_db", &c->shadow_db, "30.0", config::NonNegative(300.0), "dB",
                 "lost where terrain or an obstacle is in the line");
  t->AddOptional("shadowing_db", &c->shadowing_db, "3.0", config::NonNegative(40.0), "dB",
                 "standard deviation of the slow fading of a link");
  t->AddOptional("shadowing_time_s", &c->shadowing_time_s, "10.0", config::Positive(1e6), "s",
                 "in which the autocorrelation of the slow fading falls to 1/e");
}

}  // namespace stg::acoustics
