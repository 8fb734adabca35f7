#include <dlfcn.h>
#include <ros/connection.h>
#include <ros/console.h>

#include <cstdint>
#include <new>

/// Replaces a function of roscpp, as loopback.cpp does. roscpp reserves as many bytes as a peer
/// says that it will send, up to a gigabyte, in the thread that serves all sockets of the node. It
/// catches nothing there, so three such peers exceeded the memory limit of a node and ended it.
/// Here the node drops the connection of a peer for which it has no memory.
void ros::Connection::read(std::uint32_t size, const ReadFinishedFunc& finished) {
  using Read = void (*)(Connection*, std::uint32_t, const ReadFinishedFunc&);
  constexpr char kName[] =
      "_ZN3ros10Connection4readEjRKN5boost8functionIFvRKNS1_10shared_ptrIS0_EERKNS1_12shared_"
      "arrayIhEEjbEEE";
  static const auto original = reinterpret_cast<Read>(dlsym(RTLD_NEXT, kName));
  try {
    original(this, size, finished);
  } catch (const std::bad_alloc&) {
    ROS_ERROR_THROTTLE(1.0, "no memory for %u bytes of a message; the connection is closed", size);
    drop(TransportDisconnect);
  }
}
