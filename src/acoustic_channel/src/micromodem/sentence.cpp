#include "acoustic_channel/micromodem/sentence.hpp"

namespace stg::acoustics::micromodem {
namespace {

unsigned ChecksumOf(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return sum;
}

Sentence Broken(const std::string& why) { return {{}, why}; }

Sentence Parse(const std::string& line) {
  // Text before the last dollar sign is the rest of a sentence that was cut off.
  const std::size_t dollar = line.rfind('$');
  if (dollar == std::string::npos) return Broken("no dollar sign");
  std::string body = line.substr(dollar + 1);
  const std::size_t star = body.find('*');
  if (star != std::string::npos) {
    const auto given = FromHex(body.substr(star + 1));
    body.resize(star);
    if (!given || given->size() != 1 ||
        ChecksumOf(body) != static_cast<unsigned char>(given->front())) {
      return Broken("bad checksum");
    }
  }
  Sentence sentence;
  std::size_t at = 0;
  for (;;) {
    const std::size_t comma = body.find(',', at);
    sentence.fields.push_back(body.substr(at, comma == std::string::npos ? comma : comma - at));
    if (comma == std::string::npos) return sentence;
    at = comma + 1;
  }
}

}  // namespace

std::string Seal(const std::string& body) {
  const std::string sum(1, static_cast<char>(ChecksumOf(body)));
  return "$" + body + "*" + ToHex(sum) + "\r\n";
}

std::string Join(const std::vector<std::string>& fields) {
  std::string body;
  for (const std::string& field : fields) body += (&field == fields.data() ? "" : ",") + field;
  return body;
}

void SentenceReader::Reset() {
  buffer_.clear();
  skipping_ = false;
}

void SentenceReader::Feed(ByteView bytes) {
  buffer_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

std::optional<Sentence> SentenceReader::Next() {
  for (;;) {
    const std::size_t end = buffer_.find_first_of("\r\n");
    if (skipping_) {
      if (end == std::string::npos) {
        buffer_.clear();
        return {};
      }
      buffer_.erase(0, end + 1);
      skipping_ = false;
      continue;
    }
    if (end > kLongestLine && buffer_.size() > kLongestLine) {
      buffer_.erase(0, kLongestLine + 1);
      skipping_ = true;
      return Broken("line too long");
    }
    if (end == std::string::npos) return {};
    const std::string line = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    if (!line.empty()) return Parse(line);
  }
}

}  // namespace stg::acoustics::micromodem
