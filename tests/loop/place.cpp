// What the same place looks like from elsewhere, and how submaps are laid on each other.
#include <gtest/gtest.h>

#include <array>
#include <format>
#include <map>
#include <random>

#include "pllit/loop/correction.hpp"
#include "pllit/loop/descriptor.hpp"
#include "pllit/loop/registration.hpp"
#include "support/street_drive.hpp"

namespace pllit {
namespace {

std::vector<Column> random_columns(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> where(-38.0F, 38.0F);
  std::uniform_int_distribution<int> height(3, 9);
  std::vector<Column> columns;
  for (int i = 0; i < count; ++i) columns.push_back({{where(random), where(random)}, height(random)});
  return columns;
}

std::vector<Column> moved(std::vector<Column> columns, double yaw_rad, const Eigen::Vector2f& shift_m) {
  for (Column& column : columns)
    column.centre_H = Eigen::Rotation2Df(static_cast<float>(yaw_rad)) * column.centre_H + shift_m;
  return columns;
}

TEST(Descriptor, GivesTheHeadingBetweenTwoViewsOfAPlace) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto columns = random_columns(seed, 400);
    const double yaw = std::remainder(0.7 * seed, 2.0 * M_PI);
    const HeadingMatch alignment = align(describe(moved(columns, yaw, {0.0F, 0.0F})), describe(columns));
    EXPECT_GT(alignment.score, 0.85);  // the sectors do not turn by whole numbers
    EXPECT_NEAR(std::remainder(alignment.yaw_rad - yaw, 2.0 * M_PI), 0.0, 0.02);
  }
}

TEST(Descriptor, ScoresDifferentPlacesLow) {
  double highest = 0.0;
  for (unsigned seed = 0; seed < 20; ++seed)
    highest =
        std::max(highest, align(describe(random_columns(seed, 400)), describe(random_columns(seed + 100, 400))).score);
  EXPECT_LT(highest, 0.4);
}

TEST(Descriptor, OfNothingIsLikeNothing) {
  EXPECT_EQ(align(describe({}), describe(random_columns(1, 100))).score, 0.0);
}

TEST(ColumnSearch, FindsTheShiftAndTurnBetweenTwoSetsOfColumns) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto b = random_columns(seed, 300);
    const Eigen::Vector2f shift(3.3F - 0.5F * static_cast<float>(seed), 2.1F);
    const auto a = moved(b, 0.1, shift);
    const ColumnMatch match = search(ColumnField(a), b, {.centre = {}, .reach_m = 5.0, .reach_rad = 0.15});
    EXPECT_NEAR(match.T_a_b.yaw_rad, 0.1, 0.012);
    EXPECT_LT((match.T_a_b.t_m - shift.cast<double>()).norm(), 0.4);
    EXPECT_GT(match.score, 0.7);
    EXPECT_LT(match.runner_up, 0.8 * match.score);
    EXPECT_GT(overlap(ColumnField(a), b, match.T_a_b, 20.0), 0.95);
  }
}

TEST(CompactCloud, KeepsPointsToHalfACentimetre) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> where(-100.0F, 100.0F);
  std::vector<Vector3f> points(1000);
  for (Vector3f& p : points) p = Vector3f(where(random), where(random), where(random));
  const CompactCloud cloud(points);
  const auto kept = cloud.points();
  ASSERT_EQ(kept.size(), points.size());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_LE((kept[i] - points[i]).cwiseAbs().maxCoeff(), 0.00501F);
  EXPECT_EQ(cloud.bytes(), 6000u);
}

TEST(Correction, MovesFramesBetweenKeyframesInProportion) {
  const auto at = [](int s) { return Time(std::chrono::seconds(s)); };
  const SE3 raised = pose_from(SO3::Identity(), Vector3d(0.0, 0.0, 2.0));
  const SE3 at_four = pose_from(SO3::Identity(), Vector3d(4.0, 0.0, 0.0));
  const Correction correction({{at(0), SE3::Identity(), SE3::Identity()}, {at(4), at_four, raised * at_four}});
  const Trajectory odometry{
      {at(0), SE3::Identity()}, {at(1), pose_from(SO3::Identity(), Vector3d(1.0, 0.0, 0.0))}, {at(6), at_four}};
  const Trajectory corrected = correction.corrected(odometry);
  EXPECT_LT(corrected[0].T_W_I.translation().norm(), 1e-12);
  EXPECT_LT((corrected[1].T_W_I.translation() - Vector3d(1.0, 0.0, 0.5)).norm(), 1e-12);
  EXPECT_LT((corrected[2].T_W_I.translation() - Vector3d(4.0, 0.0, 2.0)).norm(), 1e-12);
  EXPECT_LT((Correction({}).pose_M(at(1), at_four).translation() - at_four.translation()).norm(), 1e-12);
}

