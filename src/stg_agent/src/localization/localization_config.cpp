#include "stg_agent/localization/localization_config.hpp"

#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {

using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Positive;

namespace {

void DescribeRanges(LocalizationConfig* c, config::Table* t) {
  t->Add("current_std_mps", &c->current_std_mps, Positive(10), "m/s, world ENU",
         "standard deviation of each component of the current that all AUVs share");
  t->Add("current_memory_s", &c->current_memory_s, Positive(1e7), "s",
         "correlation time of that current");
  t->Add("shear_std_mps", &c->shear_std_mps, NonNegative(10), "m/s, world ENU",
         "standard deviation of each component of the difference between an AUV's own current and "
         "the shared one");
  t->Add("shear_memory_s", &c->shear_memory_s, Positive(1e7), "s",
         "correlation time of this difference");
  t->Add("shear_depth_m", &c->shear_depth_m, Positive(1e5), "m",
         "change of depth over which this difference loses its correlation");
  t->Add("reckoning_std_m", &c->reckoning_std_m, Positive(1e3), "m",
         "standard deviation of the error that log and heading add to each component of the "
         "reckoned position per second");
  t->Add("range_std_m", &c->range_std_m, Positive(1e4), "m",
         "standard deviation of a range from a travel time");
  t->Add("late_share", &c->late_share, kFraction, "-",
         "share of ranges that are of a later arrival, not of the first, and so too long");
  t->Add("late_max_m", &c->late_max_m, Positive(1e5), "m", "largest error of such a range");
  t->Add("sound_speed_std", &c->sound_speed_std, NonNegative(0.1), "-",
         "standard deviation of the relative error of the sound speed, which all ranges share");
  t->Add("gate_sigma", &c->gate_sigma, Positive(1e3), "-",
         "the localizer rejects ranges farther off than so many standard deviations");
  t->AddOptional("by", config::Enum(&c->by, {"one_way", "ping"}), "one_way", kNone, "-",
                 "source of the ranges. one_way: travel times of packets, by the clocks of both "
                 "modems; ping: pings of the AUVs, by the clock of the pinging modem alone");
  t->AddOptional("ping_period_s", &c->ping_period_s, "30.0", Positive(1e5), "s",
                 "time between two pings of an AUV, whole decisions; it pings the other AUVs and "
                 "the stations in turn");
  t->AddOptional("clocks", config::Enum(&c->clocks, {"known", "estimated"}), "known", kNone, "-",
                 "use of the modems' clocks by travel times. known: they are taken to be right; "
                 "estimated: the localizer estimates the offset and the rate of the clock of each "
                 "AUV and beacon, which it takes to be as good as the modems' keys state");
  t->AddOptional(
      "usbl_std_deg", &c->usbl_std_deg, "0.0", config::Within(0.0, 30.0), "deg",
      "standard deviation, in each direction across the line of sight, of the direction "
      "of a received packet or answer that an AUV measures with an ultra-short baseline; the "
      "heading of its navigation adds its own error; 0: AUVs measure no directions");
  t->AddOptional(
      "surface_std_m", &c->surface_std_m, "0.0", NonNegative(1e6), "m, world ENU",
      "an AUV surfaces for a GPS fix before the standard deviation of its own position is "
      "above this; 0: never");
}

}  // namespace

void Describe(LocalizationConfig* c, config::Table* t) {
  t->Section("localization");
  t->AddOptional("kind", config::Name(&c->kind, Localizers().Names()), "uncorrected", kNone, "-",
                 "correction of the AUVs' reckoned positions. uncorrected: none; ranges: by ranges "
                 "to each other and to stations");
  const auto chosen = [c] { return std::vector<std::string>{c->kind}; };
  t->Thing({"localizer", {"ranges"}, "localization.kind", chosen}, "localization.ranges", c,
           DescribeRanges);
  Localizers().Describe("localization", "localization.kind", chosen, &c->kinds, t);
  const auto by = [c] {
    return std::vector<std::string>{c->by == RangesBy::kPing ? "ping" : "one_way"};
  };
  t->Own("localization.ranges.ping_period_s",
         {"source of ranges", {"ping"}, "localization.ranges.by", by});
  t->Own("localization.ranges.clocks",
         {"source of ranges", {"one_way"}, "localization.ranges.by", by});
  const std::string ranges = "localization.ranges.";
  t->Own(ranges + "late_max_m",
         {"late ranges", {"on"}, ranges + "late_share", [c] {
            return std::vector<std::string>{c->late_share > 0.0 ? "on" : "off"};
          }});
  for (const char* key : {"shear_memory_s", "shear_depth_m"}) {
    t->Own(ranges + key, {"shear", {"on"}, ranges + "shear_std_mps", [c] {
                            return std::vector<std::string>{c->shear_std_mps > 0.0 ? "on" : "off"};
                          }});
  }
}

}  // namespace stg::agent
