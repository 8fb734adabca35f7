#include "auv_common/nodes/sound_bag.hpp"

#include <rosbag/chunked_file.h>
#include <rosbag/constants.h>
#include <rosbag/exceptions.h>
#include <rosbag/stream.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>
#include <vector>

namespace stg::nodes {
namespace {

// Format: wiki.ros.org/Bags/Format/2.0. A record has a length, a header of this number of bytes,
// another length, and data of this number of bytes. All numbers are little-endian.
using Bytes = std::vector<std::uint8_t>;
using Fields = std::map<std::string, std::string>;
constexpr std::uint32_t kLengthBytes = 4;
constexpr std::uint32_t kIndexEntryBytes = 12;  // time (8), offset in the chunk (4)
constexpr std::uint32_t kMostChunkBytes = 1u << 30;

[[noreturn]] void Damaged(std::uint64_t at, const std::string& what) {
  throw rosbag::BagFormatException("damaged at byte " + std::to_string(at) + ": " + what);
}

std::uint32_t NumberAt(const std::uint8_t* p) {
  std::uint32_t n;
  std::memcpy(&n, p, sizeof n);
  return n;
}

/// Does not use ros::Header, because it does not check the lengths of fields.
Fields FieldsOf(const Bytes& header, std::uint64_t at) {
  Fields fields;
  std::size_t place = 0;
  while (place < header.size()) {
    const std::size_t left = header.size() - place;
    const std::size_t length = left < kLengthBytes ? left : NumberAt(&header[place]);
    if (length > left - std::min<std::size_t>(left, kLengthBytes)) {
      Damaged(at, "a field reaches past the end of its header");
    }
    const std::string text(reinterpret_cast<const char*>(&header[place]) + kLengthBytes, length);
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) Damaged(at, "a field has no name");
    fields[text.substr(0, equals)] = text.substr(equals + 1);
    place += kLengthBytes + length;
  }
  return fields;
}

std::string Field(const Fields& fields, const std::string& name, std::size_t size,
                  std::uint64_t at) {
  const auto found = fields.find(name);
  if (found == fields.end() || (size > 0 && found->second.size() != size)) {
    Damaged(at, "a record has no proper field " + name);
  }
  return found->second;
}

std::uint32_t NumberField(const Fields& fields, const std::string& name, std::uint64_t at) {
  const std::string text = Field(fields, name, sizeof(std::uint32_t), at);
  return NumberAt(reinterpret_cast<const std::uint8_t*>(text.data()));
}

std::uint64_t PlaceField(const Fields& fields, const std::string& name, std::uint64_t at) {
  const std::string text = Field(fields, name, sizeof(std::uint64_t), at);
  std::uint64_t place;
  std::memcpy(&place, text.data(), sizeof place);
  return place;
}

std::uint8_t Operation(const Fields& fields, std::uint64_t at) {
  return static_cast<std::uint8_t>(Field(fields, rosbag::OP_FIELD_NAME, 1, at)[0]);
}

/// Reads a file record by record. Throws if a record ends behind the file.
class Records {
 public:
  explicit Records(const std::string& path) : in_(path, std::ios::binary) {
    in_.seekg(0, std::ios::end);
    left_ = static_cast<std::uint64_t>(in_.tellg());
    in_.seekg(0);
    std::string first;
    std::getline(in_, first);
    if (first != "#ROSBAG V" + rosbag::VERSION) Damaged(0, "not a bag of version 2.0");
    Count(first.size() + 1);
  }

  bool more() const { return left_ > 0; }
  std::uint64_t at() const { return at_; }

  Bytes Next() {
    if (left_ < kLengthBytes) Damaged(at_, "a record is cut off");
    std::uint8_t length[kLengthBytes];
    Read(length, kLengthBytes);
    const std::uint32_t size = NumberAt(length);
    if (size > left_) Damaged(at_, "a record reaches past the end of the file");
    Bytes bytes(size);
    Read(bytes.data(), size);
    return bytes;
  }

 private:
  void Read(std::uint8_t* to, std::uint32_t size) {
    if (!in_.read(reinterpret_cast<char*>(to), size)) Damaged(at_, "cannot be read");
    Count(size);
  }
  void Count(std::uint64_t n) { at_ += n, left_ -= n; }

