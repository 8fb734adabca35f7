#include "acoustic_channel/emulator/modem_server.hpp"

#include <algorithm>
#include <chrono>

#include "acoustic_channel/janus/janus_modem.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"
#include "acoustic_channel/s2c/s2c_modem.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

constexpr int kNoAddress = -1;

TimeNs UtcNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::unique_ptr<BytePort> OpenPort(const ModemPlace& place, const std::string& listen) {
  if (place.tcp >= 0) return MakeTcpServer(listen, place.tcp, place.clients);
  if (!place.serial.empty()) return MakeSerial(place.serial, place.baud);
  return MakePty(place.pty);
}

}  // namespace

std::unique_ptr<ModemEngine> MakeEngine(const ModemPlace& place, ModemSurroundings* world) {
  if (place.protocol == Protocol::kMicromodem) {
    micromodem::ModemOptions options;
    options.address = place.address;
    options.broadcast = place.broadcast;
    options.firmware = place.firmware;
    options.pps = place.pps;
    options.settings = place.settings;
    return std::make_unique<micromodem::Micromodem>(options, world);
  }
  if (place.protocol == Protocol::kJanus) {
    janus::ModemOptions options;
    options.station = place.address;
    return std::make_unique<janus::JanusModem>(options, world);
  }
  s2c::ModemOptions options;
  options.net = place.interpreter == Interpreter::kNet;
  options.address = place.address;
  options.broadcast = place.broadcast;
  options.defer = place.defer;
  options.rssi_offset_db = place.rssi_offset_db;
  options.firmware = place.firmware;
  options.settings = place.settings;
  return std::make_unique<s2c::S2cModem>(options, world);
}

ModemServer::ModemServer(const ModemFile& file, const std::string& command_log)
    : water_(file.network.channel, file.network.run, this), places_(file.vehicles.size()) {
  if (!command_log.empty()) {
    log_.open(command_log);
    if (!log_) throw UserError(command_log + ": cannot be written");
    log_ << "t_ns,vehicle,what,bytes_hex\n";
  }
  for (std::size_t i = 0; i < file.vehicles.size(); ++i) {
    const ModemVehicle& v = file.vehicles[i];
    const int node = static_cast<int>(i);
    places_[i].name = v.name;
    if (v.gateway) OpenGateway(node, *v.gateway);
    if (v.transponder) {
      water_.Attach(node, kNoAddress, [&](ModemSurroundings* world) {
        return std::make_unique<micromodem::Transponder>(*v.transponder, world);
      });
    }
    if (!v.modem) continue;
    places_[i].port = OpenPort(*v.modem, file.listen);
    places_[i].listener = ListenerOf(node);
    places_[i].net = v.modem->interpreter == Interpreter::kNet;
    places_[i].serial_baud = v.modem->serial_baud;
    ports_.push_back(places_[i].port.get());
    water_.Attach(node, v.modem->address,
                  [&](ModemSurroundings* world) { return MakeEngine(*v.modem, world); });
  }
  water_.SetUtcStart(UtcNow() - Now());
  water_.Reset(file.network.run.seed, 0);
  for (std::size_t i = 0; i < file.vehicles.size(); ++i) {
    const ModemVehicle& v = file.vehicles[i];
    const Vec3<double> place{v.position_m[0], v.position_m[1], v.position_m[2]};
    water_.Move(static_cast<int>(i), 0, {place, {0.0, 0.0, 0.0}});
    // A vehicle without a known position is not in the water.
    if (!v.moored) water_.SetPresent(static_cast<int>(i), 0, false);
  }
}

PortListener ModemServer::ListenerOf(int node) {
  PortListener listener;
  const auto time = [this] { return std::max(Now(), water_.now()); };
  listener.connected = [this, node, time] {
    const Place& place = places_[static_cast<std::size_t>(node)];
    say(place.name + ": a host has connected to " + place.port->name());
    Log(node, "connect", nullptr, 0);
    water_.Connect(node, time());
  };
  listener.disconnected = [this, node, time] {
    say(places_[static_cast<std::size_t>(node)].name + ": its host has disconnected");
    Log(node, "disconnect", nullptr, 0);
    water_.Disconnect(node, time());
  };
  listener.refused = [this, node] {
    say(places_[static_cast<std::size_t>(node)].name +
        ": another host was refused; this modem accepts no more hosts");
  };
  ListenToGuests(node, &listener);
  listener.read = [this, node, time](const char* bytes, std::size_t size) {
    bytes_read_ += size;
    if (!places_[static_cast<std::size_t>(node)].power) return;
    const TimeNs t = time();
    water_.Advance(t);
    Log(node, "read", bytes, size);
    water_.Read(node, t, {reinterpret_cast<const std::uint8_t*>(bytes), size});
  };
  return listener;
}

