#include "acoustic_channel/emulator/modem_file.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "acoustic_channel/driver/modem_driver.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "acoustic_channel/s2c/settings.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

using config::YamlTree;

/// Names of the protocols, in the order of Protocol.
const std::vector<std::string>& ProtocolNames() {
  static const std::vector<std::string> names{"s2c", "micromodem", "janus"};
  return names;
}

const YamlTree::Entry* FindEntry(const YamlTree& map, const std::string& key) {
  for (const YamlTree::Entry& entry : map.entries) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

YamlTree Without(const YamlTree& map, const std::string& key) {
  YamlTree rest = map;
  rest.entries.clear();
  for (const YamlTree::Entry& entry : map.entries) {
    if (entry.key != key) rest.entries.push_back(entry);
  }
  return rest;
}

[[noreturn]] void Fail(const std::string& file, int line, const std::string& key,
                       const std::string& why) {
  throw UserError(file + ":" + std::to_string(line) + ": " + key + ": " + why);
}

/// Takes texts that are not names (paths, topics, addresses) out of the map.
void TakeText(const std::string& file, const std::string& prefix, const std::string& key,
              YamlTree* map, std::string* text) {
  const YamlTree::Entry* entry = FindEntry(*map, key);
  if (entry == nullptr) return;
  if (entry->value.kind != YamlTree::Kind::kScalar || entry->value.scalar.empty()) {
    Fail(file, entry->line, prefix + key, "expected text");
  }
  *text = entry->value.scalar;
  *map = Without(*map, key);
}

/// Takes the settings of a modem. They have the protocol's names, so no table contains them.
void TakeSettings(const std::string& file, const std::string& prefix, YamlTree* map,
                  ModemPlace* place) {
  const YamlTree::Entry* entry = FindEntry(*map, "settings");
  if (entry == nullptr) return;
  if (entry->value.kind != YamlTree::Kind::kMap) {
    Fail(file, entry->line, prefix + "settings", "expected a map of names and values");
  }
  s2c::Settings known;
  for (const YamlTree::Entry& one : entry->value.entries) {
    const std::string key = prefix + "settings." + one.key, &value = one.value.scalar;
    if (one.value.kind != YamlTree::Kind::kScalar || value.empty() || value.size() > 64) {
      Fail(file, one.line, key, "expected a value");
    }
    if (one.key == (place->protocol == Protocol::kS2c ? "AL" : "SRC")) {
      Fail(file, one.line, key,
           "this setting is the address; set the key 'address' of the modem instead");
    }
    const bool sound = place->protocol == Protocol::kS2c
                           ? known.Set(one.key, value) == s2c::Settings::Result::kOk
                           : (one.key + value).find_first_of(",*$\r\n") == std::string::npos;
    if (!sound)
      Fail(file, one.line, key, "the modem has no such setting, or does not accept this value");
    place->settings.emplace_back(one.key, value);
  }
  *map = Without(*map, "settings");
}

ModemPlace ReadPlace(const std::string& file, YamlTree map, const std::string& prefix) {
  ModemPlace place;
  if (map.kind != YamlTree::Kind::kMap) Fail(file, map.line, prefix, "expected a map of keys");
  TakeText(file, prefix + ".", "pty", &map, &place.pty);
  TakeText(file, prefix + ".", "serial", &map, &place.serial);
  TakeText(file, prefix + ".", "firmware", &map, &place.firmware);
  if (const YamlTree::Entry* protocol = FindEntry(map, "protocol")) {
    // Other keys depend on it, so it is read first. The loader below refuses an unknown name.
    const auto& names = ProtocolNames();
    const auto name = std::find(names.begin(), names.end(), protocol->value.scalar);
    if (name != names.end()) place.protocol = static_cast<Protocol>(name - names.begin());
  }
  const bool s2c = place.protocol == Protocol::kS2c, janus = place.protocol == Protocol::kJanus;
  const auto refuse = [&](const char* key, const char* why) {
    const YamlTree::Entry* entry = FindEntry(map, key);
    if (entry != nullptr) Fail(file, entry->line, prefix + "." + key, why);
  };
  for (const char* key : {"interpreter", "defer", "rssi_offset_db", "clients"}) {
    if (!s2c) refuse(key, "only the protocol s2c has this key");
  }
  if (s2c || janus) refuse("pps", "only the protocol micromodem has this key");
  if (janus) refuse("broadcast", "only the protocols s2c and micromodem have this key");
  if (janus) refuse("settings", "only the protocols s2c and micromodem have this key");
  TakeSettings(file, prefix + ".", &map, &place);
  if (janus && !place.firmware.empty()) {
    Fail(file, map.line, prefix + ".firmware",
         "only the protocols s2c and micromodem have this key");
  }
  config::Table t;
  t.Section(prefix);
  t.Add("protocol", config::Enum(&place.protocol, ProtocolNames()), config::kNone, "-", "");
  t.Add("tcp", &place.tcp, config::Within(0, 65535), "-", "");
  t.Add("baud", &place.baud, config::Within(1, 1e7), "-", "");
  t.Add("serial_baud", &place.serial_baud, config::Within(0, 1e7), "-", "");
  t.Add("clients", &place.clients, config::Within(1, 16), "-", "");
  t.Add("interpreter", config::Enum(&place.interpreter, {"at", "net"}), config::kNone, "-", "");
  t.Add("address", &place.address, config::Within(1, s2c || janus ? 254 : 127), "-", "");
  t.Add("broadcast", &place.broadcast, config::Within(-1, s2c ? 255 : 127), "-", "");
  t.Add("pps", &place.pps, config::kNone, "-", "");
  t.Add("defer", &place.defer, config::kNone, "-", "");
  t.Add("rssi_offset_db", &place.rssi_offset_db, config::Within(-1e3, 1e3), "dB", "");
  config::Loader loader(t, config::Scope::kWhole);
  loader.ApplyPart(map, prefix + ".", file);
  if (place.broadcast < 0) place.broadcast = s2c ? 255 : 0;
  if (place.firmware.empty()) place.firmware = s2c ? "1.9" : "2.0.35490";
  const int ports = (place.tcp >= 0) + !place.pty.empty() + !place.serial.empty();
  if (ports != 1) Fail(file, map.line, prefix, "needs exactly one of tcp, pty and serial");
  if (place.clients > 1 && place.tcp < 0) {
    Fail(file, map.line, prefix + ".clients", "only a TCP port accepts more than one client");
  }
  if (place.serial.empty()) refuse("baud", "only a serial device has this key");
  if (place.serial_baud > 0 && !place.serial.empty()) {
    Fail(file, map.line, prefix + ".serial_baud", "for a serial device, set baud instead");
  }
  return place;
}

GatewayPlace ReadGateway(const std::string& file, YamlTree map, const std::string& prefix) {
  GatewayPlace place;
  if (map.kind != YamlTree::Kind::kMap) Fail(file, map.line, prefix, "expected a map of keys");
  TakeText(file, prefix + ".", "port", &map, &place.port);
  if (place.port.empty()) Fail(file, map.line, prefix + ".port", "missing key");
  config::Table t;
  t.Section(prefix);
  t.Add("protocol", config::Name(&place.protocol, DriverProtocols()), config::kNone, "-", "");
  t.Add("baud", &place.baud, config::Within(1, 1e7), "-", "");
  t.Add("address", &place.address, config::Within(1, 127), "-", "");
  const YamlTree::Entry* const baud = FindEntry(map, "baud");
  if (baud != nullptr && place.port.rfind("tcp://", 0) == 0) {
    Fail(file, baud->line, prefix + ".baud", "only a serial device has this key");
  }
  config::Loader loader(t, config::Scope::kWhole);
  loader.ApplyPart(map, prefix + ".", file);
  return place;
}

micromodem::TransponderOptions ReadTransponder(const std::string& file, const YamlTree& map,
                                               const std::string& prefix) {
  if (map.kind != YamlTree::Kind::kMap) Fail(file, map.line, prefix, "expected a map of keys");
  micromodem::TransponderOptions options;
  const std::vector<std::string> letters{"A", "B", "C", "D"};
  std::string letter;
  config::Table t;
  t.Section(prefix);
  t.Add("letter", config::Name(&letter, letters), config::kNone, "-", "");
  t.Add("query_hz", &options.query_hz, config::Within(1, 1e5), "Hz", "");
  t.Add("reply_hz", &options.reply_hz, config::Within(1, 1e5), "Hz", "");
  t.Add("turnaround_ms", &options.turnaround_ms, config::Within(1, 1e4), "ms", "");
  config::Loader loader(t, config::Scope::kWhole);
  loader.ApplyPart(map, prefix + ".", file);
  const bool remus = !letter.empty(), query = options.query_hz > 0, reply = options.reply_hz > 0;
  if (remus == (query || reply) || query != reply) {
    Fail(file, map.line, prefix, "needs either letter, or query_hz and reply_hz");
  }
  if (remus) options.slot = letter[0] - 'A';
  return options;
}

ModemVehicle ReadVehicle(const std::string& file, const YamlTree& map, int index) {
  const std::string prefix = "vehicles[" + std::to_string(index) + "]";
  if (map.kind != YamlTree::Kind::kMap) Fail(file, map.line, prefix, "expected a map of keys");
  ModemVehicle v;
  v.id = index;
  config::Table t;
  t.Section(prefix);
  t.Add("name", &v.name, config::kNone, "-", "");
  t.Add("id", &v.id, config::Within(0, 254), "-", "");
  t.Add("position_m", config::Numbers(&v.position_m), config::Within(-1e7, 1e7), "m", "");
  config::Loader loader(t, config::Scope::kWhole);
  YamlTree rest = Without(Without(Without(map, "modem"), "gateway"), "transponder");
  TakeText(file, prefix + ".", "odom", &rest, &v.odom);
  loader.ApplyPart(rest, prefix + ".", file);
  if (v.name.empty()) Fail(file, map.line, prefix + ".name", "missing key");
  v.moored = FindEntry(map, "position_m") != nullptr;
  if (v.moored && !v.odom.empty())
    Fail(file, map.line, prefix + ".odom", "cannot be combined with position_m");
  if (v.odom.empty()) v.odom = "/" + v.name + "/odom";
  if (const YamlTree::Entry* modem = FindEntry(map, "modem")) {
    v.modem = ReadPlace(file, modem->value, prefix + ".modem");
    if (v.modem->address == 0) v.modem->address = v.id + 1;
  }
  if (const YamlTree::Entry* gateway = FindEntry(map, "gateway")) {
    if (v.modem) Fail(file, gateway->line, prefix + ".gateway", "cannot be combined with modem");
    v.gateway = ReadGateway(file, gateway->value, prefix + ".gateway");
    if (v.gateway->address == 0) v.gateway->address = v.id + 1;
  }
  if (const YamlTree::Entry* transponder = FindEntry(map, "transponder")) {
    if (!v.ordinary()) {
      Fail(file, transponder->line, prefix + ".transponder",
           "cannot be combined with modem or gateway");
    }
    v.transponder = ReadTransponder(file, transponder->value, prefix + ".transponder");
  }
  return v;
}

void RefuseTwins(const std::string& file, const YamlTree& list,
                 const std::vector<ModemVehicle>& vehicles) {
  std::set<std::string> seen;
  const auto once = [&](const std::string& what, std::size_t i) {
    if (seen.insert(what).second) return;
    Fail(file, list.items[i].line, "vehicles[" + std::to_string(i) + "]",
         "a second vehicle with " + what);
  };
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    const ModemVehicle& v = vehicles[i];
    once("name " + v.name, i);
    once("id " + std::to_string(v.id), i);
    if (v.gateway) once("modem at " + v.gateway->port, i);
    if (!v.modem) continue;
    if (v.modem->tcp > 0) once("TCP port " + std::to_string(v.modem->tcp), i);
    if (!v.modem->pty.empty()) once("terminal " + v.modem->pty, i);
    if (!v.modem->serial.empty()) once("device " + v.modem->serial, i);
    once("modem address " + std::to_string(v.modem->address), i);
  }
}

}  // namespace