/// The drives are simulated once for all tests: by a LiDAR that looks all around and by one that sees 80 degrees.
struct Drive {
  const char* name;
  SimConfig::RigName rig;
};

class Street : public testing::TestWithParam<Drive> {
 protected:
  static const std::vector<LoopKeyframe>& drive() {
    static std::map<SimConfig::RigName, std::vector<LoopKeyframe>> driven;
    auto& keyframes = driven[GetParam().rig];
    if (keyframes.empty()) keyframes = test::up_and_back(GetParam().rig, 101);
    return keyframes;
  }
  /// The submap of a window around a place of the way, and the keyframe in its middle.
  static std::pair<Submap, std::size_t> around(double way_m) {
    const auto index = [](double way) {
      const auto at = std::ranges::lower_bound(drive(), way, {}, &LoopKeyframe::way_m);
      return std::min(drive().size() - 1, static_cast<std::size_t>(at - drive().begin()));
    };
    const std::size_t middle = index(way_m);
    return {make_submap(drive(), index(way_m - 12.0), index(way_m + 12.0), middle, 0.3, 60.0), middle};
  }
  static constexpr double turn_m = M_PI * 3.5;
  /// Way of the third leg's and of the returning lane's place beside a place of the first.
  static double again(double x_m) { return 120.0 + 2.0 * turn_m + x_m; }
  static double opposite(double x_m) { return 120.0 + turn_m - x_m; }
  static SE3 truth(std::size_t a, std::size_t b) {
    const auto level = [](const LoopKeyframe& k) { return pose_from(levelled(k.up_I), Vector3d::Zero()); };
    return level(drive()[a]) * drive()[a].T_O_I.inverse() * drive()[b].T_O_I * level(drive()[b]).inverse();
  }
  static Vector6 error(const SE3& truth, const SE3& found) {
    const SE3 T = truth.inverse() * found;
    Vector6 error;
    error << log_so3(T.asSO3()), T.translation();
    return error;
  }
};

TEST_P(Street, LooksMostLikeItself) {
  double least_same = 1.0, most_else = 0.0;
  for (const double x : {15.0, 25.0, 35.0, 45.0}) {
    const auto here = describe(around(x).first.columns);
    const HeadingMatch same = align(here, describe(around(again(x) + 1.0).first.columns));
    EXPECT_NEAR(same.yaw_rad, 0.0, 0.1);
    least_same = std::min(least_same, same.score);
    most_else =
        std::max(most_else, align(here, describe(around(again(x < 30.0 ? x + 25.0 : x - 25.0)).first.columns)).score);
  }
  RecordProperty("least_same", std::to_string(least_same));
  RecordProperty("most_elsewhere", std::to_string(most_else));
  EXPECT_GT(least_same, CandidateConfig{}.min_score);
  // A narrow view from another lane shows too little for more.
  if (GetParam().rig == SimConfig::RigName::hilti2022) {
    EXPECT_GT(least_same, most_else);
  }
}

/// What a registration must have to be looked at further.
bool believable(const Registration& found) { return refusal(found, {}).empty(); }

TEST_P(Street, RegistersFromMetresAndDegreesOff) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const bool opposite_way : {false, true})
    for (const double x : {20.0, 30.0, 40.0}) {
      const auto [a, i] = around(x);
      const auto [b, j] = around(opposite_way ? opposite(x) : again(x));
      const SE3 T_a_b = truth(i, j);
      const Matrix3d R = T_a_b.rotation();
      const PlanePose off{T_a_b.translation().head<2>() + 4.0 * Eigen::Vector2d(unit(random), unit(random)),
                          std::atan2(R(1, 0), R(0, 0)) + 0.1 * unit(random)};
      const Registration found = register_submaps(a, b, {.centre = off, .reach_m = 6.0, .reach_rad = 0.15}, {});
      SCOPED_TRACE(std::format("{} m, {}: overlap {}, information {}", x, opposite_way ? "back" : "again",
                               found.overlap, found.information));
      // From the other side a narrow view shows other things; then it is enough to know that it failed.
      if (!believable(found)) {
        EXPECT_TRUE(opposite_way);
        continue;
      }
      const Vector6 wrong = error(T_a_b, found.T_a_b);
      EXPECT_LT(wrong.tail<3>().norm(), 0.1);
      EXPECT_LT(wrong.head<3>().norm(), 0.005);
      EXPECT_LT((wrong.cwiseAbs().array() / found.covariance.diagonal().array().sqrt()).maxCoeff(), 3.5);
    }
}