/// Only S2C modems accept more than one host.
void ModemServer::ListenToGuests(int node, PortListener* listener) {
  Place& place = places_[static_cast<std::size_t>(node)];
  listener->guest_came = [this, &place](int guest) {
    say(place.name + ": another host has connected; it can only read");
    place.guests.emplace(guest, s2c::Bystander(place.net));
  };
  listener->guest_left = [&place](int guest) { place.guests.erase(guest); };
  listener->guest_read = [this, &place](int guest, const char* bytes, std::size_t size) {
    bytes_read_ += size;
    const auto found = place.guests.find(guest);
    if (found == place.guests.end()) return;
    s2c::Bystander& bystander = found->second;
    place.port->WriteToGuest(guest,
                             bystander.Read({reinterpret_cast<const std::uint8_t*>(bytes), size}));
    if (!bystander.takes_control()) return;
    const std::string words = (place.net ? "AT@CTRL\n" : "+++AT@CTRL\n") + bystander.TakeRest();
    bystander = s2c::Bystander(place.net);  // from now on for the host that had control
    place.port->GiveControlTo(guest, place.listener);
    place.listener.read(words.data(), words.size());
  };
}

void ModemServer::SetPresent(int node, bool present) {
  const TimeNs t = std::max(Now(), water_.now());
  if (water_.network().present(node) == present) return;
  water_.SetPresent(node, t, present);
  Place& place = places_[static_cast<std::size_t>(node)];
  if (!place.port || place.power == present) return;
  say(place.name + (present ? ": its modem has power again" : ": its modem has no power"));
  Log(node, present ? "power" : "no power", nullptr, 0);
  place.power = present;
  place.late.clear();
  place.port->SetOpen(present);
  water_.Restart(node, t);
}

void ModemServer::OpenGateway(int node, const GatewayPlace& gateway) {
  DriverOptions options;
  options.address = gateway.address;
  Place& place = places_[static_cast<std::size_t>(node)];
  place.gateway =
      std::make_unique<ModemPort>(gateway.protocol, options, gateway.port, gateway.baud);
  ports_.push_back(place.gateway->stream());
}

void ModemServer::PassOn(int node) {
  ModemPort& modem = *places_[static_cast<std::size_t>(node)].gateway;
  modem.Work();
  heard_.clear();
  water_.network().Take(node, water_.now(), &heard_);
  for (const Reception& r : heard_) {
    const auto* bytes = reinterpret_cast<const char*>(r.payload.data);
    modem.driver().Send({r.sequence, kToAll, std::string(bytes, bytes + r.payload.size)},
                        SteadyNow());
  }
  for (const DriverReception& r : modem.TakeReceptions()) {
    if (r.payload.empty() || r.payload.size() > water_.network().max_payload()) continue;
    const TimeNs t = std::max(Now(), water_.now());
    Transmission packet;
    packet.source = node;
    packet.stamp = packet.generation = t;
    packet.payload = {reinterpret_cast<const std::uint8_t*>(r.payload.data()), r.payload.size()};
    water_.Offer(packet, t);
  }
  modem.TakeEvents();
  modem.TakeRanges();
}

void ModemServer::Serve(TimeNs until) {
  TimeNs wake = start_ + std::min(until, water_.next());
  for (const Place& place : places_) {
    if (place.gateway) wake = std::min(wake, place.gateway->next());
  }
  for (const Place& place : places_) {
    if (!place.late.empty()) wake = std::min(wake, place.late.front().due);
  }
  WaitForPorts(ports_, wake);
  water_.Advance(std::max(Now(), water_.now()));
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].gateway) PassOn(static_cast<int>(i));
  }
  WriteLate(SteadyNow());
  for (const Place& place : places_) {
    if (place.port) place.port->Serve(SteadyNow(), place.listener);
  }
}

void ModemServer::Write(int node, const std::string& bytes) {
  Place& place = places_[static_cast<std::size_t>(node)];
  if (!place.port || !place.power) return;
  if (place.serial_baud == 0) return place.port->Write(bytes);
  // A byte needs ten bits on the line: a start bit, eight data bits and a stop bit.
  const auto bits = static_cast<TimeNs>(10 * bytes.size());
  place.line_free =
      std::max(place.line_free, SteadyNow()) + bits * 1'000'000'000 / place.serial_baud;
  place.late.push_back({place.line_free, bytes});
}

void ModemServer::WriteLate(TimeNs now) {
  for (Place& place : places_) {
    while (!place.late.empty() && place.late.front().due <= now) {
      place.port->Write(place.late.front().bytes);
      place.late.pop_front();
    }
  }
}

void ModemServer::Announce(int node, const std::string& notification) {
  const Place& place = places_[static_cast<std::size_t>(node)];
  for (const auto& [guest, bystander] : place.guests) {
    place.port->WriteToGuest(guest, bystander.Overheard(notification));
  }
}

void ModemServer::HangUp(int node) {
  BytePort* port = places_[static_cast<std::size_t>(node)].port.get();
  if (port != nullptr) port->HangUp();
}

void ModemServer::OnSharedAddress(int node, int address) {
  say(places_[static_cast<std::size_t>(node)].name + ": its address " + std::to_string(address) +
      " is also the address of another modem");
}

void ModemServer::Log(int node, const char* what, const char* bytes, std::size_t size) {
  if (!log_.is_open()) return;
  static const char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (std::size_t k = 0; k < size; ++k) {
    const auto byte = static_cast<unsigned char>(bytes[k]);
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 0xf];
  }
  log_ << water_.now() << ',' << places_[static_cast<std::size_t>(node)].name << ',' << what << ','
       << hex << '\n';
}

}  // namespace stg::acoustics
