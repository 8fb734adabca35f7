#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "auv_common/testing/temporary_folder.hpp"

namespace stg::acoustics {

/// Runs the program `simulate` as a user does.
class Simulate : public ::testing::Test {
 protected:
  struct Result {
    int code = -1;
    std::string out, err;
    nlohmann::json json;                         ///< the last line of `out`
    std::vector<std::vector<std::string>> rows;  ///< of packets.csv; the header comes first

    std::string Cell(std::size_t row, const std::string& column) const {
      for (std::size_t i = 0; i < rows[0].size(); ++i) {
        if (rows[0][i] == column) return rows[row][i];
      }
      ADD_FAILURE() << "no column " << column;
      return "";
    }
    double Number(std::size_t row, const std::string& column) const {
      return std::strtod(Cell(row, column).c_str(), nullptr);
    }
    /// The fate of a packet at a receiver, "" if no row has it.
    std::string Fate(int source, int destination, int sequence = 0) const {
      for (std::size_t i = 1; i < rows.size(); ++i) {
        if (Cell(i, "source") == std::to_string(source) &&
            Cell(i, "destination") == std::to_string(destination) &&
            Cell(i, "sequence") == std::to_string(sequence)) {
          return Cell(i, "fate");
        }
      }
      return "";
    }
    double Throughput(int id) const {
      for (const auto& receiver : json["receivers"]) {
        if (receiver["id"] == id) return receiver["throughput"];
      }
      return -1.0;
    }
  };

  static std::string Read(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  Result Command(const std::string& arguments) const {
    const std::string out = folder_ + "/stdout", err = folder_ + "/stderr";
    const int status = std::system(
        ("'" STG_SIMULATE "' " + arguments + " > '" + out + "' 2> '" + err + "'").c_str());
    Result result;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.out = Read(out);
    result.err = Read(err);
    std::istringstream in(result.out);
    std::string line, last;
    while (std::getline(in, line)) last = line;
    result.json = nlohmann::json::parse(last, nullptr, false);
    return result;
  }

  std::string Write(const std::string& text, const std::string& name = "network.yaml") const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }

  Result Run(const std::string& yaml, const std::string& options = "--quiet") const {
    Result result = Command("'" + Write(yaml) + "' --out '" + folder_ + "/out' " + options);
    std::istringstream packets(Read(folder_ + "/out/packets.csv"));
    for (std::string line; std::getline(packets, line);) {
      auto& row = result.rows.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    }
    return result;
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

/// One line of the list of nodes.
inline std::string NodeAt(int id, double x, double y) {
  char text[120];
  std::snprintf(text, sizeof(text), "  - {id: %d, position_m: [%.9f, %.9f, -20.0]}\n", id, x, y);
  return text;
}

/// Node 0 in the middle of a ring of `senders` nodes.
inline std::string Ring(int senders, double radius_m) {
  std::string text = "nodes:\n" + NodeAt(0, 0.0, 0.0);
  for (int i = 0; i < senders; ++i) {
    const double angle = 2.0 * 3.14159265358979323846 * i / senders;
    text += NodeAt(i + 1, radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return text;
}

/// Part of `channel.physical`: water in which nothing fades and sound travels at 1500 m/s.
inline const char* kSteadyWater =
    "    water: {sound_speed: profile}\n"
    "    propagation: {shadowing_db: 0.0, rician_k: 1.0e+9}\n";

}  // namespace stg::acoustics
