#include <cmath>
#include <cstdio>

#include "acoustic_channel/s2c/s2c_modem.hpp"

/// Settings, queries and control of the modem.
namespace stg::acoustics::s2c {
namespace {

std::string Fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

/// Bit rate of instant messages: 11 ms per byte.
constexpr long kImBitrate = 727;

bool Letter(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

void S2cModem::Command(const std::string& text, TimeNs t) {
  const char group = text.empty() ? '\0' : text[0];
  if (group != '?' && group != '!' && group != '@' && group != '&' && group != '*') {
    Control(text, t);
    return;
  }
  std::size_t end = 1;
  if (group == '?' && text.size() > 1 && text[1] == '@') ++end;
  while (end < text.size() && Letter(text[end])) ++end;
  const std::string command = text.substr(0, end);
  const std::string value = text.substr(end);
  const std::string name = command.substr(command.compare(0, 2, "?@") == 0 ? 2 : 1);
  if (group == '?') {
    if (!value.empty()) return Answer(command, "ERROR WRONG FORMAT");
    Query(name, command, t);
  } else if (group == '&') {
    if (text == "&V") return AnswerLines(command, settings_.List());
    if (text == "&W") {
      settings_.Store();
    } else if (text == "&F") {
      settings_.RestoreFactory();
      settings_.Set("AL", std::to_string(options_.address));
      world_->SetAddress(settings_.at("AL"));
    } else {
      return Answer(command, "ERROR UNKNOWN COMMAND");
    }
    Answer(command, "OK");
  } else if (group == '*') {
    Answer(command, name == "SEND" || name == "SENDIM" || name == "SENDIMS" || name == "SENDPBM"
                        ? "ERROR WRONG FORMAT"
                        : "ERROR UNKNOWN COMMAND");
  } else if (text == "@CTRL") {
    Answer(command, "OK");
  } else {
    Change(group, name, value);
  }
}

void S2cModem::Change(char group, const std::string& name, const std::string& value) {
  const std::string command = group + name;
  const bool extended = !name.empty() && name[0] == 'Z';
  // AT@ZX and similar commands are a group of their own; AT!ZC is not in it.
  const bool in_group =
      group == '@' ? name == "ZX" || name == "ZF" || name == "ZU" || name == "ZA"
                   : !extended || name == "ZC" || name == "ZP" || name == "ZI" || name == "ZS";
  if (!in_group) return Answer(command, "ERROR UNKNOWN COMMAND");
  switch (settings_.Set(name, value)) {
    case Settings::Result::kUnknown:
      return Answer(command, "ERROR UNKNOWN COMMAND");
    case Settings::Result::kNoNumber:
      return Answer(command, "ERROR WRONG FORMAT");
    case Settings::Result::kOutOfRange:
      return Answer(command, "ERROR OUT OF RANGE");
    case Settings::Result::kOk:
      break;
  }
  if (name == "AL") world_->SetAddress(settings_.at("AL"));
  Answer(command, settings_.changed(name) ? "[*]OK" : "OK");
}

void S2cModem::Query(const std::string& name, const std::string& command, TimeNs t) {
  if (name == "MODE") return Answer(command, options_.net ? "NET" : "AT");
  if (name == "S") {
    return options_.net ? AnswerLines(command, Status() + "\n") : Answer(command, Status());
  }
  if (name == "P") {
    std::string lines;
    for (int k = 0; k < 8; ++k) {
      lines += k == 0 ? "0 " + Fixed(measured_.delay_level_db, 0) + "\n" : "0 0\n";
    }
    return AnswerLines(command, lines);
  }
  if (name == "DI") return Answer(command, Delivery());
  if (name == "CLOCK") return Answer(command, std::to_string(ClockUs(t)));
  if (name == "E") return Answer(command, std::to_string(measured_.rssi));
  if (name == "I") return Answer(command, std::to_string(measured_.integrity));
  if (name == "V") return Answer(command, Fixed(measured_.velocity_mps, 4));
  if (name == "T") return Answer(command, std::to_string(measured_.propagation_us));
  if (name == "BL" || name == "BR") {
    const bool online = connection_.state() == Connection::State::kOnline;
    return Answer(command, std::to_string(online ? std::lround(kBurstBitrate) : kImBitrate));
  }
  if (name == "BV") return Answer(command, "11.9");
  if (name == "PC") {
    return AnswerLines(command, "Sent: " + std::to_string(sent_count_) +
                                    "\nReceived: " + std::to_string(received_count_) +
                                    "\nFailed: " + std::to_string(failed_count_) + "\n");
  }
  if (!settings_.knows(name)) return Answer(command, "ERROR UNKNOWN COMMAND");
  Answer(command, (settings_.changed(name) ? "[*]" : "") + std::to_string(settings_.at(name)));
}

std::string S2cModem::Status() const {
  if (state_ == State::kNoise) return "INITIATION NOISE";
  if (state_ == State::kDeaf) return "INITIATION DEAF";
  switch (connection_.state()) {
    case Connection::State::kEstablish:
      return "INITIATION ESTABLISH";
    case Connection::State::kOnline:
      return "ONLINE LOCAL";
    case Connection::State::kBackoff:
      return "BACKOFF";
    case Connection::State::kOffline:
      break;
  }
  return "INITIATION LISTEN";
}

std::string S2cModem::Delivery() const {
  if (message_ && message_->header.flag == Flag::kAck) {
    return "DELIVERING," + std::to_string(message_->header.destination);
  }
  return delivery_;
}

void S2cModem::Control(const std::string& text, TimeNs t) {
  const auto accept = [&] { Answer(text, "OK"); };
  if (text == "Z0") {
    Reboot(t);
  } else if (ControlConnection(text, t)) {
    LaunchBurst(t);
  } else if (text == "Z3") {
    accept();
    DropMessages(true);
  } else if (text == "A") {
    state_ = State::kListen;
    Answer(text, "INITIATION LISTEN");
    LaunchBurst(t);
  } else if (text == "N") {
    state_ = State::kNoise;
    Answer(text, "INITIATION NOISE");
  } else if (text == "S") {
    state_ = State::kDeaf;
    Answer(text, "INITIATION DEAF");
  } else if (text == "C") {
    // The answer is the first one in command mode.
    SetMode(Reader::Mode::kPlain);
    accept();
  } else if (text == "O") {
    if (!options_.net) SetMode(Reader::Mode::kData);
  } else if (text == "I0") {
    Answer(text, options_.firmware);
  } else if (text == "I1") {
    // dune reads the first number from its first zero on, and the second number after the "v".
    Answer(text, "phy: emulated 0.1, mac: emulated v" + options_.firmware);
  } else if (text == "I7") {
    Answer(text, "EM" + std::to_string(options_.address));
  } else if (text == "P") {
    Answer(text, "ERROR NOT ACCEPTED");
  } else {
    Answer("", "ERROR UNKNOWN COMMAND");
  }
}

}  // namespace stg::acoustics::s2c
