#include "stg_env/record/message.hpp"

#include <cassert>
#include <cstring>
#include <utility>

namespace stg::env {
namespace {

constexpr std::size_t kAlignment = 8;  // for header and columns; typed arrays of a browser need it

void Pad(std::string* bytes, char with) {
  bytes->resize((bytes->size() + kAlignment - 1) / kAlignment * kAlignment, with);
}

void AppendLength(std::string* bytes, std::size_t length) {
  const auto number = static_cast<std::uint32_t>(length);
  for (int shift = 0; shift < 32; shift += 8) {
    bytes->push_back(static_cast<char>((number >> shift) & 0xFFU));
  }
}

}  // namespace

Message::Message(const std::string& kind, nlohmann::json header) : header_(std::move(header)) {
  header_["kind"] = kind;
}

void Message::Append(const std::string& name, const char* type, int width, const void* data,
                     std::size_t count, std::size_t size) {
  assert(width > 0 && count % static_cast<std::size_t>(width) == 0);
  const std::size_t rows = count / static_cast<std::size_t>(width);
  assert(!header_.contains("rows") || header_["rows"] == rows);
  header_["rows"] = rows;
  header_["columns"].push_back({name, type, width});
  const std::size_t begin = body_.size();
  body_.resize(begin + count * size);
  if (count > 0) std::memcpy(&body_[begin], data, count * size);
  Pad(&body_, '\0');
}

void Message::Add(const std::string& name, int width, const std::vector<double>& values) {
  Append(name, "f8", width, values.data(), values.size(), sizeof(double));
}
void Message::Add(const std::string& name, int width, const std::vector<float>& values) {
  Append(name, "f4", width, values.data(), values.size(), sizeof(float));
}
void Message::Add(const std::string& name, int width, const std::vector<std::int32_t>& values) {
  Append(name, "i4", width, values.data(), values.size(), sizeof(std::int32_t));
}
void Message::Add(const std::string& name, int width, const std::vector<std::uint8_t>& values) {
  Append(name, "u1", width, values.data(), values.size(), 1);
}

std::string Message::Bytes() const {
  // Text that is not UTF-8 (e.g. the name of a file) must not end a run.
  std::string header = header_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  Pad(&header, ' ');
  std::string bytes;
  bytes.reserve(kAlignment + header.size() + body_.size());
  AppendLength(&bytes, header.size());
  AppendLength(&bytes, body_.size());
  return bytes + header + body_;
}

}  // namespace stg::env
