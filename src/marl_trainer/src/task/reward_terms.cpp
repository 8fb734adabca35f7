#include "terms.hpp"

namespace stg::task {

RewardTermRegistry& RewardTermsByName() {
  static RewardTermRegistry registry("reward term", {
                                                        {"effort", MakeEffortTerm},
                                                    });
  return registry;
}

}  // namespace stg::task
