#include "pllit/thermal/selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;
using test::Random;

struct Image {
  Features features;
  std::vector<std::optional<FeatureDepth>> depths;

  void add(const Vector2f& px, float score, std::optional<double> range_m) {
    features.points_px.push_back(px);
    features.scores.push_back(score);
    depths.push_back(range_m ? std::optional(FeatureDepth{.range_m = *range_m, .sigma_m = 0.02}) : std::nullopt);
  }
};

Vector2f anywhere(Random& random) {
  return Vector2f(static_cast<float>(random.uniform(0.0, 639.0)), static_cast<float>(random.uniform(0.0, 511.0)));
}

TEST(SelectFeatures, SpreadsThemOverTheRangesHoweverManyLieInOne) {
  Random random(61);
  Image image;
  for (int i = 0; i < 3000; ++i) image.add(anywhere(random), 0.9F, random.uniform(5.0, 8.0));  // a crowded interval
  for (int i = 0; i < 300; ++i) image.add(anywhere(random), 0.1F, random.uniform(8.0, 45.0));
  image.add(anywhere(random), 0.1F, 45.0);
  const auto chosen = select_features(image.features, image.depths, test::thermal_camera(), {.count = 200});
  std::vector<int> counts(10, 0);
  for (const int i : chosen)
    ++counts[std::min<std::size_t>(9, static_cast<std::size_t>((image.depths[i]->range_m - 5.0) / 4.0))];
  for (const int count : counts) EXPECT_GE(count, 12);
  EXPECT_TRUE(std::ranges::is_sorted(chosen));
  EXPECT_EQ(std::set(chosen.begin(), chosen.end()).size(), chosen.size());
}

TEST(SelectFeatures, SpreadsTheNearFieldOverTheImage) {
  Random random(62);
  Image image;
  for (int i = 0; i < 2000; ++i)  // a crowd in one corner, with the better scores
    image.add(0.15F * anywhere(random), 0.9F, 3.0);
  for (int i = 0; i < 600; ++i) image.add(anywhere(random), 0.1F, 3.0);
  const auto chosen = select_features(image.features, image.depths, test::thermal_camera(), {.count = 300});
  const auto outside = std::ranges::count_if(chosen, [&](int i) { return i >= 2000; });
  EXPECT_GT(outside, 120);
}

TEST(SelectFeatures, PrefersTheBetterOfOnePlace) {
  Image image;
  for (int i = 0; i < 100; ++i) image.add(Vector2f(100.0F, 100.0F), 0.01F * static_cast<float>(i), 3.0);
  const auto chosen = select_features(image.features, image.depths, test::thermal_camera(), {.count = 10});
  EXPECT_EQ(chosen, (std::vector<int>{90, 91, 92, 93, 94, 95, 96, 97, 98, 99}));
}

TEST(SelectFeatures, LeavesNoPartOfTheImageEmptyThatHasFeatures) {
  Random random(63);
  Image image;
  for (int i = 0; i < 1000; ++i) image.add(0.3F * anywhere(random), 0.9F, random.uniform(1.0, 30.0));
  image.add(Vector2f(600.0F, 480.0F), 0.01F, std::nullopt);
  image.add(Vector2f(600.0F, 40.0F), 0.01F, 20.0);
  const auto chosen = select_features(image.features, image.depths, test::thermal_camera(), {.count = 50});
  EXPECT_TRUE(std::ranges::contains(chosen, 1000));
  EXPECT_TRUE(std::ranges::contains(chosen, 1001));
}

TEST(SelectFeatures, AddsThoseNearLines) {
  Random random(64);
  Image image;
  for (int i = 0; i < 1000; ++i) image.add(anywhere(random), 0.9F, 3.0);
  for (int i = 0; i < 6; ++i) image.add(Vector2f(200.0F + 10.0F * static_cast<float>(i), 302.0F), 0.01F, 3.0);
  image.features.lines.push_back({.start_px = Vector2f(195.0F, 300.0F), .end_px = Vector2f(255.0F, 300.0F)});
  const SelectionConfig config{.count = 100, .line_px = 3.0, .line_points = 4};
  const auto with = select_features(image.features, image.depths, test::thermal_camera(), config);
  image.features.lines.clear();
  const auto without = select_features(image.features, image.depths, test::thermal_camera(), config);
  EXPECT_GT(with.size(), without.size());
  EXPECT_LE(with.size(), without.size() + 4);
  EXPECT_TRUE(std::ranges::includes(with, without));
}

TEST(SelectFeatures, TakesAllWhereThereAreFew) {
  Random random(65);
  Image image;
  for (int i = 0; i < 50; ++i) image.add(anywhere(random), 0.5F, random.uniform(1.0, 50.0));
  EXPECT_EQ(select_features(image.features, image.depths, test::thermal_camera(), {.count = 300}).size(), 50);
  EXPECT_TRUE(select_features({}, {}, test::thermal_camera(), {}).empty());
}

}  // namespace
}  // namespace pllit
