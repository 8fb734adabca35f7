// The entry point of libFuzzer. STG_FUZZ_TARGET names the loader that takes the inputs.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "target.hpp"

namespace {

const stg::fuzz::Target& Wanted() {
  const char* name = std::getenv("STG_FUZZ_TARGET");
  for (const stg::fuzz::Target& target : stg::fuzz::kTargets) {
    if (name != nullptr && std::strcmp(name, target.name) == 0) return target;
  }
  std::fprintf(stderr, "STG_FUZZ_TARGET must be one of");
  for (const stg::fuzz::Target& target : stg::fuzz::kTargets) {
    std::fprintf(stderr, " %s", target.name);
  }
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const stg::fuzz::Target& target = Wanted();
  target.run(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
