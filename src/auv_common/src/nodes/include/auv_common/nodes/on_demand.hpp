#pragma once

#include <ros/node_handle.h>
#include <ros/single_subscriber_publisher.h>

#include <functional>
#include <string>
#include <utility>

namespace stg::nodes {

/// A topic that costs nothing while it has no subscriber. A new subscriber gets the newest message
/// at once, as from a latched topic. A latched topic of roscpp serialises messages even without
/// subscribers.
template <class Message>
class OnDemand {
 public:
  /// Makes the newest message; false: there is none yet. It is called in the node's own thread.
  using Make = std::function<bool(Message*)>;

  OnDemand() = default;
  OnDemand(const OnDemand&) = delete;
  OnDemand& operator=(const OnDemand&) = delete;

  /// Call it once. @param make is called as long as this object lives.
  void Advertise(const std::string& topic, std::uint32_t queue, Make make) {
    make_ = std::move(make);
    publisher_ = ros::NodeHandle().advertise<Message>(
        topic, queue, [this](const ros::SingleSubscriberPublisher& listener) {
          if (make_(&message_)) listener.publish(message_);
        });
  }

  /// Sends the newest message to the subscribers.
  void Publish() {
    if (publisher_.getNumSubscribers() > 0 && make_(&message_)) publisher_.publish(message_);
  }

 private:
  Make make_;
  Message message_;
  ros::Publisher publisher_;
};

}  // namespace stg::nodes