TEST_P(Street, TellsThatTwoPlacesAreNotTheSame) {
  for (const double x : {15.0, 45.0}) {
    const Submap a = around(x).first, b = around(again(x < 30.0 ? x + 30.0 : x - 30.0)).first;
    const Registration found = register_submaps(a, b, {.centre = {}, .reach_m = 7.0, .reach_rad = 0.15}, {});
    EXPECT_FALSE(believable(found)) << std::format("{} m: overlap {}, rmse {} m, information {}", x, found.overlap,
                                                   found.rmse_m, found.information);
  }
}

INSTANTIATE_TEST_SUITE_P(, Street,
                         testing::Values(Drive{"AllAround", SimConfig::RigName::hilti2022},
                                         Drive{"Narrow", SimConfig::RigName::ntu4dradlm}),
                         [](const auto& row) { return row.param.name; });

TEST(Registration, CallsABareCorridorDegenerate) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> along(-15.0F, 15.0F), across(-1.0F, 1.0F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  Submap corridor;
  for (int i = 0; i < 20000; ++i) {
    const float x = along(random), u = across(random), n = noise(random);
    corridor.points_H.push_back(i % 3 == 0 ? Vector3f(x, 1.5F * u, -1.2F + n)
                                           : Vector3f(x, (i % 3 == 1 ? 1.5F : -1.5F) + n, 1.2F * u));
  }
  corridor.columns = columns_of(corridor.points_H);
  const Registration found = register_submaps(corridor, corridor, {.centre = {}, .reach_m = 2.0, .reach_rad = 0.1}, {});
  EXPECT_GT(found.overlap, 0.9);
  EXPECT_LT(found.information, RegistrationConfig{}.min_information);
}

/// Upright and lying pipes, 20 to 60 cm thick, in a room, as a scanner meets them; `seed` of where they are.
Submap pipe_room(int pipes, unsigned seed, unsigned points_seed) {
  std::mt19937 place(seed), random(points_seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  struct Pipe {
    Vector3f from = Vector3f::Zero();
    int axis = 2;
    float radius = 0.1F;
  };
  std::vector<Pipe> all;
  for (int i = 0; i < pipes; ++i)
    all.push_back({Vector3f(10.0F * unit(place) - 5.0F, 10.0F * unit(place) - 5.0F, 2.0F * unit(place) - 1.0F), i % 3,
                   0.1F + 0.2F * unit(place)});
  Submap submap;
  for (int i = 0; i < 20000; ++i) {
    const Pipe& pipe = all[static_cast<std::size_t>(i) % all.size()];
    const float angle = 6.2832F * unit(random);
    Vector3f p = pipe.from;
    p[pipe.axis] += 4.0F * unit(random) - 2.0F;
    p[(pipe.axis + 1) % 3] += pipe.radius * std::cos(angle);
    p[(pipe.axis + 2) % 3] += pipe.radius * std::sin(angle);
    submap.points_H.push_back(p);
  }
  std::array<float, 4> walls{};  // -x, x, -y, y
  for (float& at : walls) at = 5.0F + 4.0F * unit(place);
  for (std::size_t i = 0; i < 8000; ++i) {
    const std::size_t along = 2 - i % 4 / 2 * 2;  // the first wall of the other pair
    const float u = (walls[along] + walls[along + 1]) * unit(random) - walls[along],
                height = 4.0F * unit(random) - 2.0F;
    const float at = i % 2 == 0 ? -walls[i % 4] : walls[i % 4];
    submap.points_H.push_back(i % 4 < 2 ? Vector3f(at, u, height) : Vector3f(u, at, height));
    submap.points_H.push_back({u, 10.0F * unit(random) - 5.0F, -2.0F});
  }
  submap.points_H = thinned(submap.points_H, 0.1);
  submap.columns = columns_of(submap.points_H);
  return submap;
}

TEST(Registration, AllowsForPipesButNotForAThicketOfThem) {
  const SearchWindow window{.centre = {}, .reach_m = 2.0, .reach_rad = 0.1};
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Submap place = pipe_room(20, seed, 10);
    const Registration again = register_submaps(place, pipe_room(20, seed, 11), window, {});
    EXPECT_GT(again.rmse_m, RegistrationConfig{}.max_rmse_m);  // or this says nothing
    EXPECT_EQ(refusal(again, {}), "");
    EXPECT_LT(again.T_a_b.translation().norm(), 0.05);
    EXPECT_NE(refusal(register_submaps(place, pipe_room(20, seed + 10, 10), window, {}), {}), "");
    // A metre off such points lie no worse.
    EXPECT_NE(refusal(register_submaps(pipe_room(120, seed, 10), pipe_room(120, seed, 11), window, {}), {}), "");
  }
}

}  // namespace
}  // namespace pllit
