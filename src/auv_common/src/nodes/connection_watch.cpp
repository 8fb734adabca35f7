#include "auv_common/nodes/connection_watch.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcDispatch.h>

#include <cstdint>

namespace stg::nodes {
namespace {

/// Calls a method of a node's XML-RPC server. Returns false if there is no answer in time.
bool Call(const std::string& uri, const char* method, const XmlRpc::XmlRpcValue& arguments,
          double patience_s, XmlRpc::XmlRpcValue* answer) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return false;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  if (!client.executeNonBlock(method, arguments)) return false;
  // execute() would wait for a stopped process forever.
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client,
                     XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  dispatch.work(patience_s);
  const bool answered = client.executeCheckDone(*answer) && !client.isFault();
  dispatch.removeSource(&client);
  return answered;
}

}  // namespace

bool ConnectionWatch::Settled(double now_s) {
  if (asked_s_ >= 0.0 && now_s - asked_s_ < 0.1) return false;
  asked_s_ = now_s;
  const std::optional<int> found = Ask();
  if (!found || *found == 0 || *found != connections_) changed_s_ = now_s;
  if (found) connections_ = *found;
  return now_s - changed_s_ >= kSettled_s;
}

/// Returns the number of publishers that the node is connected to, if the node answers.
std::optional<int> ConnectionWatch::Ask() const {
  XmlRpc::XmlRpcValue arguments, uri, answer;
  arguments[0] = ros::this_node::getName();
  arguments[1] = node_;
  if (!ros::master::execute("lookupNode", arguments, answer, uri, false)) return std::nullopt;
  if (uri.getType() != XmlRpc::XmlRpcValue::TypeString) return std::nullopt;
  XmlRpc::XmlRpcValue caller;
  caller[0] = ros::this_node::getName();
  if (!Call(uri, "getBusInfo", caller, kPatience_s, &answer)) return std::nullopt;
  // [1, message, [[id, other end, "i" or "o", transport, topic, ...], ...]]
  constexpr auto kArray = XmlRpc::XmlRpcValue::TypeArray;
  if (answer.getType() != kArray || answer.size() != 3 || answer[2].getType() != kArray) {
    return std::nullopt;
  }
  int inward = 0;
  for (int k = 0; k < answer[2].size(); ++k) {
    XmlRpc::XmlRpcValue& connection = answer[2][k];
    if (connection.getType() == kArray && connection.size() > 2 &&
        connection[2] == XmlRpc::XmlRpcValue("i")) {
      ++inward;
    }
  }
  return inward;
}

}  // namespace stg::nodes
