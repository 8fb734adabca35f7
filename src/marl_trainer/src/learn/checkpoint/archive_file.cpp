#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <type_traits>

#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/checkpoint/archive.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "checkpoints are little-endian");

constexpr char kMagic[8] = {'S', 'T', 'G', 'T', 'R', 'A', 'I', 'N'};
constexpr std::uint32_t kTorchVersion = 1;  // a libtorch archive
constexpr std::uint32_t kVersion = 3;
constexpr std::uint64_t kMaxBytes = 4ULL << 30;
constexpr std::uint32_t kMaxArrays = 1U << 16;
constexpr char kTypes[] = {'f', 'd', 'i', 't'};  // by index in Archive::Array

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t reserved;
  std::uint64_t bytes;
  std::uint64_t checksum;
};

std::uint64_t Fnv(const std::string& bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

template <class T>
void Append(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string Serialise(const Archive& archive) {
  std::string bytes;
  Append(static_cast<std::uint32_t>(archive.arrays().size()), &bytes);
  for (const auto& [name, array] : archive.arrays()) {
    bytes += kTypes[array.index()];
    bytes += static_cast<char>(static_cast<unsigned char>(name.size()));
    bytes += name;
    std::visit(
        [&bytes](const auto& elements) {
          Append(static_cast<std::uint64_t>(elements.size()), &bytes);
          bytes.append(reinterpret_cast<const char*>(elements.data()),
                       elements.size() * sizeof(elements[0]));
        },
        array);
  }
  return bytes;
}

/// Takes bytes from the front of a payload. Throws UserError at its end.
class Cursor {
 public:
  explicit Cursor(const std::string& bytes) : at_(bytes.data()), left_(bytes.size()) {}

  const char* Take(std::uint64_t count) {
    if (count > left_) throw UserError("an array reaches past the end");
    const char* here = at_;
    at_ += count;
    left_ -= count;
    return here;
  }
  template <class T>
  T Value() {
    T value;
    std::memcpy(&value, Take(sizeof value), sizeof value);
    return value;
  }
  template <class Elements>
  Elements Array(std::uint64_t count) {
    using T = typename Elements::value_type;
    if (count > left_ / sizeof(T)) throw UserError("an array reaches past the end");
    Elements elements(count, T());
    if (count > 0) std::memcpy(elements.data(), Take(count * sizeof(T)), count * sizeof(T));
    if constexpr (std::is_floating_point_v<T>) {
      for (const T x : elements) {
        if (!std::isfinite(x)) throw UserError("a number is not finite");
      }
    }
    return elements;
  }
  bool empty() const { return left_ == 0; }

 private:
  const char* at_;
  std::uint64_t left_;
};

Archive::Array ParseArray(char type, std::uint64_t count, Cursor* in) {
  switch (type) {
    case 'f':
      return in->Array<std::vector<float>>(count);
    case 'd':
      return in->Array<std::vector<double>>(count);
    case 'i':
      return in->Array<std::vector<std::int64_t>>(count);
    case 't':
      return in->Array<std::string>(count);
    default:
      throw UserError("an array of an unknown type");
  }
}

Archive Parse(const std::string& payload) {
  Cursor in(payload);
  Archive archive;
  const auto count = in.Value<std::uint32_t>();
  if (count > kMaxArrays) throw UserError("too many arrays");
  for (std::uint32_t k = 0; k < count; ++k) {
    const char type = in.Value<char>();
    const auto length = in.Value<std::uint8_t>();
    const std::string name(in.Take(length), length);
    if (name.empty() || archive.Has(name)) throw UserError("an array's name is empty or taken");
    archive.Put(name, ParseArray(type, in.Value<std::uint64_t>(), &in));
  }
  if (!in.empty()) throw UserError("bytes after the last array");
  return archive;
}

}  // namespace

void WriteArchive(const Archive& archive, const std::string& path) {
  const std::string payload = Serialise(archive);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  header.bytes = payload.size();
  header.checksum = Fnv(payload);
  std::string bytes;
  Append(header, &bytes);
  WriteDurably(bytes += payload, path, "the checkpoint");
}

Archive ReadArchive(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw UserError(path + ": no such checkpoint");
  const std::uint64_t size = fs::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  Header header{};
  if (!in || size < sizeof header || !in.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) {
    throw UserError(path + ": not a checkpoint of this trainer");
  }
  if (header.version != kVersion) {
    const char* what = header.version == kTorchVersion ? " (a libtorch archive)" : "";
    throw UserError(path + ": checkpoint of version " + std::to_string(header.version) + what +
                    ", this trainer reads " + std::to_string(kVersion));
  }
  if (header.bytes > kMaxBytes || size != sizeof header + header.bytes) {
    throw UserError(path + ": truncated checkpoint: " + std::to_string(size) +
                    " bytes instead of " + std::to_string(sizeof header + header.bytes));
  }
  std::string payload(header.bytes, '\0');
  if (!in.read(payload.data(), static_cast<std::streamsize>(payload.size())) ||
      Fnv(payload) != header.checksum) {
    throw UserError(path + ": damaged checkpoint: its checksum does not match");
  }
  try {
    return Parse(payload);
  } catch (const UserError& e) {
    throw UserError(path + ": damaged checkpoint: " + e.what());
  }
}

}  // namespace stg::learn
