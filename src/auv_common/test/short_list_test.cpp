#include "auv_common/numbers/short_list.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stg {
namespace {

struct Item {
  int value = 7;
};
using Items = ShortList<Item, 3>;

std::vector<int> ValuesOf(const Items& items) {
  std::vector<int> values;
  for (const Item& item : items) values.push_back(item.value);
  return values;
}

TEST(ShortList, HoldsWhatWasAppended) {
  Items items;
  EXPECT_TRUE(items.empty());
  items.push_back({1});
  items.push_back({}).value += 1;
  EXPECT_EQ(ValuesOf(items), (std::vector<int>{1, 8}));
  EXPECT_EQ(items[1].value, 8);
  EXPECT_FALSE(items.full());
  items.push_back({3});
  EXPECT_TRUE(items.full());
  items.pop_back();
  EXPECT_EQ(ValuesOf(items), (std::vector<int>{1, 8}));
  items.clear();
  EXPECT_EQ(items.size(), 0);
}

TEST(ShortList, CopiesAreIndependentAndOfTheSameSize) {
  Items one;
  one.push_back({1});
  Items many;
  for (const int k : {4, 5, 6}) many.push_back({k});
  Items copy(many);
  many[0].value = 0;
  EXPECT_EQ(ValuesOf(copy), (std::vector<int>{4, 5, 6}));
  copy = one;
  EXPECT_EQ(ValuesOf(copy), (std::vector<int>{1}));
  copy.push_back({2});
  EXPECT_EQ(ValuesOf(copy), (std::vector<int>{1, 2}));
  const Items& same = copy;
  copy = same;
  EXPECT_EQ(ValuesOf(copy), (std::vector<int>{1, 2}));
}

TEST(ShortList, InsertingIntoAFullListDropsItsLastValue) {
  Items items;
  items.insert(0, {2});
  items.insert(0, {1});
  items.insert(2, {3});
  EXPECT_EQ(ValuesOf(items), (std::vector<int>{1, 2, 3}));
  items.insert(1, {9});
  EXPECT_EQ(ValuesOf(items), (std::vector<int>{1, 9, 2}));
  items.insert(2, {8});
  EXPECT_EQ(ValuesOf(items), (std::vector<int>{1, 9, 8}));
}

}  // namespace
}  // namespace stg
