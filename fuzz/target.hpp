#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// The loaders of bytes from outside. Each is a target for libFuzzer, and for the test of earlier
/// findings (docs/fuzzing.md).
namespace stg::fuzz {

/// One loader. `run` takes any bytes. It returns true if they were accepted, and false if they were
/// refused with UserError. Any other outcome is a bug.
struct Target {
  const char* name;
  bool (*run)(const std::string& bytes);
};

bool RunBathymetry(const std::string& bytes);
bool RunCheckpoint(const std::string& bytes);
bool RunJanusModem(const std::string& bytes);
bool RunMicromodem(const std::string& bytes);
bool RunModemAnswers(const std::string& bytes);
bool RunMotions(const std::string& bytes);
bool RunNetwork(const std::string& bytes);
bool RunPacket(const std::string& bytes);
bool RunPolicy(const std::string& bytes);
bool RunRecording(const std::string& bytes);
bool RunS2cModem(const std::string& bytes);
bool RunScenario(const std::string& bytes);
bool RunTrack(const std::string& bytes);

inline constexpr Target kTargets[] = {
    {"bathymetry", RunBathymetry},
    {"checkpoint", RunCheckpoint},
    {"janus_modem", RunJanusModem},
    {"micromodem", RunMicromodem},
    {"modem_answers", RunModemAnswers},
    {"motions", RunMotions},
    {"network", RunNetwork},
    {"packet", RunPacket},
    {"policy", RunPolicy},
    {"recording", RunRecording},
    {"s2c_modem", RunS2cModem},
    {"scenario", RunScenario},
    {"track", RunTrack},
};

/// Calls `load` with the path of a file in memory that contains the bytes. Returns true unless
/// `load` throws UserError.
bool LoadAsFile(const std::string& bytes, const std::function<void(const std::string&)>& load);

/// Ends the program with a message if `ok` is false: bytes were accepted that must be refused, or
/// were read wrongly.
void Require(bool ok, const char* what);

/// Takes numbers from the front of the bytes; zeros after their end.
class Bytes {
 public:
  explicit Bytes(const std::string& bytes) : bytes_(bytes) {}

  template <class T>
  T Take() {
    T value{};
    TakeInto(&value, sizeof value);
    return value;
  }
  bool empty() const { return at_ >= bytes_.size(); }
  std::string Rest() const { return bytes_.substr(at_); }

 private:
  void TakeInto(void* value, std::size_t size);

  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace stg::fuzz
