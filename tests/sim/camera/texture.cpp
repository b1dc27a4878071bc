#include "pllit/sim/camera/texture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

using Kind = Texture::Kind;

Texture texture_of(Kind kind) { return {.kind = kind, .scale_m = 0.5F, .contrast = 1.0F, .seed = 42}; }

/// Values at random places on a wall that looks along -y.
std::vector<float> wall_values(const Texture& texture) {
  Random random(1);
  std::vector<float> values;
  for (int i = 0; i < 200'000; ++i) {
    const Vector3f p(static_cast<float>(random.uniform(-40.0, 40.0)), 4.0F,
                     static_cast<float>(random.uniform(-40.0, 40.0)));
    values.push_back(texture_value(texture, p, -Vector3f::UnitY(), 0.0F));
  }
  return values;
}

class EveryTexture : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryTexture,
                         testing::Values(Kind::clouds, Kind::bricks, Kind::tiles, Kind::planks, Kind::speckle,
                                         Kind::stains, Kind::wires));

TEST_P(EveryTexture, StaysWithinOneAndAveragesAboutZero) {
  const std::vector<float> values = wall_values(texture_of(GetParam()));
  double sum = 0.0, squares = 0.0;
  for (const float value : values) {
    ASSERT_LE(std::abs(value), 1.0F);
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  EXPECT_LT(std::abs(sum / count), 0.06);
  EXPECT_GT(std::sqrt(squares / count), 0.15);
  EXPECT_GT(std::max(std::ranges::max(values), -std::ranges::min(values)), 0.8F);
}

TEST_P(EveryTexture, IsAFunctionOfPlaceAndSeedAlone) {
  Texture other = texture_of(GetParam());
  other.seed = 43;
  const std::vector<float> once = wall_values(texture_of(GetParam()));
  EXPECT_EQ(once, wall_values(texture_of(GetParam())));
  EXPECT_NE(once, wall_values(other));
}

TEST_P(EveryTexture, FadesWhereAPixelSeesManyOfItsFeatures) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vector3f p(static_cast<float>(random.uniform(-40.0, 40.0)), 4.0F,
                     static_cast<float>(random.uniform(-40.0, 40.0)));
    EXPECT_NEAR(texture_value(texture_of(GetParam()), p, -Vector3f::UnitY(), 5.0F), 0.0F, 1e-6F);
  }
}

TEST(Texture, CloudsHaveNoJumps) {
  const Texture clouds = texture_of(Kind::clouds);
  for (int i = 0; i < 100'000; ++i) {
    const Vector3f p = static_cast<float>(i) * Vector3f(1e-4F, 0.6e-4F, 0.3e-4F);
    const Vector3f next = p + Vector3f::Constant(1e-4F);
    EXPECT_LT(std::abs(texture_value(clouds, next, Vector3f::UnitZ(), 0.0F) -
                       texture_value(clouds, p, Vector3f::UnitZ(), 0.0F)),
              5e-3F);
  }
}

TEST(Texture, StainsHaveSharpEdges) {
  const Texture stains = texture_of(Kind::stains);
  float steepest = 0.0F;
  for (int i = 0; i < 100'000; ++i) {
    const Vector3f p(static_cast<float>(i) * 1e-3F, 0.3F, 0.2F);
    const Vector3f next = p + Vector3f(0.01F, 0.0F, 0.0F);
    steepest = std::max(steepest, std::abs(texture_value(stains, next, Vector3f::UnitZ(), 0.0F) -
                                           texture_value(stains, p, Vector3f::UnitZ(), 0.0F)));
  }
  EXPECT_GT(steepest, 0.9F);
}

TEST(Texture, BrickJointsLieLevelOnAWallOfAnyHeading) {
  const Texture bricks = texture_of(Kind::bricks);
  for (const float heading : {0.0F, 0.4F, 1.9F}) {
    const Vector3f normal(std::cos(heading), std::sin(heading), 0.0F),
        along(-std::sin(heading), std::cos(heading), 0.0F);
    for (int i = 0; i < 1000; ++i)  // in the middle of a bed joint
      EXPECT_EQ(
          texture_value(bricks, static_cast<float>(i) * 0.01F * along + Vector3f(0.0F, 0.0F, 0.01F), normal, 0.0F),
          -1.0F);
  }
}

}  // namespace
}  // namespace pllit
