#include "ping_desk.hpp"

#include <ros/init.h>

#include <chrono>
#include <cmath>
#include <utility>

namespace stg::nodes {

PingDesk::PingDesk(const std::string& service) : spinner_(kCallers, &queue_) {
  node_.setCallbackQueue(&queue_);
  server_ = node_.advertiseService(service, &PingDesk::OnCall, this);
  spinner_.start();
}

PingDesk::~PingDesk() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
  }
  RefuseAll("the channel shuts down");
  server_.shutdown();
  spinner_.stop();
}

bool PingDesk::OnCall(auv_msgs::Ping::Request& request, auv_msgs::Ping::Response& response) {
  constexpr double kDefault_s = 10.0, kLongest_s = 3600.0;
  response.success = false;
  if (!(request.timeout >= 0.0 && request.timeout <= kLongest_s)) {
    response.message = "timeout must be from 0 to 3600 s";
    return true;
  }
  std::unique_lock<std::mutex> lock(mutex_);
  const std::uint32_t tag = next_tag_++;
  Pending& pending = pending_[tag];
  questions_.push_back({tag, request.source, request.destination,
                        request.timeout > 0.0 ? request.timeout : kDefault_s});
  // A shutdown by a signal may happen without a notification.
  while (!pending.answered && !closed_ && ros::ok()) {
    changed_.wait_for(lock, std::chrono::milliseconds(200));
  }
  response = std::move(pending.response);
  if (!pending.answered) response.message = "the channel shuts down";
  pending_.erase(tag);
  return true;
}

std::vector<PingDesk::Question> PingDesk::TakeQuestions() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(questions_, {});
}

void PingDesk::Answer(std::uint32_t tag, const auv_msgs::Ping::Response& answer) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = pending_.find(tag);
  if (found == pending_.end()) return;
  found->second.answered = true;
  found->second.response = answer;
  changed_.notify_all();
}

void PingDesk::Refuse(std::uint32_t tag, const std::string& why) {
  auv_msgs::Ping::Response refusal;
  refusal.success = false;
  refusal.message = why;
  Answer(tag, refusal);
}

void PingDesk::RefuseAll(const std::string& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  questions_.clear();
  for (auto& [tag, pending] : pending_) {
    pending.answered = true;
    pending.response.success = false;
    pending.response.message = why;
  }
  changed_.notify_all();
}

}  // namespace stg::nodes
