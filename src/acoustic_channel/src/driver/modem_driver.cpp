#include "acoustic_channel/driver/modem_driver.hpp"

#include <algorithm>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/driver/micromodem_driver.hpp"
#include "acoustic_channel/driver/s2c_driver.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kAnswerTime = 1'000'000'000;
constexpr int kMostAsked = 3;
constexpr TimeNs kBusyTime = 200'000'000;
/// If the modem has not sent a packet by this time, the packet is lost. A ping without an answer
/// ends then, too.
constexpr TimeNs kUnderWay = 20'000'000'000;

}  // namespace

void ModemDriver::Connect(TimeNs t) {
  connected_ = true;
  ready_ = false;
  ++counts_.connections;
  commands_.clear();
  asked_.clear();
  Reset();
  for (const std::string& command : Settings()) commands_.push_back(command);
  AskNext(t);
}

void ModemDriver::Disconnect(TimeNs t) {
  connected_ = ready_ = false;
  commands_.clear();
  asked_.clear();
  if (under_way_) {
    ++counts_.dropped;
    world_->OnDropped(under_way_->tag);
    under_way_.reset();
  }
  if (ping_ != 0) EndPing(-1.0, t);
  Reset();
}

void ModemDriver::Ask(const std::string& command, TimeNs t) {
  commands_.push_back(command);
  AskNext(t);
}

void ModemDriver::AskNext(TimeNs t) {
  if (!connected_ || !asked_.empty() || commands_.empty()) return;
  asked_ = commands_.front();
  commands_.pop_front();
  times_asked_ = 1;
  answer_due_ = t + kAnswerTime;
  world_->Write(asked_ + "\r\n");
}

void ModemDriver::Answered(TimeNs t) {
  asked_.clear();
  if (commands_.empty()) ready_ = true;
  AskNext(t);
  Go(t);
}

void ModemDriver::Send(const DriverPacket& packet, TimeNs t) {
  if (waiting_) {
    ++counts_.dropped;
    world_->OnDropped(waiting_->tag);
  }
  waiting_ = packet;
  again_ = t;
  Go(t);
}

void ModemDriver::Ping(int address, TimeNs t) {
  if (ping_ != 0 || !ready_ || under_way_) return world_->OnRange(address, -1.0);
  ping_ = address;
  give_up_ = t + kUnderWay;
  Ask(PingFor(address), t);
}

/// Gives the waiting packet to the modem if nothing else is on its way.
void ModemDriver::Go(TimeNs t) {
  if (!ready_ || !asked_.empty() || under_way_ || !waiting_ || ping_ != 0 || t < again_) return;
  under_way_ = std::move(waiting_);
  waiting_.reset();
  taken_ = false;
  give_up_ = t + kUnderWay;
  Ask(CommandFor(*under_way_), t);
}

void ModemDriver::Taken(TimeNs /*t*/) {
  if (!under_way_ || taken_) return;
  taken_ = true;
  world_->OnQueued(under_way_->tag);
}

void ModemDriver::Leaving(TimeNs t) {
  if (under_way_) world_->OnSent(under_way_->tag, t);
}

void ModemDriver::Left(double airtime_s, TimeNs t) {
  if (!under_way_) return;
  ++counts_.sent;
  const std::uint32_t tag = under_way_->tag;
  under_way_.reset();
  world_->OnSendEnd(tag, airtime_s);
  Go(t);
}

void ModemDriver::Refuse(const std::string& why, TimeNs t) {
  if (!under_way_) return;
  ++counts_.refused;
  const std::uint32_t tag = under_way_->tag;
  under_way_.reset();
  world_->OnRefused(tag, why);
  Go(t);
}

void ModemDriver::TryAgain(TimeNs t) {
  if (!under_way_) return;
  if (waiting_) {
    ++counts_.dropped;
    world_->OnDropped(under_way_->tag);
  } else {
    waiting_ = std::move(under_way_);
  }
  under_way_.reset();
  again_ = t + kBusyTime;
}

void ModemDriver::Receive(const DriverReception& reception) {
  ++counts_.received;
  world_->OnReception(reception);
}

void ModemDriver::EndPing(double one_way_s, TimeNs t) {
  const int address = ping_;
  ping_ = 0;
  if (address != 0) world_->OnRange(address, one_way_s);
  Go(t);
}

TimeNs ModemDriver::next() const {
  TimeNs first = kNever;
  if (!asked_.empty()) first = std::min(first, answer_due_);
  if (under_way_ || ping_ != 0) first = std::min(first, give_up_);
  if (ready_ && waiting_ && !under_way_ && asked_.empty() && ping_ == 0) {
    first = std::min(first, again_);
  }
  return first;
}

void ModemDriver::Tick(TimeNs t) {
  if (!asked_.empty() && t >= answer_due_) {
    if (times_asked_ < kMostAsked) {
      ++times_asked_;
      answer_due_ = t + kAnswerTime;
      world_->Write(asked_ + "\r\n");
    } else {
      connected_ = ready_ = false;
      asked_.clear();
      commands_.clear();
      world_->HangUp();
    }
  }
  if (under_way_ && t >= give_up_) {
    ++counts_.lost;
    Refuse("the modem did not send it", t);
  }
  if (ping_ != 0 && t >= give_up_) EndPing(-1.0, t);
  Go(t);
}

std::vector<std::string> DriverProtocols() { return {"s2c", "micromodem"}; }

std::unique_ptr<ModemDriver> MakeModemDriver(const std::string& protocol,
                                             const DriverOptions& options, DriverWorld* world) {
  DriverOptions chosen = options;
  if (protocol == "s2c") {
    if (chosen.broadcast < 0) chosen.broadcast = 255;
    return std::make_unique<s2c::S2cDriver>(chosen, world);
  }
  if (protocol == "micromodem") {
    if (chosen.broadcast < 0) chosen.broadcast = 0;
    return std::make_unique<micromodem::MicromodemDriver>(chosen, world);
  }
  throw UserError("protocol: '" + protocol + "' is neither s2c nor micromodem");
}

}  // namespace stg::acoustics
