#include <log4cxx/level.h>
#include <log4cxx/logger.h>
#include <log4cxx/logmanager.h>
#include <ros/console.h>
#include <ros/console_impl.h>

#include <map>
#include <string>

/// Replaces a function of rosconsole, which the service ~get_loggers of every node calls
/// (`rosconsole list`, rqt_logger_level). With log4cxx 0.13 and later, the original takes ownership
/// of the registry of all loggers and deletes it: the node crashes at its next message, or at the
/// next call. The definition below is found before the original, as that of loopback.cpp is, and
/// gives the same answer.
namespace {

using Level = ros::console::Level;

Level LevelOf(int value) {
  if (value <= log4cxx::Level::DEBUG_INT) return Level::Debug;
  if (value <= log4cxx::Level::INFO_INT) return Level::Info;
  if (value <= log4cxx::Level::WARN_INT) return Level::Warn;
  return value <= log4cxx::Level::ERROR_INT ? Level::Error : Level::Fatal;
}

}  // namespace

bool ros::console::impl::get_loggers(std::map<std::string, levels::Level>& loggers) {
  for (const log4cxx::LoggerPtr& logger : log4cxx::LogManager::getCurrentLoggers()) {
    loggers[logger->getName()] = LevelOf(logger->getEffectiveLevel()->toInt());
  }
  return true;
}
