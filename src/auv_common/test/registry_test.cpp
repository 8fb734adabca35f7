#include "auv_common/registry.hpp"

#include <gtest/gtest.h>

#include "auv_common/config/value.hpp"

namespace stg {
namespace {

struct Shape {
  virtual ~Shape() = default;
  virtual double area() const = 0;
};
struct Square : Shape {
  explicit Square(double side) : side(side) {}
  double area() const override { return side * side; }
  double side;
};
struct Disc : Shape {
  explicit Disc(double radius) : radius(radius) {}
  double area() const override { return 3.0 * radius * radius; }
  double radius;
};

using ShapeRegistry = Registry<Shape, double>;

template <class T>
std::unique_ptr<Shape> MakeShape(double size) {
  return std::make_unique<T>(size);
}

ShapeRegistry Shapes() {
  return ShapeRegistry("shape", {{"square", MakeShape<Square>}, {"disc", MakeShape<Disc>}});
}

std::string MessageOf(const ShapeRegistry& shapes, const std::string& name) {
  try {
    shapes.Make(name, 1.0);
  } catch (const UserError& e) {
    return e.what();
  }
  return "made";
}

TEST(Registry, MakesWhatTheNameSays) {
  const ShapeRegistry shapes = Shapes();
  EXPECT_EQ(shapes.Make("square", 2.0)->area(), 4.0);
  EXPECT_EQ(shapes.Make("disc", 2.0)->area(), 12.0);
}

TEST(Registry, NamesComeInTheOrderOfRegistration) {
  ShapeRegistry shapes = Shapes();
  shapes.Add("blob", MakeShape<Disc>);
  EXPECT_EQ(shapes.Names(), (std::vector<std::string>{"square", "disc", "blob"}));
  EXPECT_TRUE(shapes.Has("blob"));
  EXPECT_FALSE(shapes.Has("bl"));
}

TEST(Registry, KnowsWhichThingsAreTheSuitesOwn) {
  ShapeRegistry shapes = Shapes();
  shapes.Add("other", MakeShape<Disc>);
  EXPECT_TRUE(shapes.IsOwn("square"));
  EXPECT_TRUE(shapes.IsOwn("disc"));
  EXPECT_FALSE(shapes.IsOwn("other"));
  EXPECT_FALSE(shapes.IsOwn("none"));
}

TEST(Registry, UnknownNameListsTheNamesAndSuggestsTheNearest) {
  const ShapeRegistry shapes = Shapes();
  EXPECT_EQ(MessageOf(shapes, "sqare"),
            "unknown shape 'sqare', expected one of square | disc; did you mean square?");
  EXPECT_EQ(MessageOf(shapes, "hexagon"), "unknown shape 'hexagon', expected one of square | disc");
  EXPECT_EQ(MessageOf(shapes, std::string(1000, 'x')).substr(0, 15), "unknown shape '");
  EXPECT_LT(MessageOf(shapes, std::string(1000, 'x')).size(), 150u);
}

TEST(Registry, RefusesDuplicatesBadNamesAndEmptyFactories) {
  ShapeRegistry shapes = Shapes();
  EXPECT_THROW(shapes.Add("disc", MakeShape<Square>), std::logic_error);
  EXPECT_THROW(shapes.Add("", MakeShape<Square>), std::logic_error);
  EXPECT_THROW(shapes.Add("two words", MakeShape<Square>), std::logic_error);
  EXPECT_THROW(shapes.Add("nothing", nullptr), std::logic_error);
  EXPECT_EQ(shapes.Names().size(), 2u);
  EXPECT_EQ(shapes.Make("disc", 1.0)->area(), 3.0);  // the first entry stays
}

TEST(Registry, FactoryThatMakesNothingIsABug) {
  ShapeRegistry shapes = Shapes();
  shapes.Add("hole", [](double) { return std::unique_ptr<Shape>(); });
  EXPECT_THROW(shapes.Make("hole", 1.0), std::logic_error);
}

/// A configuration key that holds the name of a registered thing.
class NameKey : public ::testing::Test {
 protected:
  config::Field field() {
    return {"shape.model", config::Name(&model_, Shapes().Names()), config::kNone, "-",
            "its shape"};
  }
  std::string Parse(const std::string& text) {
    return config::ParseValue(field(), config::ParseYaml(text, "test")).value_or("");
  }
  std::string model_ = "square";
};

TEST_F(NameKey, ReadsAndWritesTheName) {
  EXPECT_EQ(Parse("disc"), "");
  EXPECT_EQ(model_, "disc");
  EXPECT_EQ(config::FormatValue(field().value), "disc");
}

TEST_F(NameKey, RefusalListsTheNamesAndLeavesTheValue) {
  EXPECT_EQ(config::FormatRange(field()), "square | disc");
  EXPECT_EQ(Parse("cube"), "expected one of square | disc, found 'cube'");
  EXPECT_EQ(Parse("[disc]"), "expected one of square | disc, found a sequence");
  EXPECT_EQ(model_, "square");
}

TEST_F(NameKey, ValueFromCodeIsChecked) {
  EXPECT_FALSE(config::CheckValue(field()).has_value());
  model_ = "cube";
  EXPECT_EQ(config::CheckValue(field()).value_or(""), "must be one of square | disc");
}

}  // namespace
}  // namespace stg
