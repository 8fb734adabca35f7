#pragma once

#include <auv_msgs/Ping.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace stg::nodes {

/// The service that measures ranges. Each call waits for its answer in a thread of its own.
/// Meanwhile the node's thread continues, takes the questions and gives the answers.
class PingDesk {
 public:
  struct Question {
    std::uint32_t tag;
    std::uint32_t source, destination;  ///< ids
    double timeout_s;                   ///< in simulated time
  };

  /// @param service name of the service
  explicit PingDesk(const std::string& service);
  /// Callers that still wait get an answer that says so.
  ~PingDesk();

  /// The questions since the last call.
  std::vector<Question> TakeQuestions();
  void Answer(std::uint32_t tag, const auv_msgs::Ping::Response& answer);
  void Refuse(std::uint32_t tag, const std::string& why);
  /// Refuses all open questions, because their run is over.
  void RefuseAll(const std::string& why);

 private:
  static constexpr int kCallers = 8;  ///< largest number of simultaneous calls; more calls wait
  struct Pending {
    bool answered = false;
    auv_msgs::Ping::Response response;
  };
  bool OnCall(auv_msgs::Ping::Request& request, auv_msgs::Ping::Response& response);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint32_t next_tag_ = 0;
  bool closed_ = false;
  std::vector<Question> questions_;
  std::map<std::uint32_t, Pending> pending_;  ///< by tag
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;
};

}  // namespace stg::nodes
