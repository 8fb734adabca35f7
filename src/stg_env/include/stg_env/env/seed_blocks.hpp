#pragma once

#include <cstdint>
#include <limits>
#include <string>

/// Purposes of seeds. A reported result of something chosen must come from episodes that no choice
/// has used.
namespace stg::env {

/// Seeds from `first` to `last`, inclusive.
struct SeedBlock {
  const char* name;
  std::uint64_t first, last;
};

/// For choices of hyperparameters, constants of controllers, policies and checkpoints. The seeds of
/// the paper's protocol (3000 + 10000 k), and comparisons with it, are in this block, too.
inline constexpr SeedBlock kChoosingSeeds{"choosing", 0, 999'999};
/// For reported results: no choice uses these seeds.
inline constexpr SeedBlock kReportingSeeds{"reporting", 5'000'000, 5'999'999};
/// For training, a billion for each seed of a training; see learn::TrainingSeed.
inline constexpr SeedBlock kTrainingSeeds{"training", 1'000'000'000,
                                          std::numeric_limits<std::uint64_t>::max()};

/// Name of the block that contains all `count` seeds from `first` on; "no" if there is none.
inline std::string SeedBlockOf(std::uint64_t first, std::uint64_t count) {
  const std::uint64_t last = first + (count > 0 ? count - 1 : 0);
  for (const SeedBlock& block : {kChoosingSeeds, kReportingSeeds, kTrainingSeeds}) {
    if (first >= block.first && last <= block.last && last >= first) return block.name;
  }
  return "no";
}

}  // namespace stg::env