  std::ifstream in_;
  std::uint64_t left_ = 0, at_ = 0;
};

Bytes Unpacked(Bytes data, const Fields& fields, std::uint64_t at) {
  const std::string packing = Field(fields, rosbag::COMPRESSION_FIELD_NAME, 0, at);
  const std::uint32_t size = NumberField(fields, rosbag::SIZE_FIELD_NAME, at);
  if (packing == rosbag::COMPRESSION_NONE) {
    if (size != data.size()) Damaged(at, "a chunk has another length than it states");
    return data;
  }
  if (size > kMostChunkBytes) Damaged(at, "a chunk states more than 1 GiB of content");
  rosbag::CompressionType type;
  if (packing == rosbag::COMPRESSION_LZ4) {
    type = rosbag::compression::LZ4;
  } else if (packing == rosbag::COMPRESSION_BZ2) {
    type = rosbag::compression::BZ2;
  } else {
    Damaged(at, "a chunk is compressed in an unknown way");
  }
  Bytes whole(size);
  rosbag::ChunkedFile none;
  rosbag::StreamFactory(&none).getStream(type)->decompress(whole.data(), size, data.data(),
                                                           static_cast<unsigned>(data.size()));
  return whole;
}

/// Offsets of the message records in a chunk, ascending.
std::vector<std::uint32_t> MessagesIn(const Bytes& chunk, std::uint64_t at) {
  std::vector<std::uint32_t> begins;
  const auto size = static_cast<std::uint32_t>(chunk.size());
  std::uint32_t place = 0;
  const auto next = [&] {
    if (size - place < kLengthBytes) Damaged(at, "a record in this chunk is cut off");
    const std::uint32_t length = NumberAt(&chunk[place]);
    place += kLengthBytes;
    if (length > size - place) Damaged(at, "a record in this chunk reaches past its end");
    const std::uint32_t begin = place;
    place += length;
    return std::pair(begin, length);
  };
  while (place < size) {
    const std::uint32_t begin = place;
    const auto [header, length] = next();
    const Bytes bytes(chunk.begin() + header, chunk.begin() + header + length);
    if (Operation(FieldsOf(bytes, at), at) == rosbag::OP_MSG_DATA) begins.push_back(begin);
    next();
  }
  return begins;
}

/// @param count number of entries that the record's header states; rosbag reads this many.
void CheckIndex(const Bytes& index, std::uint64_t count, const std::vector<std::uint32_t>& messages,
                std::uint64_t at) {
  if (index.size() != count * kIndexEntryBytes)
    Damaged(at, "an index has another size than stated");
  for (std::size_t k = 0; k < index.size(); k += kIndexEntryBytes) {
    const std::uint32_t offset = NumberAt(&index[k + 8]);
    if (!std::binary_search(messages.begin(), messages.end(), offset)) {
      Damaged(at, "an index entry points at no message");
    }
  }
}

}  // namespace

void RequireSoundBag(const std::string& path) {
  Records records(path);
  std::vector<std::uint32_t> messages;  // of the last chunk
  std::vector<std::uint64_t> begins, chunks;
  std::uint64_t index = 0;
  while (records.more()) {
    const std::uint64_t at = records.at();
    const Bytes header = records.Next();
    const Fields fields = FieldsOf(header, at);
    const std::uint8_t operation = Operation(fields, at);
    Bytes data = records.Next();
    begins.push_back(at);
    if (operation == rosbag::OP_FILE_HEADER) {
      index = PlaceField(fields, rosbag::INDEX_POS_FIELD_NAME, at);
    } else if (operation == rosbag::OP_CHUNK) {
      chunks.push_back(at);
      messages = MessagesIn(Unpacked(std::move(data), fields, at), at);
    } else if (operation == rosbag::OP_INDEX_DATA) {
      CheckIndex(data, NumberField(fields, rosbag::COUNT_FIELD_NAME, at), messages, at);
    } else if (operation == rosbag::OP_CHUNK_INFO) {
      const std::uint64_t chunk = PlaceField(fields, rosbag::CHUNK_POS_FIELD_NAME, at);
      if (!std::binary_search(chunks.begin(), chunks.end(), chunk)) {
        Damaged(at, "the index points at no chunk");
      }
    }
  }
  // A bag without messages ends with its header.
  if (index != records.at() && !std::binary_search(begins.begin(), begins.end(), index)) {
    Damaged(0, "the header points at no index");
  }
}

}  // namespace stg::nodes
