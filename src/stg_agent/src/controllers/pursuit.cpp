#include "stg_agent/controllers/pursuit.hpp"

#include <cstdlib>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_dynamics/control/control.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::agent {
namespace {

/// Repulsion reaches centimetres; more neighbours than this cannot be that close.
constexpr int kMaxRepelling = 16;

/// Takes one "name=value" of the controller called `text`.
void SetOption(const std::string& text, const std::string& item, PursuitOptions* options) {
  const std::size_t equals = item.find('=');
  const std::string name = item.substr(0, equals);
  bool found = false;
  VisitPursuitOptions(*options, [&](const char* known, double& field, const char*) {
    if (name != known) return;
    found = true;
    char* end = nullptr;
    const std::string value = equals == std::string::npos ? "" : item.substr(equals + 1);
    field = std::strtod(value.c_str(), &end);
    const double largest = &field == &options->cap ? 1.0 : 1e3;
    if (value.empty() || *end != '\0' || !(field >= 0.0 && field <= largest)) {
      throw UserError("'" + text + "': " + name + " must be a number from 0 to " +
                      (largest > 1.0 ? "1000" : "1"));
    }
  });
  if (!found) throw UserError("'" + text + "': no such constant: " + name);
}

}  // namespace

PursuitOptions BuiltinOptions(BuiltinKind kind) {
  PursuitOptions o;
  if (kind == BuiltinKind::kPursuitSeparated) {
    o.gain_per_s = 3.0;
    o.standoff_m = 0.0142;
    o.repulsion_gain_per_s = 2.0;
  }
  return o;
}

const char* ToString(BuiltinKind kind) {
  switch (kind) {
    case BuiltinKind::kIdle:
      return "idle";
    case BuiltinKind::kPursuit:
      return "pursuit";
    case BuiltinKind::kPursuitSeparated:
      return "pursuit_separated";
  }
  return "";
}

bool ParseBuiltin(const std::string& text, BuiltinKind* kind, PursuitOptions* options) {
  const std::size_t colon = text.find(':');
  for (const auto k : {BuiltinKind::kIdle, BuiltinKind::kPursuit, BuiltinKind::kPursuitSeparated}) {
    if (text.substr(0, colon) != ToString(k)) continue;
    *kind = k;
    *options = BuiltinOptions(k);
    std::istringstream rest(colon == std::string::npos ? "" : text.substr(colon + 1));
    for (std::string item; std::getline(rest, item, ',');) SetOption(text, item, options);
    return true;
  }
  return false;
}

void BuiltinAction(BuiltinKind kind, const PursuitOptions& options, const Agent& agent,
                   float* action) {
  const AgentConfig& s = agent.scenario();
  const Knowledge<double>& k = agent.knowledge();
  double a[6] = {};
  if (kind != BuiltinKind::kIdle) {
    Vec3<double> offsets[kMaxRepelling];
    int count = 0;
    if (options.repulsion_gain_per_s > 0.0) {
      int ids[kMaxRepelling];
      count = agent.neighbours().Nearest(kMaxRepelling, ids);
      for (int j = 0; j < count; ++j) offsets[j] = agent.neighbours().at(ids[j]).r_BN_W;
    }
    PursuitAction(options, s, k, offsets, count, a);
  }
  if (s.control.interface == dynamics::ActionInterface::kTau6 && kind != BuiltinKind::kIdle) {
    const Vec3<double> v_des_W = dynamics::DesiredVelocity(s.vehicle, a);
    dynamics::VelocityController(s.control, s.vehicle, v_des_W, k.R_WB, k.v_WB, RpyOf(k.trig),
                                 k.w_WB_B, a);
  }
  for (int n = 0; n < s.action_size(); ++n) action[n] = static_cast<float>(a[n]);
}

}  // namespace stg::agent
