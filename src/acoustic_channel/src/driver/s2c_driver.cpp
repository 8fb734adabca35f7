#include "acoustic_channel/driver/s2c_driver.hpp"

#include "acoustic_channel/engine/text.hpp"

namespace stg::acoustics::s2c {
namespace {

/// Payload of a ping; no host reads it.
constexpr char kPingPayload[] = "?";

constexpr int kLastAddress = 65535;
constexpr double kLongest_us = 1e9;  ///< of an airtime or a travel time
constexpr double kMost = 1000.0;     ///< of a level [dB] or a velocity [m/s]

/// A time in an answer of the modem [s].
std::optional<double> TimeOf(const std::string& microseconds) {
  const std::optional<double> us = RealIn(microseconds, 0.0, kLongest_us);
  if (!us) return {};
  return 1e-6 * *us;
}

bool Begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

}  // namespace

std::vector<std::string> S2cDriver::Settings() const {
  return {"AT?MODE", "ATI0", "AT@ZX1", "AT!AL" + std::to_string(options_.address)};
}

std::string S2cDriver::CommandFor(const DriverPacket& packet) const {
  const int address = packet.destination == kToAll ? options_.broadcast : packet.destination;
  return "AT*SENDIM," + std::to_string(packet.payload.size()) + "," + std::to_string(address) +
         ",noack," + packet.payload;
}

std::string S2cDriver::PingFor(int address) const {
  return "AT*SENDIM,1," + std::to_string(address) + ",ack," + kPingPayload;
}

void S2cDriver::Read(TimeNs t, ByteView bytes) {
  reader_.Feed(bytes);
  while (const auto line = reader_.Next()) {
    if (line->notification()) {
      TakeNotification(*line, t);
    } else {
      TakeAnswer(*line, t);
    }
  }
}

void S2cDriver::TakeAnswer(const ModemLine& line, TimeNs t) {
  const std::string& text = line.name();
  const bool busy = Begins(text, "BUSY"), error = Begins(text, "ERROR");
  if (Begins(asked(), "AT*SENDIM")) {
    if (ping_ != 0) {
      if (busy || error) EndPing(-1.0, t);
    } else if (busy) {
      TryAgain(t);
    } else if (error) {
      Refuse(text, t);
    } else {
      Taken(t);
    }
  } else if (asked() == "AT?T") {
    EndPing(TimeOf(text).value_or(-1.0), t);
  } else if (asked() == "ATI0") {
    firmware_ = text;
  }
  Answered(t);
}

void S2cDriver::TakeNotification(const ModemLine& line, TimeNs t) {
  const std::string& name = line.name();
  const bool own = line.fields.size() > 2 && line.fields[2] == "im" && ping_ == 0;
  if (name == "SENDSTART" && own) {
    Leaving(t);
  } else if (name == "SENDEND" && own && line.fields.size() > 4) {
    Left(TimeOf(line.fields[4]).value_or(0.0), t);
  } else if (name == "RECVIM" && line.fields.size() == 9) {
    TakeMessage(line, t);
  } else if (name == "RECVFAILED") {
    ++counts_.lost;
  } else if (name == "DELIVEREDIM" && ping_ != 0) {
    Ask("AT?T", t);
  } else if (name == "FAILEDIM" && ping_ != 0) {
    EndPing(-1.0, t);
  }
}

void S2cDriver::TakeMessage(const ModemLine& line, TimeNs t) {
  const std::vector<std::string>& f = line.fields;
  const bool ping = f[4] == "ack" && line.payload == kPingPayload;
  if (ping) return;
  const auto source = NumberIn(f[2], 0, kLastAddress);
  const auto destination = NumberIn(f[3], 0, kLastAddress);
  const auto airtime_s = TimeOf(f[5]);
  const auto rssi_db = RealIn(f[6], -kMost, kMost), velocity_mps = RealIn(f[8], -kMost, kMost);
  if (!source || !destination || !airtime_s || !rssi_db || !velocity_mps) {
    ++counts_.lost;  // the line was damaged on its way through the port
    return;
  }
  DriverReception r;
  r.source = *source;
  r.destination = *destination == options_.broadcast ? kToAll : *destination;
  r.payload = line.payload;
  r.arrival = t;
  r.airtime_s = *airtime_s;
  r.received_level_db = *rssi_db - options_.rssi_offset_db;
  r.doppler_mps = *velocity_mps;
  Receive(r);
}

}  // namespace stg::acoustics::s2c
