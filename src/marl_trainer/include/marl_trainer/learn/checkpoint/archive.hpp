#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace stg::learn {

/// Named, typed arrays: the content of a checkpoint as plain data. Reading throws UserError that
/// names the array, so a file with other content is refused and never misread.
class Archive {
 public:
  using Array =
      std::variant<std::vector<float>, std::vector<double>, std::vector<std::int64_t>, std::string>;
  static constexpr std::size_t kMaxName = 255;

  /// @param name unique in the archive, 1 to kMaxName bytes.
  void Put(const std::string& name, Array array);
  void PutInteger(const std::string& name, std::int64_t value);
  void PutNumber(const std::string& name, double value);
  /// Adds all arrays of another archive as "prefix.name".
  void PutPart(const std::string& prefix, const Archive& part);

  bool Has(const std::string& name) const { return arrays_.count(name) > 0; }
  const std::vector<float>& Floats(const std::string& name) const;
  const std::vector<double>& Doubles(const std::string& name) const;
  const std::vector<std::int64_t>& Integers(const std::string& name) const;
  const std::string& Text(const std::string& name) const;
  std::int64_t Integer(const std::string& name) const;
  /// An Integer that is a count: from 0 to kMaxCount.
  std::int64_t Count(const std::string& name) const;
  static constexpr std::int64_t kMaxCount = 1LL << 53;  ///< a double holds these exactly
  double Number(const std::string& name) const;
  /// The archive that PutPart added with this prefix.
  Archive Part(const std::string& prefix) const;

  /// The same as Floats and Doubles, for exactly this size.
  const std::vector<float>& Floats(const std::string& name, std::size_t size) const;
  const std::vector<double>& Doubles(const std::string& name, std::size_t size) const;

  const std::map<std::string, Array>& arrays() const { return arrays_; }
  /// Compares bit for bit.
  bool operator==(const Archive& other) const;

 private:
  template <class T>
  const T& Get(const std::string& name) const;

  std::map<std::string, Array> arrays_;
};

/// Writes a file (WriteDurably). Throws UserError if this fails.
///
/// The file is plain data, little-endian: magic "STGTRAIN", version (u32), 0 (u32), number of bytes
/// of the rest and their FNV-1a checksum (u64 each), number of arrays (u32). Each array has its
/// type (one of f, d, i, t for floats, doubles, 64-bit integers, text), length of its name (u8),
/// name, number of elements (u64) and elements.
void WriteArchive(const Archive& archive, const std::string& path);

/// Throws UserError that names the file if it is no such file, has another version, is truncated or
/// damaged, or has a number that is not finite.
Archive ReadArchive(const std::string& path);

}  // namespace stg::learn
