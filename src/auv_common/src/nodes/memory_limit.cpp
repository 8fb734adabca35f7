#include "auv_common/nodes/memory_limit.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace stg::nodes {
namespace {

/// Unmaps the pages of programs and libraries that equal their files. The next use of a page maps
/// it again from the system's copy of the file. A mapping with a page that this process has
/// changed, such as a table of addresses that the loader filled, stays as it is.
void ReturnFilePages() {
  std::ifstream mappings("/proc/self/smaps");
  void *begin = nullptr, *end = nullptr;
  bool unchanged = false;
  for (std::string line; std::getline(mappings, line);) {
    const auto is = [&](const char* field) { return line.rfind(field, 0) == 0; };
    std::uint64_t inode = 0;
    char rights[5] = "";
    if (line.find(':') > line.find('-')) {  // the first line of a mapping
      const int read =
          std::sscanf(line.c_str(), "%p-%p %4s %*x %*s %" SCNu64, &begin, &end, rights, &inode);
      unchanged = read == 4 && inode != 0 && rights[1] != 'w';
    } else if (is("Anonymous:") || is("Swap:")) {
      unchanged = unchanged && std::strtoull(line.c_str() + line.find(':') + 1, nullptr, 10) == 0;
    } else if (is("VmFlags:") && unchanged) {  // the last line of a mapping
      const auto size = static_cast<char*>(end) - static_cast<char*>(begin);
      madvise(begin, static_cast<std::size_t>(size), MADV_DONTNEED);
    }
  }
}

}  // namespace

void LimitMemory(std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  (void)bytes;  // sanitizers reserve terabytes of addresses
#else
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, bytes);
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

void ReturnFreeMemory() {
  malloc_trim(0);
  ReturnFilePages();
}

}  // namespace stg::nodes
