#include "auv_dynamics/scenario.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <charconv>
#include <cmath>

#include "auv_dynamics/error.hpp"
#include "scenario_schema.hpp"
#include "yaml_tree.hpp"

namespace stg {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

/// Shortest text that reads back as the same double, always with a point so
/// that every YAML reader takes it for a real number.
std::string FormatNumber(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  std::string text(buffer, result.ptr);
  if (text.find_first_of(".n") == std::string::npos) {
    const auto exponent = text.find('e');
    text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  }
  return text;
}

/// Bounds are written as a person would.
std::string FormatBound(double value) {
  char buffer[32];
  const auto result =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::general);
  return {buffer, result.ptr};
}

std::string FormatNumbers(const double* values, int size) {
  std::string text = "[";
  for (int i = 0; i < size; ++i) text += (i > 0 ? ", " : "") + FormatNumber(values[i]);
  return text + "]";
}

/// Quotes the words that some YAML readers take for something else.
std::string FormatWord(const std::string& word) {
  for (const char* special : {"on", "off", "yes", "no", "true", "false", "null", "y", "n"}) {
    if (word == special) return "\"" + word + "\"";
  }
  return word;
}

bool IsName(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (text.empty() || text.size() > 64 || !letter(text[0])) return false;
  for (const char c : text) {
    if (!letter(c) && !(c >= '0' && c <= '9') && c != '_' && c != '-') return false;
  }
  return true;
}

std::optional<std::string> CheckNumbers(const ScenarioField& field, const double* values,
                                        int size) {
  for (int i = 0; i < size; ++i) {
    if (!std::isfinite(values[i])) return "must be finite";
    if (!field.limits.Contain(values[i])) {
      return FormatNumber(values[i]) + " is out of range " + FormatRange(field);
    }
  }
  return {};
}

bool IsWhole(double value) { return std::abs(value - std::round(value)) < 1e-6; }

/// Fossen's M = M_RB + M_A about the body origin.
bool MassMatrixIsPositive(const VehicleConfig& v) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    m(i, i) = v.mass_kg - v.added_mass[k];
    m(i + 3, i + 3) = v.inertia_kgm2[k] - v.added_mass[k + 3];
  }
  const auto [x, y, z] = v.r_BG_m;
  Eigen::Matrix3d s;
  s << 0.0, -z, y, z, 0.0, -x, -y, x, 0.0;
  m.topRightCorner<3, 3>() = -v.mass_kg * s;
  m.bottomLeftCorner<3, 3>() = v.mass_kg * s;
  return m.llt().info() == Eigen::Success;
}

/// Can AUVs be drawn one after the other with this separation around their
/// target? The share of the shell's volume that balls of half the separation
/// may fill stays below what random placement reaches (about 0.38).
bool StartsFit(const ResetConfig& reset, const ResetStageConfig& stage, double auvs_per_target) {
  constexpr double kShare = 0.25;
  const double half = 0.5 * reset.min_separation_m;
  const double outer = stage.auv_distance_m.hi + half;
  const double inner = std::max(0.0, stage.auv_distance_m.lo - half);
  return auvs_per_target <= 1.0 || auvs_per_target * half * half * half <=
                                       kShare * (outer * outer * outer - inner * inner * inner);
}

std::optional<Violation> CheckStage(const Scenario& s, int index) {
  const char* const names[] = {"easy", "medium", "hard"};
  const std::string path = std::string("reset.stages.") + names[index] + ".";
  const ResetStageConfig& stage = s.reset.stages[static_cast<std::size_t>(index)];
  if (stage.target_radius_m.hi > s.workspace.half_extent_m) {
    return Violation{{path + "target_radius_m", "workspace.half_extent_m"},
                     "a target would start outside the walls"};
  }
  if (stage.target_speed_mps.hi > s.target.max_speed_mps) {
    return Violation{{path + "target_speed_mps", "target.max_speed_mps"},
                     "a target would start faster than its largest speed"};
  }
  if (stage.auv_distance_m.lo > s.reset.start_half_extent_m) {
    return Violation{{path + "auv_distance_m", "reset.start_half_extent_m"},
                     "AUVs cannot start this far from a target within the start region"};
  }
  const bool used = s.reset.curriculum || static_cast<int>(s.reset.stage) == index;
  const double crowd = std::ceil(static_cast<double>(s.agents) / s.target.count);
  if (used && !StartsFit(s.reset, stage, crowd)) {
    return Violation{{"agents", path + "auv_distance_m", "reset.min_separation_m"},
                     "so many AUVs do not fit around a target with this separation"};
  }
  return {};
}

