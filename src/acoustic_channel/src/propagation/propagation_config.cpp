#include "acoustic_channel/propagation/propagation_config.hpp"

namespace stg::acoustics {

void Describe(PropagationConfig* c, config::Table* t) {
  t->Section("propagation");
  t->Add("spreading", &c->spreading, config::Within(0.5, 3.0), "-",
         "k of the spreading loss 10 k lg d of every path; with several paths best 2");
  t->Add("paths", &c->paths, config::Within(1, 1024), "-",
         "paths of sound that count: the straight one, then reflections at surface and "
         "bottom in their order");
  t->Add("rician_k", &c->rician_k, config::NonNegative(1e9), "-",
         "direct over scattered power for the fading of a packet, where paths is 1; "
         "otherwise it follows from the paths");
  t->Add("wave_height_rms_m", &c->wave_height_rms_m, config::NonNegative(10.0), "m",
         "waves, which weaken what the surface reflects");
  t->Add("bottom_density_ratio", &c->bottom_density_ratio, config::Within(0.1, 10.0), "-",
         "density of the bottom over the water's");
  t->Add("bottom_speed_ratio", &c->bottom_speed_ratio, config::Within(0.1, 10.0), "-",
         "sound speed of the bottom over the water's");
  t->Add("bottom_loss_db", &c->bottom_loss_db, config::NonNegative(20.0), "dB/wavelength",
         "absorption in the bottom");
  t->Add("shadow_db", &c->shadow_db, config::NonNegative(300.0), "dB",
         "lost where terrain or an obstacle is in the line");
  t->Add("shadowing_db", &c->shadowing_db, config::NonNegative(40.0), "dB",
         "standard deviation of the slow fading of a link");
  t->Add("shadowing_time_s", &c->shadowing_time_s, config::Positive(1e6), "s",
         "in which the autocorrelation of the slow fading falls to 1/e");
}

}  // namespace stg::acoustics
