#pragma once

#include <cstdint>
#include <limits>
#include <string>

/// Which seeds are for what. A figure that is reported of something that was chosen must come from
/// episodes that no choice has seen.
namespace stg::env {

/// Seeds from `first` to `last`; both are in it.
struct SeedBlock {
  const char* name;
  std::uint64_t first, last;
};

/// To choose with: hyperparameters, constants of controllers, policies, checkpoints. The paper's
/// protocol (3000 + 10000 k), and so what is compared with it, lies here as well.
inline constexpr SeedBlock kChoosingSeeds{"choosing", 0, 999'999};
/// To report with: nothing is chosen by what happens here.
inline constexpr SeedBlock kReportingSeeds{"reporting", 5'000'000, 5'999'999};
/// To train with, a billion for each seed of a training; see learn::TrainingSeed.
inline constexpr SeedBlock kTrainingSeeds{"training", 1'000'000'000,
                                          std::numeric_limits<std::uint64_t>::max()};

/// Name of the block that holds `count` seeds from `first` on, or "no" where no block holds them
/// all.
inline std::string SeedBlockOf(std::uint64_t first, std::uint64_t count) {
  const std::uint64_t last = first + (count > 0 ? count - 1 : 0);
  for (const SeedBlock& block : {kChoosingSeeds, kReportingSeeds, kTrainingSeeds}) {
    if (first >= block.first && last <= block.last && last >= first) return block.name;
  }
  return "no";
}

}  // namespace stg::env
