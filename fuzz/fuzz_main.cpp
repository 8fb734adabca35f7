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

/// Counts the bytes of all inputs and prints the sum when the program ends.
class Bytes {
 public:
  ~Bytes() {
    std::fprintf(stderr, "stat::input_bytes: %llu\n", static_cast<unsigned long long>(sum_));
  }
  void Add(std::size_t size) { sum_ += size; }

 private:
  std::uint64_t sum_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const stg::fuzz::Target& target = Wanted();
  static Bytes bytes;
  bytes.Add(size);
  target.run(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
