#include "acoustic_channel/driver/micromodem_driver.hpp"

namespace stg::acoustics::micromodem {
namespace {

constexpr double kLongest_s = 1000.0;  ///< of a travel time
constexpr double kMost = 1000.0;       ///< of a level [dB] or a velocity [m/s]

/// A statistic of a reception; 0, which means not stated, if it is no plausible number.
double StatisticOf(const std::string& text) { return RealIn(text, -kMost, kMost).value_or(0.0); }
int AddressIn(const std::string& text) { return NumberIn(text, 0, 127).value_or(-1); }

std::string Line(const std::string& body) {
  const std::string sealed = Seal(body);
  return sealed.substr(0, sealed.size() - 2);  // the end of line is added with the command
}

}  // namespace

void MicromodemDriver::Reset() {
  reader_.Reset();
  received_.clear();
  frame_leaves_ = false;
}

std::vector<std::string> MicromodemDriver::Settings() const {
  return {Line("CCCFG,SRC," + std::to_string(options_.address)), Line("CCCFG,CST,1"),
          Line("CCCFG,REV,1")};
}

std::string MicromodemDriver::CommandFor(const DriverPacket& packet) const {
  const int address = packet.destination == kToAll ? options_.broadcast : packet.destination;
  const std::string to = std::to_string(address), from = std::to_string(options_.address);
  if (!first_generation_) return Line("CCTDP," + to + ",1,0,0," + ToHex(packet.payload));
  frame_ = Line("CCTXD," + from + "," + to + ",0," + ToHex(packet.payload));
  return Line("CCCYC,0," + from + "," + to + ",0,0,1");
}

std::string MicromodemDriver::PingFor(int address) const {
  return Line("CCMPC," + std::to_string(options_.address) + "," + std::to_string(address));
}

void MicromodemDriver::Read(TimeNs t, ByteView bytes) {
  reader_.Feed(bytes);
  while (const auto sentence = reader_.Next()) {
    if (sentence->error.empty()) Take(sentence->fields, t);
  }
}

void MicromodemDriver::Take(const Fields& f, TimeNs t) {
  const std::string& name = f[0];
  if (name == "CAERR") return TakeError(f, t);
  if (name == "CADRQ" && !frame_.empty() && first_generation_) {
    frame_leaves_ = true;
    return Ask(frame_, t);
  }
  if (name == "CATXP") {
    leaves_ = t;
    if (ping_ == 0 && (!first_generation_ || frame_leaves_)) Leaving(t);
  } else if (name == "CATXF") {
    if (ping_ == 0 && (!first_generation_ || frame_leaves_)) {
      frame_leaves_ = false;
      Left(Seconds(t - leaves_), t);
    }
  } else if (name == "CARDP" && f.size() == 8) {
    const std::size_t hex = f[7].rfind(';');
    const auto payload = FromHex(hex == std::string::npos ? "x" : f[7].substr(hex + 1));
    if (payload && f[7][0] == '1') TakeFrame(AddressIn(f[1]), AddressIn(f[2]), *payload, t);
  } else if (name == "CARXD" && f.size() == 6) {
    const auto payload = FromHex(f[5]);
    if (payload) TakeFrame(AddressIn(f[1]), AddressIn(f[2]), *payload, t);
  } else if (name == "CACST") {
    TakeStatistics(f);
  } else if (name == "CAMSG") {
    ++counts_.lost;
  } else if (name == "CAMPR" && f.size() > 3 && AddressIn(f[1]) == ping_) {
    EndPing(RealIn(f[3], 0.0, kLongest_s).value_or(-1.0), t);
  } else if (name == "CAREV" && f.size() > 3) {
    firmware_ = f[3];
  }
  // An echo has the name of its command, with A instead of the second C.
  const bool echo =
      asked().size() > 6 && name.size() == 5 && asked().compare(3, 3, name, 2, 3) == 0;
  if (!echo) return;
  if (name == "CATDP" || name == "CATXD") Taken(t);
  Answered(t);
}

void MicromodemDriver::TakeError(const Fields& f, TimeNs t) {
  const std::string module = f.size() > 2 ? f[2] : "";
  const std::string why = Join(f);
  if (asked().empty()) {
    // The data for the modem's request came too late.
    if (module == "DATA_TIMEOUT") Refuse(why, t);
    return;
  }
  const bool flexible = asked().compare(0, 6, "$CCTDP") == 0;
  if (ping_ != 0) {
    EndPing(-1.0, t);
  } else if (module == "BUSY") {
    TryAgain(t);
  } else if (flexible && !first_generation_ && f.size() > 3 && f[3] == "2") {
    first_generation_ = true;  // an unknown sentence: from now on frames are sent in cycles
    TryAgain(t);
  } else {
    Refuse(why, t);
  }
  Answered(t);
}

void MicromodemDriver::TakeFrame(int source, int destination, const std::string& payload,
                                 TimeNs t) {
  DriverReception r;
  r.source = source;
  r.destination = destination == options_.broadcast ? kToAll : destination;
  r.payload = payload;
  r.arrival = t;
  received_.push_back(r);
}

void MicromodemDriver::TakeStatistics(const Fields& f) {
  const std::size_t newer = f.size() > 1 && f[1] == "6" ? 1 : 0;
  for (DriverReception& r : received_) {
    if (f.size() >= 30 + newer) {
      r.received_level_db = StatisticOf(f[7 + newer]);
      r.sinr_db = StatisticOf(f[21 + newer]);
      r.doppler_mps = StatisticOf(f[26 + newer]);
      r.noise_level_db = StatisticOf(f[27 + newer]);
    }
    Receive(r);
  }
  received_.clear();
}

}  // namespace stg::acoustics::micromodem
