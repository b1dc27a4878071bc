#include "pllit/map/line_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::Vector4d;
using test::Random;

struct Edge {
  Vector3d a_W = Vector3d(5.0, 1.0, -0.6), b_W = Vector3d(5.2, 1.1, 0.7);
};

struct Noise {
  double ray_m = 0.03, across_m = 0.01, common_m = 0.01, false_share = 0.0;
};

/// What cameras that move past an edge see of it.
std::vector<LineSighting> sightings_of(const Edge& edge, Random& random, const Noise& noise, int sightings = 8,
                                       int points = 12) {
  std::vector<LineSighting> all;
  for (int s = 0; s < sightings; ++s) {
    LineSighting sighting{.T_W_C = pose_from(random.rotation(), Vector3d(0.3 * s, -0.5, 0.0) + random.vector(0.05)),
                          .points = {}};
    const Vector3d common = random.vector(noise.common_m);
    for (int i = 0; i < points; ++i) {
      const double share = random.uniform(0.0, 1.0);
      Vector3d p_W = edge.a_W + share * (edge.b_W - edge.a_W);
      const Vector3d ray = (p_W - sighting.T_W_C.translation()).normalized();
      Vector3d across = random.vector(noise.across_m);
      across -= across.dot(ray) * ray;
      p_W += common + across + random.normal(noise.ray_m) * ray;
      if (random.uniform(0.0, 1.0) < noise.false_share) p_W += random.vector(0.5);
      sighting.points.push_back(
          {.p_C = sighting.T_W_C.inverse().act(p_W), .sigma_ray_m = noise.ray_m, .sigma_across_m = noise.across_m});
    }
    all.push_back(sighting);
  }
  return all;
}

/// The true shifts of a fitted line's ends.
Vector4d shifts_to(const Edge& edge, const LineLandmark& line) {
  const Line3 truth = Line3::through(edge.a_W, edge.b_W - edge.a_W);
  Vector4d shifts;
  for (int end = 0; end < 2; ++end) {
    const Vector3d p = line.centroid + (end == 0 ? -1.0 : 1.0) * line.half_length_m * line.axis.direction;
    // Where the plane through p and across the line meets the truth.
    const Vector3d q = truth.nearest_to_origin();
    const double along = (p - q).dot(line.axis.direction) / truth.direction.dot(line.axis.direction);
    const Vector3d off = q + along * truth.direction - p;
    shifts.segment<2>(2 * end) << off.dot(line.u), off.dot(line.v);
  }
  return shifts;
}

TEST(FitLine, ErrsByWhatItsCovarianceSays) {
  double normalised = 0.0, worst_m = 0.0;
  constexpr int trials = 60;
  for (unsigned seed = 0; seed < trials; ++seed) {
    Random random(seed);
    const Edge edge;
    const auto line = fit_line(sightings_of(edge, random, {}), {});
    ASSERT_TRUE(line) << seed;
    const Vector4d shifts = shifts_to(edge, *line);
    normalised += shifts.dot(line->covariance_m2.ldlt().solve(shifts)) / (4.0 * trials);
    worst_m = std::max(worst_m, shifts.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(normalised, 0.5);
  EXPECT_LT(normalised, 2.0);
  EXPECT_LT(worst_m, 0.03);
}

/// A camera that nears a post on a wall beside it: each image sees the post's edge a pixel or so off, and the depths
/// are the wall's, which it sees so flatly that the edge slides along it by a hand's breadth from afar.
std::vector<LineSighting> nearing(Random& random, const Edge& edge, double focal_px) {
  std::vector<LineSighting> all;
  for (int s = 0; s < 12; ++s) {
    const Vector3d camera_W(0.4 * s, 0.0, 0.0);
    LineSighting sighting{.T_W_C = pose_from(random.rotation(), camera_W), .points = {}};
    const double off_a = random.normal(1.0), off_b = random.normal(1.0);
    for (int i = 0; i < 12; ++i) {
      const double share = i / 11.0;
      const Vector3d p_W = edge.a_W + share * (edge.b_W - edge.a_W), seen = p_W - camera_W;
      const double slide_m = seen.squaredNorm() / (focal_px * edge.a_W.y());  // along the wall, a pixel's
      const Vector3d slide_W = slide_m * Vector3d::UnitX();
      const Vector3d observed_W = p_W + ((1.0 - share) * off_a + share * off_b) * slide_W;
      const Vector3d ray = (observed_W - camera_W).normalized();
      sighting.points.push_back({.p_C = sighting.T_W_C.inverse().act(observed_W + random.normal(0.01) * ray),
                                 .sigma_ray_m = 0.01,
                                 .sigma_across_m = 0.003,
                                 .slide_C_m = sighting.T_W_C.rotation().transpose() * slide_W});
    }
    all.push_back(sighting);
  }
  return all;
}

TEST(FitLine, KnowsHowFarAnEdgeSlidesAlongAWallThatItSeesFlatly) {
  const Edge edge{.a_W = Vector3d(7.0, 1.0, -0.6), .b_W = Vector3d(7.0, 1.0, 0.6)};
  double normalised = 0.0, worst_m = 0.0;
  int fitted = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(200 + seed);
    const auto line = fit_line(nearing(random, edge, 400.0), {.common_sigma_m = 0.002});
    if (!line) continue;
    const Vector4d shifts = shifts_to(edge, *line);
    normalised += shifts.dot(line->covariance_m2.ldlt().solve(shifts)) / 4.0;
    worst_m = std::max(worst_m, shifts.cwiseAbs().maxCoeff());
    ++fitted;
  }
  EXPECT_GT(fitted, 50);
  EXPECT_GT(normalised / fitted, 0.3);
  EXPECT_LT(normalised / fitted, 2.0);
  EXPECT_LT(worst_m, 0.06);  // the images from near by decide: the first ones are off by 0.12 m a pixel
}

TEST(FitLine, GivesALineInPlueckersSenseThatHoldsItsEnds) {
  Random random(71);
  const auto line = fit_line(sightings_of({}, random, {}), {});
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->axis.direction.norm(), 1.0, 1e-12);
  EXPECT_NEAR(line->axis.direction.dot(line->axis.moment), 0.0, 1e-12);
  EXPECT_LT(line->axis.distance_m(line->centroid), 1e-9);
  EXPECT_NEAR(line->u.cross(line->v).dot(line->axis.direction), 1.0, 1e-12);
  EXPECT_NEAR(2.0 * line->half_length_m, (Edge{}.b_W - Edge{}.a_W).norm(), 0.2);
}

