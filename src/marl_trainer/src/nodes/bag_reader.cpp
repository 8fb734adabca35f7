#include "bag_reader.hpp"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/sound_bag.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "record_inlet.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

namespace fs = std::filesystem;

/// The first line in which two texts differ, for a message; empty if they are equal.
std::string Difference(const std::string& theirs, const std::string& ours) {
  if (theirs == ours) return "";
  std::istringstream a(theirs), b(ours);
  std::string x, y;
  do {
    x.clear();
    y.clear();
    std::getline(a, x);
    std::getline(b, y);
  } while (x == y && (a || b));
  return "'" + x.substr(0, 100) + "' instead of '" + y.substr(0, 100) + "'";
}

void ReadMessages(const rosbag::Bag& bag, int agents, const std::string& scenario,
                  RecordInlet* inlet, BagContents* contents) {
  std::map<std::string, int> agent_of;
  std::vector<std::string> topics{topics::kStepReport, topics::kScenario};
  for (int i = 0; i < agents; ++i) {
    const std::string topic = topics::AuvTopic(i, topics::kAgentStep);
    agent_of[topic] = i;
    topics.push_back(topic);
  }
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& m : view) {
    const auto agent = agent_of.find(m.getTopic());
    if (agent != agent_of.end()) {
      if (const auto step = m.instantiate<auv_msgs::AgentStep>()) {
        inlet->Add(agent->second, *step);
        continue;
      }
    } else if (m.getTopic() == topics::kStepReport) {
      if (const auto report = m.instantiate<auv_msgs::StepReport>()) {
        inlet->Add(*report);
        continue;
      }
    } else if (const auto text = m.instantiate<std_msgs::String>()) {
      const std::string difference = Difference(text->data, scenario);
      if (!difference.empty()) throw UserError("recorded in another scenario: " + difference);
      continue;
    }
    ++contents->foreign_messages;
  }
}

}  // namespace

BagContents ReadBag(const std::string& path, const RunConfig& run, const std::string& scenario) {
  BagContents contents;
  RecordInlet inlet(run, path);
  try {
    RequireSoundBag(path);
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    ReadMessages(bag, run.agents, scenario, &inlet, &contents);
  } catch (const UserError& error) {
    contents.error = error.what();
    return contents;
  } catch (const std::exception& error) {
    // rosbag throws its own errors; ROS throws overruns of a stream; sizes from damaged data cause
    // others.
    contents.error = std::string("damaged bag: ") + error.what();
  }
  contents.episodes = inlet.episodes().TakeAll();
  contents.foreign_messages += inlet.foreign();
  return contents;
}

std::vector<std::string> FindBags(const std::vector<std::string>& names) {
  std::vector<std::string> bags;
  for (const std::string& name : names) {
    std::error_code error;
    if (fs::is_directory(name, error)) {
      const std::size_t before = bags.size();
      for (const auto& entry : fs::directory_iterator(name, error)) {
        if (entry.path().extension() == ".bag") bags.push_back(entry.path().string());
      }
      if (bags.size() == before) throw UserError(name + ": no bag in this folder");
      std::sort(bags.begin() + static_cast<std::ptrdiff_t>(before), bags.end());
    } else if (fs::is_regular_file(name, error)) {
      bags.push_back(name);
    } else {
      throw UserError(name + ": no such bag or folder");
    }
  }
  return bags;
}

}  // namespace stg::nodes
