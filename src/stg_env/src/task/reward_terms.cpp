#include "terms.hpp"

namespace stg::task {

RewardTermRegistry& RewardTermsByName() {
  static RewardTermRegistry registry("reward term", {
                                                        {"effort", MakeEffortTerm},
                                                        {"energy", MakeEnergyTerm},
                                                        {"estimate", MakeEstimateTerm},
                                                        {"obstacle", MakeObstacleTerm},
                                                        {"seabed", MakeSeabedTerm},
                                                        {"spread", MakeSpreadTerm},
                                                    });
  return registry;
}

}  // namespace stg::task
