#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {

/// Throws UserError for a parameter that modems of this protocol, at these ports, do not have.
inline void RefuseUnreadOfModems(const std::string& protocol,
                                 const std::vector<std::string>& ports) {
  const std::string s2c = "s2c";
  if (protocol != s2c) {
    RefuseParameter("rssi_offset_db", "belongs to the protocol s2c, but protocol is " + protocol);
  }
  const bool serial = std::any_of(ports.begin(), ports.end(), [](const std::string& port) {
    return port.rfind("tcp://", 0) != 0;
  });
  if (!serial) RefuseParameter("baud", "belongs to serial devices, but each port is tcp://");
}

}  // namespace stg::nodes
