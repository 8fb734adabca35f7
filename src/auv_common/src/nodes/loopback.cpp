#include <arpa/inet.h>
#include <netinet/in.h>
#include <ros/network.h>
#include <sys/socket.h>
#include <xmlrpcpp/XmlRpcSocket.h>

#include <cstdint>
#include <string>

/// Replaces a function of libxmlrpcpp. If a node is only for this machine (ROS_IP or ROS_HOSTNAME
/// is the loopback), roscpp accepts its messages only over the loopback. But its XML-RPC server,
/// over which anybody can shut the node down, listens on all interfaces; libxmlrpcpp has no other
/// way. The definition below is found before the library's own, in programs that are linked with
/// this library before libxmlrpcpp, and if this library is preloaded (LD_PRELOAD). Except for nodes
/// of the loopback, it does the same as the original. test_loopback.py checks the sockets of a
/// whole run.
namespace {

bool OnlyThisMachine() {
  const std::string& host = ros::network::getHost();
  return host == "127.0.0.1" || host == "::1" || host == "localhost";
}

template <class Address>
bool BindTo(int socket, const Address& address) {
  return bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

bool XmlRpc::XmlRpcSocket::bind(int socket, int port) {
  if (s_use_ipv6_) {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_addr = OnlyThisMachine() ? in6addr_loopback : in6addr_any;
    address.sin6_port = htons(static_cast<std::uint16_t>(port));
    return BindTo(socket, address);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(OnlyThisMachine() ? INADDR_LOOPBACK : INADDR_ANY);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return BindTo(socket, address);
}
