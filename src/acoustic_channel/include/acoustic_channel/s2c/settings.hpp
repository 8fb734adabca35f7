#pragma once

#include <map>
#include <optional>
#include <string>

/// Settings of an S2C modem that host software sets and reads.
namespace stg::acoustics::s2c {

/// Values by the letters of their commands: "L" of AT!L and AT?L, "ZX" of AT@ZX.
class Settings {
 public:
  enum class Result { kOk, kUnknown, kNoNumber, kOutOfRange };

  Settings();
  /// @param text a number
  Result Set(const std::string& name, const std::string& text);
  /// 0 for what does not exist.
  int at(const std::string& name) const;
  bool knows(const std::string& name) const { return values_.count(name) > 0; }
  /// AT&W: stores the present values for a reboot. AT&F: restores the factory settings.
  void Store();
  void Restore();
  void RestoreFactory();
  /// Whether a value differs from the stored one; answers then mark it.
  bool changed(const std::string& name) const;
  /// AT&V: a line for each value that is shown, with its end of line.
  std::string List() const;

 private:
  struct Value {
    int now, stored, factory, lo, hi;
  };
  std::map<std::string, Value> values_;
};

/// Ten powers of a source level: 0, -6, -12 and -20 dB.
double SourceLevelDb(int level);

}  // namespace stg::acoustics::s2c
