#include "pllit/base/robust.hpp"

#include <gtest/gtest.h>

namespace pllit {
namespace {

using Points = std::vector<std::pair<double, double>>;

TEST(TheilSen, GivesTheSlopeOfALine) {
  EXPECT_NEAR(theil_sen_slope(Points{{0.0, 1.0}, {1.0, 3.0}, {4.0, 9.0}}).value(), 2.0, 1e-12);
  EXPECT_NEAR(theil_sen_slope(Points{{5.0, 1.0}, {5.0, 2.0}, {7.0, 0.0}}).value(), -0.75, 1e-12);
}

TEST(TheilSen, HeedsNoOutlierAmongFour) {
  EXPECT_NEAR(theil_sen_slope(Points{{0.0, 0.0}, {1.0, 1.0}, {2.0, -500.0}, {3.0, 3.0}, {4.0, 4.0}}).value(), 1.0,
              1e-12);
}

TEST(TheilSen, GivesNothingWhereNoTwoDiffer) {
  EXPECT_FALSE(theil_sen_slope(Points{}));
  EXPECT_FALSE(theil_sen_slope(Points{{1.0, 2.0}}));
  EXPECT_FALSE(theil_sen_slope(Points{{1.0, 2.0}, {1.0, 9.0}}));
}

}  // namespace
}  // namespace pllit