std::string WhyNot(Protocol protocol, const std::string& profile) {
  // How the waveforms of a protocol's modems start, in the order of Protocol.
  static const std::array<const char*, 3> kWaveforms{"evologics_s2c", "micromodem_", "janus"};
  const auto place = static_cast<std::size_t>(protocol);
  if (ModemProfiles().Make(profile)->waveform.rfind(kWaveforms[place], 0) == 0) return "";
  return "a modem with the protocol " + ProtocolNames()[place] + " cannot have the profile " +
         profile;
}

ModemFile LoadModemFile(const std::string& path) {
  const YamlTree root = config::ParseYaml(config::ReadBoundedFile(path), path);
  config::LoadPluginsIn(root, path);
  const YamlTree::Entry* list = FindEntry(root, "vehicles");
  if (list == nullptr) Fail(path, root.line, "vehicles", "missing key");
  if (list->value.kind != YamlTree::Kind::kSequence || list->value.items.empty()) {
    Fail(path, list->line, "vehicles", "expected a list that is not empty");
  }
  ModemFile file;
  for (const YamlTree& item : list->value.items) {
    file.vehicles.push_back(ReadVehicle(path, item, static_cast<int>(file.vehicles.size())));
  }
  RefuseTwins(path, list->value, file.vehicles);

  file.network.run.agents = static_cast<int>(file.vehicles.size());
  file.network.run.name = "modems";
  config::Table t;
  Describe(&file.network.run.time, &t);
  t.Section("");
  t.Add("seed", &file.network.run.seed, config::kNone, "-", "");
  Describe(&file.network.channel, &t);
  OwnByScenarios(&file.network.channel, false, &t);
  config::Loader loader(t, config::Scope::kWhole);
  YamlTree rest = Without(root, "vehicles");
  const bool tcp = std::any_of(file.vehicles.begin(), file.vehicles.end(),
                               [](const auto& v) { return v.modem && v.modem->tcp >= 0; });
  if (const YamlTree::Entry* listen = FindEntry(rest, "listen"); listen != nullptr && !tcp) {
    Fail(path, listen->line, "listen", "is the address of TCP ports, but no modem has one (tcp)");
  }
  TakeText(path, "", "listen", &rest, &file.listen);
  loader.ApplyPart(rest, "", path);
  loader.RefuseUnread();
  if (const auto violation = config::FindBadValue(t)) loader.Refuse(*violation);
  if (const auto violation = FindConflict(file.network.channel, file.network.run)) {
    loader.Refuse(*violation);
  }
  const auto profiles = MakeProfiles(file.network.channel.physical.modem, file.network.run.agents);
  for (std::size_t i = 0; i < file.vehicles.size(); ++i) {
    const ModemVehicle& v = file.vehicles[i];
    if (!v.modem && !v.transponder) continue;
    const std::string why =
        WhyNot(v.modem ? v.modem->protocol : Protocol::kMicromodem, profiles[i].name);
    if (!why.empty()) Fail(path, list->value.items[i].line, "vehicles", why);
  }
  return file;
}

}  // namespace stg::acoustics
