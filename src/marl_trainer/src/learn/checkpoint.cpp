#include "marl_trainer/learn/checkpoint.hpp"

#include <ATen/ATen.h>
#include <fcntl.h>
#include <torch/serialize/archive.h>
#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

constexpr char kMagic[8] = {'S', 'T', 'G', 'T', 'R', 'A', 'I', 'N'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint64_t kMaxBytes = 4ULL << 30;

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

at::Tensor Tensor(const std::vector<float>& v) {
  return at::tensor(at::ArrayRef<float>(v), at::kFloat);
}
at::Tensor Tensor(const std::vector<double>& v) {
  return at::tensor(at::ArrayRef<double>(v), at::kDouble);
}
at::Tensor Tensor(const std::string& text) {
  at::Tensor t = at::empty({static_cast<std::int64_t>(text.size())}, at::kByte);
  std::memcpy(t.data_ptr(), text.data(), text.size());
  return t;
}
at::Tensor Tensor(std::int64_t value) {
  return at::tensor(at::ArrayRef<std::int64_t>(&value, 1), at::kLong);
}

/// Reads tensors of an archive by name and type.
class Reader {
 public:
  explicit Reader(torch::serialize::InputArchive* archive) : archive_(archive) {}

  template <class T>
  std::vector<T> Vector(const char* name, at::ScalarType type) {
    const at::Tensor t = Get(name, type);
    return std::vector<T>(t.data_ptr<T>(), t.data_ptr<T>() + t.numel());
  }
  std::string Text(const char* name) {
    const at::Tensor t = Get(name, at::kByte);
    return std::string(static_cast<const char*>(t.data_ptr()), static_cast<std::size_t>(t.numel()));
  }
  std::int64_t Integer(const char* name) {
    const at::Tensor t = Get(name, at::kLong);
    if (t.numel() != 1) throw UserError(std::string("'") + name + "' is not one number");
    return t.data_ptr<std::int64_t>()[0];
  }

 private:
  at::Tensor Get(const char* name, at::ScalarType type) {
    at::Tensor t;
    archive_->read(name, t);
    if (t.scalar_type() != type || t.dim() != 1 || !t.is_contiguous()) {
      throw UserError(std::string("'") + name + "' has another type");
    }
    return t;
  }
  torch::serialize::InputArchive* archive_;
};

std::string Serialise(const TrainState& s) {
  torch::serialize::OutputArchive archive;
  archive.write("parameters", Tensor(s.parameters));
  archive.write("adam_first", Tensor(s.adam.first));
  archive.write("adam_second", Tensor(s.adam.second));
  archive.write("adam_steps", Tensor(s.adam.steps));
  archive.write("observation_moments", Tensor(s.observation_moments));
  archive.write("state_moments", Tensor(s.state_moments));
  archive.write("value_moments", Tensor(s.value_moments));
  archive.write("env_steps", Tensor(s.env_steps));
  archive.write("collections", Tensor(s.collections));
  archive.write("round", Tensor(static_cast<std::int64_t>(s.round)));
  archive.write("scalars", Tensor(std::vector<double>{s.best_return, s.wall_seconds}));
  archive.write("config", Tensor(s.config));
  archive.write("scenario", Tensor(s.scenario));
  archive.write("log", Tensor(s.log));
  std::ostringstream out;
  archive.save_to(out);
  return out.str();
}

TrainState Parse(const std::string& payload) {
  torch::serialize::InputArchive archive;
  std::istringstream in(payload);
  archive.load_from(in);
  Reader r(&archive);
  TrainState s;
  s.parameters = r.Vector<float>("parameters", at::kFloat);
  s.adam.first = r.Vector<float>("adam_first", at::kFloat);
  s.adam.second = r.Vector<float>("adam_second", at::kFloat);
  s.adam.steps = r.Integer("adam_steps");
  s.observation_moments = r.Vector<double>("observation_moments", at::kDouble);
  s.state_moments = r.Vector<double>("state_moments", at::kDouble);
  s.value_moments = r.Vector<double>("value_moments", at::kDouble);
  s.env_steps = r.Integer("env_steps");
  s.collections = r.Integer("collections");
  s.round = static_cast<std::uint64_t>(r.Integer("round"));
  const std::vector<double> scalars = r.Vector<double>("scalars", at::kDouble);
  if (scalars.size() != 2) throw UserError("'scalars' has another size");
  s.best_return = scalars[0];
  s.wall_seconds = scalars[1];
  s.config = r.Text("config");
  s.scenario = r.Text("scenario");
  s.log = r.Text("log");
  return s;
}

void WriteDurably(const std::string& bytes, const std::string& path) {
  const std::string temporary = path + ".tmp";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  bool ok = file >= 0;
  for (std::size_t at = 0; ok && at < bytes.size();) {
    const ssize_t n = ::write(file, bytes.data() + at, bytes.size() - at);
    ok = n > 0;
    if (ok) at += static_cast<std::size_t>(n);
  }
  ok = ok && ::fsync(file) == 0;
  if (file >= 0) ok = ::close(file) == 0 && ok;
  ok = ok && std::rename(temporary.c_str(), path.c_str()) == 0;
  if (!ok) {
    std::remove(temporary.c_str());
    throw UserError(path + ": cannot write the checkpoint: " + std::strerror(errno));
  }
  const std::string parent = fs::path(path).parent_path().string();
  const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
}

/// Checkpoints of a folder, newest first.
std::vector<fs::path> Checkpoints(const std::string& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("checkpoint_", 0) == 0 && entry.path().extension() == ".pt") {
      found.push_back(entry.path());
    }
  }
  std::sort(found.rbegin(), found.rend());
  return found;
}

}  // namespace

void SaveCheckpoint(const TrainState& state, const std::string& path) {
  const std::string payload = Serialise(state);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  header.bytes = payload.size();
  header.checksum = Fnv(payload);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  WriteDurably(bytes += payload, path);
}

TrainState LoadCheckpoint(const std::string& path) {
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
    throw UserError(path + ": checkpoint of version " + std::to_string(header.version) +
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
  } catch (const std::exception& e) {
    throw UserError(path + ": damaged checkpoint: " + e.what());
  }
}

std::string CheckpointPath(const std::string& folder, std::int64_t env_steps) {
  char name[48];
  std::snprintf(name, sizeof name, "checkpoint_%012" PRId64 ".pt", env_steps);
  return (fs::path(folder) / name).string();
}

void PruneCheckpoints(const std::string& folder, int keep) {
  const std::vector<fs::path> found = Checkpoints(folder);
  std::error_code ignored;
  for (std::size_t i = static_cast<std::size_t>(keep); i < found.size(); ++i) {
    fs::remove(found[i], ignored);
  }
}

std::optional<TrainState> LoadNewestCheckpoint(const std::string& folder, std::ostream* log) {
  for (const fs::path& path : Checkpoints(folder)) {
    try {
      return LoadCheckpoint(path.string());
    } catch (const UserError& error) {
      *log << "refused " << error.what() << "; trying the previous one" << std::endl;
    }
  }
  return std::nullopt;
}

}  // namespace stg::learn
