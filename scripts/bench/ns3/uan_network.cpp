// Simulates a network of ns-3's UAN module with given packets, for the comparison in compare.py,
// which builds it.
//
//   uan_network NODES PACKETS DURATION_S RATE_BPS KHZ BAND_HZ LEVEL_DB ACQUISITION_DB THRESHOLD_DB
//
// NODES has lines `x y z` [m]; PACKETS has lines `time source bytes`, sorted by time. A packet has
// this number of bytes, including the module's header, and goes to all nodes by ALOHA. Prints the
// number of sent packets, then `source receiver delivered` for every pair.

#include <ns3/core-module.h>
#include <ns3/mobility-module.h>
#include <ns3/network-module.h>
#include <ns3/uan-module.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <vector>

using namespace ns3;

namespace {

std::vector<std::vector<std::uint64_t>> delivered;
std::uint64_t sent = 0;

void Send(Ptr<NetDevice> device, std::uint32_t bytes) {
  // The modem refuses a packet while it is sending, because this module has no queue.
  const UanHeaderCommon header;
  const Ptr<Packet> packet = Create<Packet>(bytes - header.GetSerializedSize());
  if (device->Send(packet, device->GetBroadcast(), 0)) ++sent;
}

bool Receive(std::size_t receiver, const std::map<Address, std::size_t>* index, Ptr<NetDevice>,
             Ptr<const Packet>, std::uint16_t, const Address& source) {
  ++delivered[index->at(source)][receiver];
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 10) {
    std::cerr << "usage: uan_network NODES PACKETS DURATION_S RATE_BPS KHZ BAND_HZ LEVEL_DB "
                 "ACQUISITION_DB THRESHOLD_DB\n";
    return 2;
  }
  const double duration_s = std::atof(argv[3]);
  const auto rate = static_cast<std::uint32_t>(std::atof(argv[4]));
  const auto centre_hz = static_cast<std::uint32_t>(1e3 * std::atof(argv[5]));
  const auto band_hz = static_cast<std::uint32_t>(std::atof(argv[6]));

  std::ifstream places(argv[1]);
  const Ptr<ListPositionAllocator> positions = CreateObject<ListPositionAllocator>();
  int count = 0;
  for (double x, y, z; places >> x >> y >> z; ++count) positions->Add(Vector(x, y, z));
  NodeContainer nodes;
  nodes.Create(count);
  MobilityHelper mobility;
  mobility.SetPositionAllocator(positions);
  mobility.SetMobilityModel("ns3::ConstantPositionMobilityModel");
  mobility.Install(nodes);

  const Ptr<UanChannel> channel = CreateObject<UanChannel>();
  channel->SetPropagationModel(
      CreateObjectWithAttributes<UanPropModelThorp>("SpreadCoef", DoubleValue(1.5)));
  channel->SetNoiseModel(CreateObjectWithAttributes<UanNoiseModelDefault>(
      "Wind", DoubleValue(5.0), "Shipping", DoubleValue(0.5)));
  UanModesList modes;
  modes.AppendMode(
      UanTxModeFactory::CreateMode(UanTxMode::PSK, rate, rate, centre_hz, band_hz, 2, "compared"));
  UanHelper uan;
  uan.SetMac("ns3::UanMacAloha");
  uan.SetPhy("ns3::UanPhyGen", "TxPower", DoubleValue(std::atof(argv[7])), "RxThreshold",
             DoubleValue(std::atof(argv[8])), "CcaThreshold", DoubleValue(1000.0), "SupportedModes",
             UanModesListValue(modes), "PerModel",
             PointerValue(CreateObjectWithAttributes<UanPhyPerGenDefault>(
                 "Threshold", DoubleValue(std::atof(argv[9])))));
  const NetDeviceContainer devices = uan.Install(nodes, channel);

  delivered.assign(count, std::vector<std::uint64_t>(count, 0));
  std::map<Address, std::size_t> index;
  for (int i = 0; i < count; ++i) index[devices.Get(i)->GetAddress()] = i;
  for (int i = 0; i < count; ++i) {
    devices.Get(i)->SetReceiveCallback(MakeBoundCallback(&Receive, std::size_t(i), &index));
  }
  std::ifstream packets(argv[2]);
  int source = 0;
  std::uint32_t bytes = 0;
  for (double t = 0.0; packets >> t >> source >> bytes;) {
    Simulator::Schedule(Seconds(t), &Send, devices.Get(source), bytes);
  }
  Simulator::Stop(Seconds(duration_s));
  Simulator::Run();
  Simulator::Destroy();
  std::printf("%llu\n", static_cast<unsigned long long>(sent));
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      if (i != j) {
        std::printf("%d %d %llu\n", i, j, static_cast<unsigned long long>(delivered[i][j]));
      }
    }
  }
  return 0;
}
