#include "classic_header.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

/// Reads the header's big-endian numbers in order. bad() is true after a read beyond the end.
class HeaderReader {
 public:
  explicit HeaderReader(const std::string& path)
      : in_(path, std::ios::binary), bytes_(std::filesystem::file_size(path)) {}

  /// Version 1, 2 or 5; 0: the file is no classic file.
  int Version() {
    char magic[4] = {};
    in_.read(magic, 4);
    if (!in_ || magic[0] != 'C' || magic[1] != 'D' || magic[2] != 'F') return 0;
    version_ = static_cast<unsigned char>(magic[3]);
    return version_ == 1 || version_ == 2 || version_ == 5 ? version_ : 0;
  }
  bool bad() const { return !in_; }
  void Fail() { in_.setstate(std::ios::failbit); }
  std::uint64_t Number(int bytes) {
    std::uint64_t value = 0;
    for (int k = 0; k < bytes; ++k) {
      const int byte = in_.get();
      value = value << 8 | static_cast<std::uint64_t>(byte & 0xff);
    }
    return value;
  }
  /// Reads a count, a length or a size.
  std::uint64_t Count() { return Number(version_ == 5 ? 8 : 4); }
  /// Reads the number of items that follow, each with this size in the file.
  std::uint64_t CountOf(std::uint64_t bytes_each) {
    const std::uint64_t count = Count();
    if (count > bytes_ / bytes_each) Fail();
    return bad() ? 0 : count;
  }
  /// Reads an offset in the file.
  std::uint64_t Offset() { return Number(version_ == 1 ? 4 : 8); }
  void SkipPadded(std::uint64_t bytes) {
    if (bytes > bytes_) Fail();
    if (in_) in_.ignore(static_cast<std::streamsize>((bytes + 3) / 4 * 4));
    if (in_.peek() == std::ifstream::traits_type::eof()) Fail();
  }
  void SkipName() { SkipPadded(Count()); }
  /// Reads a type. Returns the size of its values in bytes.
  std::uint64_t SizeOfType() {
    static constexpr std::uint64_t kSizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    const std::uint64_t type = Number(4);
    if (type == 0 || type >= std::size(kSizes)) Fail();
    return bad() ? 0 : kSizes[type];
  }
  void SkipAttributes() {
    Number(4);  // tag
    const std::uint64_t count = CountOf(12);
    for (std::uint64_t k = 0; k < count && !bad(); ++k) {
      SkipName();
      const std::uint64_t bytes = SizeOfType(), values = CountOf(1);
      if (!bad()) SkipPadded(values * bytes);
    }
  }

 private:
  std::ifstream in_;
  std::uint64_t bytes_;  // size of the file
  int version_ = 0;
};

}  // namespace

std::optional<std::uint64_t> SmallestClassicSize(const std::string& path) {
  HeaderReader header(path);
  if (header.Version() == 0) return {};
  header.Count();  // records
  header.Number(4);
  const std::uint64_t dimensions = header.CountOf(8);
  std::uint64_t unlimited = UINT64_MAX;
  for (std::uint64_t k = 0; k < dimensions && !header.bad(); ++k) {
    header.SkipName();
    if (header.Count() == 0) unlimited = k;
  }
  header.SkipAttributes();
  header.Number(4);
  const std::uint64_t variables = header.CountOf(28);
  std::uint64_t size = 0;
  for (std::uint64_t k = 0; k < variables && !header.bad(); ++k) {
    header.SkipName();
    const std::uint64_t rank = header.CountOf(4);
    bool record = false;
    for (std::uint64_t d = 0; d < rank && !header.bad(); ++d) {
      const std::uint64_t dimension = header.Count();
      if (dimension >= dimensions) header.Fail();
      record = dimension == unlimited || record;
    }
    header.SkipAttributes();
    header.SizeOfType();
    const std::uint64_t bytes = header.Count(), begin = header.Offset();
    // Sizes are rounded up to four bytes, but the file may end earlier. The sizes of very large
    // variables do not fit into their field.
    if (!record && !header.bad() && bytes >= 4 && bytes < 0xfffffffcU) {
      size = std::max(size, begin + bytes - 3);
    }
  }
  if (header.bad()) throw UserError(path + ": damaged: its header does not fit the file");
  return size;
}

}  // namespace stg::dynamics
