#include "pllit/base/words.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace pllit {
namespace {

TEST(EditDistance, CountsSingleMistakesOnce) {
  EXPECT_EQ(edit_distance("voxel", "voxel"), 0u);
  EXPECT_EQ(edit_distance("voxl", "voxel"), 1u);
  EXPECT_EQ(edit_distance("voxxel", "voxel"), 1u);
  EXPECT_EQ(edit_distance("vozel", "voxel"), 1u);
  EXPECT_EQ(edit_distance("vxoel", "voxel"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
}

TEST(EditDistance, IsSymmetric) {
  const std::vector<std::string> words{"", "a", "map", "amp", "radius_m", "radius", "lidar.range_m"};
  for (const std::string& a : words) {
    for (const std::string& b : words) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " " << b;
  }
}

TEST(NearestWord, IsTheFirstOfTheNearest) {
  const std::vector<std::string> words{"run", "eval", "rum"};
  EXPECT_EQ(nearest_word("ru", words), "run");
  EXPECT_EQ(nearest_word("evla", words), "eval");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace pllit