std::optional<Violation> CheckRules(const Scenario& s) {
  if (!IsWhole(s.time.dt_s * 1e9)) {
    return Violation{{"time.dt_s"}, "must be a whole number of nanoseconds"};
  }
  if (s.time.tail_steps > s.time.episode_steps) {
    return Violation{{"time.tail_steps", "time.episode_steps"},
                     "the tail cannot be longer than the episode"};
  }
  if (!MassMatrixIsPositive(s.vehicle)) {
    return Violation{{"vehicle.r_BG_m", "vehicle.inertia_kgm2"},
                     "the mass matrix is not positive definite"};
  }
  if (s.vehicle.radius_m >= s.workspace.half_extent_m) {
    return Violation{{"vehicle.radius_m", "workspace.half_extent_m"},
                     "an AUV does not fit between the walls"};
  }
  if (s.target.count > s.agents) {
    return Violation{{"target.count", "agents"}, "there cannot be more targets than AUVs"};
  }
  if (s.reset.start_half_extent_m > s.workspace.half_extent_m) {
    return Violation{{"reset.start_half_extent_m", "workspace.half_extent_m"},
                     "AUVs would start outside the walls"};
  }
  if (s.reset.curriculum_medium_resets < s.reset.curriculum_easy_resets) {
    return Violation{{"reset.curriculum_medium_resets", "reset.curriculum_easy_resets"},
                     "the medium stage cannot end before the easy one"};
  }
  for (int i = 0; i < 3; ++i) {
    if (auto violation = CheckStage(s, i)) return violation;
  }
  if (s.channel.transmit_period_s < s.decision_dt_s() * (1.0 - 1e-9)) {
    return Violation{{"channel.transmit_period_s", "time.dt_s", "time.decision_steps"},
                     "an AUV sends at most one packet per decision"};
  }
  if (s.observation.quality_medium > s.observation.quality_high) {
    return Violation{{"observation.quality_medium", "observation.quality_high"},
                     "medium quality cannot begin above high quality"};
  }
  if (s.reward.lost_distance_m <= s.reward.band_m.hi) {
    return Violation{{"reward.lost_distance_m", "reward.band_m"},
                     "a target inside the tracking band would count as lost"};
  }
  if (s.reward.weights.separation > 0.0 &&
      s.reward.separation_distance_m <= 2.0 * s.vehicle.radius_m) {
    return Violation{{"reward.separation_distance_m", "vehicle.radius_m"},
                     "the penalty must set in before contact, at two radii"};
  }
  return {};
}

}  // namespace

std::string FormatValue(const ValueRef& value) {
  return std::visit(Overload{[](double* v) { return FormatNumber(*v); },
                             [](int* v) { return std::to_string(*v); },
                             [](std::uint64_t* v) { return std::to_string(*v); },
                             [](bool* v) { return std::string(*v ? "true" : "false"); },
                             [](std::string* v) { return FormatWord(*v); },
                             [](const EnumRef& v) {
                               const auto index = static_cast<std::size_t>(v.get());
                               return index < v.names.size() ? FormatWord(v.names[index])
                                                             : std::string("?");
                             },
                             [](const NumbersRef& v) { return FormatNumbers(v.data, v.size); },
                             [](Interval* v) {
                               const double ends[] = {v->lo, v->hi};
                               return FormatNumbers(ends, 2);
                             }},
                    value);
}

std::string FormatRange(const ScenarioField& field) {
  const std::string range = std::string(field.limits.lo_excluded ? "(" : "[") +
                            FormatBound(field.limits.lo) + ", " + FormatBound(field.limits.hi) +
                            "]";
  return std::visit(
      Overload{[&](double*) { return range; }, [&](int*) { return range; },
               [](std::uint64_t*) { return std::string("[0, 18446744073709551615]"); },
               [](bool*) { return std::string("true | false"); },
               [](std::string*) { return std::string("a letter, then letters, digits, _ or -"); },
               [](const EnumRef& v) {
                 std::string names;
                 for (const auto& name : v.names) names += (names.empty() ? "" : " | ") + name;
                 return names;
               },
               [&](const NumbersRef&) { return range; },
               [&](Interval*) { return range + ", low <= high"; }},
      field.value);
}

std::optional<std::string> CheckValue(const ScenarioField& field) {
  using Result = std::optional<std::string>;
  return std::visit(
      Overload{[&](double* v) { return CheckNumbers(field, v, 1); },
               [&](int* v) -> Result {
                 if (field.limits.Contain(*v)) return {};
                 return std::to_string(*v) + " is out of range " + FormatRange(field);
               },
               [](std::uint64_t*) -> Result { return {}; }, [](bool*) -> Result { return {}; },
               [&](std::string* v) -> Result {
                 if (IsName(*v)) return {};
                 return Quoted(*v) + " is no name (" + FormatRange(field) + ", 64 at most)";
               },
               [&](const EnumRef& v) -> Result {
                 if (v.get() >= 0 && static_cast<std::size_t>(v.get()) < v.names.size()) return {};
                 return "must be one of " + FormatRange(field);
               },
               [&](const NumbersRef& v) { return CheckNumbers(field, v.data, v.size); },
               [&](Interval* v) -> Result {
                 const double ends[] = {v->lo, v->hi};
                 if (auto message = CheckNumbers(field, ends, 2)) return message;
                 if (v->lo > v->hi)
                   return "low " + FormatNumber(v->lo) + " is above high " + FormatNumber(v->hi);
                 return {};
               }},
      field.value);
}

std::optional<Violation> FindViolation(const Scenario& scenario) {
  Scenario copy = scenario;
  for (const ScenarioField& field : ScenarioFields(&copy)) {
    if (auto message = CheckValue(field)) return Violation{{field.path}, *message};
  }
  return CheckRules(copy);
}

void Scenario::ValidateOrThrow() const {
  const auto violation = FindViolation(*this);
  if (!violation) return;
  std::string text = "scenario: " + violation->keys[0] + ": " + violation->message;
  for (std::size_t i = 1; i < violation->keys.size(); ++i) {
    text += (i == 1 ? " (see " : ", ") + violation->keys[i];
  }
  throw UserError(text + (violation->keys.size() > 1 ? ")" : ""));
}

}  // namespace stg
