#include "auv_common/nodes/poll_loop.hpp"

#include <ros/callback_queue.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <sched.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <utility>

#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {
namespace {

/// Longest time between two rounds of roscpp's thread [s].
constexpr double kPollPeriod_s = 0.1;

/// Wakes roscpp's socket thread at a point in time.
class Alarm {
 public:
  Alarm() : state_(std::make_shared<State>()) {
    ros::PollSet& sockets = ros::PollManager::instance()->getPollSet();
    // roscpp's thread may still have a copy of this function after the end of this object.
    sockets.addSocket(state_->file, [state = state_](int) { state->Drain(); });
    sockets.addEvents(state_->file, POLLIN);
  }
  ~Alarm() { ros::PollManager::instance()->getPollSet().delSocket(state_->file); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  /// Wakes the thread after `wait_s` seconds, instead of at the previous time.
  void Set(double wait_s) {
    const TimePoint wanted = Clock::now() + std::chrono::duration<double>(wait_s);
    // A node asks for the same time with each message; setting it again would be a system call.
    if (std::abs((wanted - state_->set).count()) < 1e-5) return;
    state_->set = wanted;
    const auto ns = static_cast<long>(wait_s * 1e9) + 1;  // 0 would switch the timer off
    const itimerspec time{{0, 0}, {ns / 1'000'000'000, ns % 1'000'000'000}};
    timerfd_settime(state_->file, 0, &time, nullptr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using TimePoint = std::chrono::time_point<Clock, std::chrono::duration<double>>;
  struct State {
    State() : file(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
      if (file < 0) throw std::system_error(errno, std::generic_category(), "timerfd_create");
    }
    ~State() { close(file); }
    void Drain() {
      std::uint64_t rings;
      while (read(file, &rings, sizeof rings) > 0) {
      }
      set = TimePoint();
    }
    const int file;
    TimePoint set;
  };
  std::shared_ptr<State> state_;
};

/// Function that roscpp's thread calls in each round; empty: none.
class RoundSlot {
 public:
  static RoundSlot& Get() {
    static RoundSlot* const slot = new RoundSlot;  // roscpp's thread may outlive main()
    return *slot;
  }

  /// After this call the previous function does not run any more.
  void Set(std::function<void()> round) {
    const std::lock_guard<std::mutex> lock(mutex_);
    round_ = std::move(round);
  }

 private:
  RoundSlot() {
    ros::PollManager::instance()->addPollThreadListener([this] {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (round_) round_();
    });
  }

  std::mutex mutex_;
  std::function<void()> round_;
};

/// Gives the calling thread a real-time priority. Threads that it starts do not inherit it.
void RunInRealTime(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &parameters) != 0) {
    ROS_INFO("no real-time priority: %s; other programs on this machine can delay this one",
             std::strerror(errno));
  }
}

}  // namespace

int RealtimePriorityParameter() {
  return IntegerParameter("realtime_priority", 0, 0, 99, Reach::kRun);
}

void ReservePollLoop() { RoundSlot::Get(); }

void PollLoop(const std::function<double()>& work, int realtime_priority) {
  std::mutex mutex;
  std::condition_variable changed;
  std::exception_ptr failure;
  bool done = false;
  bool to_promote = realtime_priority > 0;
  Alarm alarm;
  const auto round = [&] {
    if (done || !ros::ok()) return;
    if (std::exchange(to_promote, false)) RunInRealTime(realtime_priority);
    double wait_s = kLoopDone;
    std::exception_ptr thrown;
    try {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.0));
      wait_s = work();
    } catch (...) {
      thrown = std::current_exception();
    }
    if (wait_s >= 0.0) {
      if (wait_s < kPollPeriod_s) alarm.Set(wait_s);
      return;
    }
    const std::lock_guard<std::mutex> lock(mutex);
    failure = thrown;
    done = true;
    changed.notify_one();
  };
  RoundSlot::Get().Set(round);
  ros::PollManager::instance()->getPollSet().signal();
  {
    std::unique_lock<std::mutex> lock(mutex);
    // A shutdown by a signal ends roscpp's thread without notifying this one.
    while (!done && ros::ok()) changed.wait_for(lock, std::chrono::milliseconds(200));
  }
  RoundSlot::Get().Set(nullptr);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace stg::nodes