TEST(FitLine, SurvivesAThirdOfFalsePoints) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(100 + seed);
    const auto line = fit_line(sightings_of({}, random, {.false_share = 0.3}), {});
    ASSERT_TRUE(line) << seed;
    EXPECT_LT(shifts_to({}, *line).cwiseAbs().maxCoeff(), 0.04) << seed;
  }
}

TEST(FitLine, KnowsNoMoreFromManyPointsOfOneSightingThanThatSightingsOwnError) {
  Random random(72);
  const auto line = fit_line(sightings_of({}, random, {}, 1, 2000), {});
  ASSERT_TRUE(line);
  EXPECT_GT(line->covariance_m2.diagonal().minCoeff(), 0.0099 * 0.0099);
}

TEST(FitLine, RefusesWhatIsNoLine) {
  Random random(73);
  EXPECT_FALSE(fit_line({}, {}));
  EXPECT_FALSE(fit_line(sightings_of({}, random, {}, 3, 4), {}));  // too few points
  const Edge dot{.a_W = Vector3d(5.0, 1.0, 0.0), .b_W = Vector3d(5.0, 1.0, 0.2)};
  EXPECT_FALSE(fit_line(sightings_of(dot, random, {}), {}));                   // too short
  EXPECT_FALSE(fit_line(sightings_of({}, random, {.ray_m = 0.15}), {}));       // too rough
  EXPECT_FALSE(fit_line(sightings_of({}, random, {.false_share = 0.9}), {}));  // points anywhere
  LineSighting arc{.T_W_C = SE3::Identity(), .points = {}};
  for (int i = 0; i < 60; ++i)
    arc.points.push_back(
        {.p_C = Vector3d(std::cos(0.03 * i), std::sin(0.03 * i), 4.0), .sigma_ray_m = 0.02, .sigma_across_m = 0.01});
  EXPECT_FALSE(fit_line(std::vector{arc}, {}));
}

TEST(WithEnds, TellsOfOtherEndsWhatTheOldOnesImply) {
  Random random(74);
  const auto line = fit_line(sightings_of({}, random, {}), {});
  ASSERT_TRUE(line);
  const LineLandmark same = with_ends(*line, -line->half_length_m, line->half_length_m);
  EXPECT_LT((same.covariance_m2 - line->covariance_m2).norm(), 1e-12);
  const LineLandmark longer = with_ends(*line, -3.0 * line->half_length_m, line->half_length_m);
  EXPECT_NEAR(longer.half_length_m, 2.0 * line->half_length_m, 1e-12);
  EXPECT_LT(line->axis.distance_m(longer.centroid), 1e-9);
  EXPECT_GT(longer.covariance_m2(0, 0), 3.0 * line->covariance_m2(0, 0));  // a lever
  EXPECT_NEAR(longer.covariance_m2(2, 2), line->covariance_m2(2, 2), 1e-12);
  const LineLandmark back = with_ends(longer, 0.0, 2.0 * line->half_length_m);
  EXPECT_LT((back.covariance_m2 - line->covariance_m2).norm(), 1e-12);
  EXPECT_LT((back.centroid - line->centroid).norm(), 1e-9);
}

}  // namespace
}  // namespace pllit
