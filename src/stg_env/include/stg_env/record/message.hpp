#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stg::env {

/// The first bytes of a recording; messages follow until the end of the file.
inline constexpr char kRecordingMagic[] = "STGVIEW1";

/// One message of a recording, which the browser's page reads from a file or a websocket: two
/// little-endian uint32 (bytes of header and body), the header, the body. The header is JSON,
/// filled up with blanks to a multiple of 8 bytes: `kind`, further fields of the kind, `rows` and
/// `columns` as [[name, type, width], ...]. The body has the columns one after the other, each
/// [rows, width] little-endian numbers, filled up with zeros to a multiple of 8 bytes. Types: f8,
/// f4, i4, u1. docs/recording.md lists the kinds.
class Message {
 public:
  /// @param header must be an object; `kind` is added to it
  explicit Message(const std::string& kind, nlohmann::json header = nlohmann::json::object());

  /// Adds a column [rows, width], row-major; every column of a message has the same rows.
  void Add(const std::string& name, int width, const std::vector<double>& values);
  void Add(const std::string& name, int width, const std::vector<float>& values);
  void Add(const std::string& name, int width, const std::vector<std::int32_t>& values);
  void Add(const std::string& name, int width, const std::vector<std::uint8_t>& values);

  /// The whole message.
  std::string Bytes() const;

 private:
  void Append(const std::string& name, const char* type, int width, const void* data,
              std::size_t count, std::size_t size);

  nlohmann::json header_;
  std::string body_;
};

}  // namespace stg::env
