#include <gtest/gtest.h>

#include <set>

#include "scenario_fields.hpp"

namespace stg {
namespace {

/// Another allowed value of the same type; false when there is none.
bool Change(const config::Field& field) {
  const auto other = [&](double v) {
    const double middle = 0.5 * (field.limits.lo + field.limits.hi);
    return v == middle ? 0.75 * middle : middle;
  };
  if (auto v = std::get_if<double*>(&field.value)) **v = other(**v);
  if (auto v = std::get_if<int*>(&field.value)) **v += 1;
  if (auto v = std::get_if<std::uint64_t*>(&field.value)) **v += 1;
  if (auto v = std::get_if<bool*>(&field.value)) **v = !**v;
  if (auto v = std::get_if<std::string*>(&field.value)) **v += "x";
  if (auto v = std::get_if<config::EnumRef>(&field.value)) {
    if (v->names.size() == 1) return false;
    v->set((v->get() + 1) % static_cast<int>(v->names.size()));
  }
  if (auto v = std::get_if<config::NumbersRef>(&field.value)) v->data[v->size - 1] += 0.5;
  if (auto v = std::get_if<config::Interval*>(&field.value)) (*v)->hi += 0.5;
  return true;
}

TEST(Scenario, HashAndFileChangeWithEveryKey) {
  Scenario scenario;
  std::set<std::string> hashes{ScenarioHash(scenario)};
  const std::size_t count = ScenarioFields(&scenario).size();
  std::size_t fixed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Scenario changed;
    const config::Field field = ScenarioFields(&changed)[i];
    if (!Change(field)) {
      ++fixed;
      continue;
    }
    EXPECT_TRUE(hashes.insert(ScenarioHash(changed)).second) << field.path;
  }
  EXPECT_EQ(hashes.size(), count - fixed + 1);
  EXPECT_LT(fixed, 4u) << "keys with one value only";
  EXPECT_EQ(ScenarioHash(scenario), ScenarioHash(Scenario{}));
}

}  // namespace
}  // namespace stg
