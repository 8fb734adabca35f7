#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// What takes bytes from outside, each as a target for libFuzzer and for the test of what was found
/// (docs/fuzzing.md).
namespace stg::fuzz {

/// One loader. `run` takes any bytes: true when they were accepted, false when they were refused
/// with UserError; anything else that comes of them is a bug.
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

/// Hands `load` the path of a file in memory that holds the bytes, for loaders that take a path.
/// True unless it throws UserError.
bool LoadAsFile(const std::string& bytes, const std::function<void(const std::string&)>& load);

/// Ends the program with a message: bytes were accepted that must not be, or not read as they
/// stand.
void Require(bool ok, const char* what);

/// Numbers from the front of the bytes; zeros past their end.
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
