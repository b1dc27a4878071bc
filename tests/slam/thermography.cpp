// The thermographic stage in a plain world of boxes that heat up, come and go, with a gain control that drifts.
#include "pllit/slam/thermography.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <format>
#include <functional>
#include <string>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// An axis-aligned box whose grey and place depend on the time.
struct Box {
  Vector3d centre_W, size_m;
  std::function<double(double t_s)> grey;
  std::function<bool(double t_s)> there = [](double) { return true; };
  std::function<Vector3d(double t_s)> moved = [](double) { return Vector3d(Vector3d::Zero()); };

  /// Distance along a ray, infinite where it passes by.
  double hit(const Vector3d& from_W, const Vector3d& ray_W, double t_s) const {
    const Eigen::Array3d middle = (centre_W + moved(t_s) - from_W).array(), half = 0.5 * size_m.array();
    const Eigen::Array3d a = (middle - half) / ray_W.array(), b = (middle + half) / ray_W.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter < leave && enter > 0.0 ? enter : std::numeric_limits<double>::infinity();
  }
};

std::function<double(double)> steady(double grey) {
  return [grey](double) { return grey; };
}

struct World {
  std::vector<Box> boxes;

  struct Hit {
    double range_m = std::numeric_limits<double>::infinity(), grey = 0.0;
  };
  Hit hit(const Vector3d& from_W, const Vector3d& ray_W, double t_s) const {
    Hit best;
    for (const Box& box : boxes) {
      if (!box.there(t_s)) continue;
      const double range_m = box.hit(from_W, ray_W, t_s);
      if (range_m < best.range_m) best = {range_m, box.grey(t_s)};
    }
    return best;
  }
};

/// Walls of different greys around a table.
World room() {
  World world;
  world.boxes = {
      {{0.0, 0.0, -0.05}, {20.0, 20.0, 0.1}, steady(70.0)}, {{0.0, 0.0, 3.05}, {20.0, 20.0, 0.1}, steady(110.0)},
      {{5.0, 0.0, 1.5}, {0.2, 20.0, 3.0}, steady(95.0)},    {{4.7, 2.0, 1.5}, {0.4, 1.0, 3.0}, steady(60.0)},
      {{4.7, -2.2, 1.0}, {0.4, 0.6, 0.8}, steady(125.0)},   {{3.2, 0.0, 0.35}, {0.8, 1.2, 0.7}, steady(85.0)}};
  return world;
}

const Vector3d kOnTable(3.1, 0.1, 0.85);

Box on_table(double grey) { return {kOnTable, {0.25, 0.25, 0.3}, steady(grey)}; }

Camera camera() { return {.width = 160, .height = 128, .fx = 150.0, .fy = 150.0, .cx = 80.0, .cy = 64.0}; }

/// For a camera with a fifth of the usual pixels an angle.
ThermographyConfig config() {
  ThermographyConfig config;
  config.sampling.border_px = 4;
  config.sampling.shadow_px = 4;
  config.sampling.aim_px = 1;
  return config;
}

/// The camera looks along x, steps from side to side and turns a little.
SE3 pose_at(double t_s) {
  Matrix3d R_W_C;
  R_W_C << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  const SO3 turn = exp_so3({0.0, 0.1 * std::sin(0.7 * t_s), 0.25 * std::sin(0.4 * t_s)});
  return pose_from(turn * rotation_from(Eigen::Quaterniond(R_W_C)), {0.0, 0.8 * std::sin(0.5 * t_s), 1.4});
}

struct Watched {
  World world;
  ThermographyConfig settings = config();
  double drift_grey = 12.0;  ///< of the gain control
  bool counts = false;  ///< 16-bit counts, 30 a kelvin, that drift; a grey of the world is then a fifth of a kelvin
  double aim_off_px = 0.0, aim_sigma_px = 0.0;  ///< how far off the camera's aim is, and is said to be
  Thermography stage{camera(), settings};
  Random random{1};
  double t_s = 0.0;
  int images = 0;
  std::optional<double> alarm_s{};

  Time time() const { return Time(from_seconds(1e6 + t_s)); }

  ThermographyFrame image(bool trusted = true, bool frozen = false) {
    const SE3 T_W_C = pose_at(t_s);
    const Matrix3d R_W_C = T_W_C.rotation();
    const SE3 aim_off = pose_from(exp_so3({0.0, aim_off_px / camera().fx, 0.0}), Vector3d::Zero());
    ThermographyInput input{.time = time(), .T_W_C = T_W_C * aim_off, .trusted = trusted, .aim_sigma_px = aim_sigma_px};
    for (int i = 0; i < 3000; ++i) {
      const Vector3d ray_W = R_W_C * Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), 1.0).normalized();
      const double range_m = world.hit(T_W_C.translation(), ray_W, t_s).range_m;
      if (std::isfinite(range_m))
        input.points_W.push_back((T_W_C.translation() + (range_m + random.normal(0.01)) * ray_W).cast<float>());
    }
    if (!frozen) raw = counts ? counted(T_W_C, R_W_C) : rendered(T_W_C, R_W_C);
    input.raw = raw.clone();
    const ThermographyFrame frame = stage.process(input);
    if (!frame.confirmed.empty() && !alarm_s) alarm_s = t_s;
    t_s += 0.1;
    ++images;
    return frame;
  }
  void until(double end_s, bool trusted = true) {
    while (t_s < end_s) image(trusted);
  }
  /// What was raised, for messages.
  std::string told() const {
    std::string text;
    for (const Anomaly& a : alarms())
      text += std::format("{} {} at {:.2f} {:.2f} {:.2f}, {} voxels, change {:.0f}, after {:.1f} s\n", name_of(a.kind),
                          name_of(a.state), a.position_W.x(), a.position_W.y(), a.position_W.z(), a.voxels,
                          a.mean_change, to_seconds(*a.confirmed - Time(from_seconds(1e6))));
    return text;
  }
  std::vector<Anomaly> alarms() const {
    auto anomalies = stage.anomalies();
    std::erase_if(anomalies, [](const Anomaly& anomaly) { return !anomaly.confirmed; });
    return anomalies;
  }

  cv::Mat raw{};

 private:
  cv::Mat rendered(const SE3& T_W_C, const Matrix3d& R_W_C) {
    const double gain = 1.0 + 0.2 * std::sin(0.3 * t_s), bias = drift_grey * std::sin(0.17 * t_s);
    cv::Mat image(camera().height, camera().width, CV_8UC1);
    for (int row = 0; row < image.rows; ++row)
      for (int column = 0; column < image.cols; ++column) {
        const auto hit = world.hit(T_W_C.translation(), R_W_C * camera().ray({column, row}), t_s);
        const double grey = gain * (hit.grey + random.normal(1.5)) + bias;
        image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
      }
    return image;
  }
  cv::Mat counted(const SE3& T_W_C, const Matrix3d& R_W_C) {
    const double gain = 1.0 + 0.002 * std::sin(0.3 * t_s), bias = 60.0 * std::sin(0.17 * t_s);
    cv::Mat image(camera().height, camera().width, CV_16UC1);
    for (int row = 0; row < image.rows; ++row)
      for (int column = 0; column < image.cols; ++column) {
        const auto hit = world.hit(T_W_C.translation(), R_W_C * camera().ray({column, row}), t_s);
        const double count = gain * (6500.0 + 6.0 * hit.grey + random.normal(2.0)) + bias;
        image.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(count + 0.5);
      }
    return image;
  }
};

ThermographyConfig counting() {
  ThermographyConfig settings = open_thresholds();
  settings.sampling = config().sampling;
  return settings;
}

TEST(Thermography, RaisesNoAlarmWhereNothingHappensButGainControl) {
  Watched watched{.world = room()};
  watched.until(30.0);
  EXPECT_TRUE(watched.stage.anomalies().empty());
  EXPECT_GT(watched.stage.map().size(), 3000u);
}

TEST(Thermography, FindsAKnownSurfaceThatHeatsUp) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back(on_table(90.0));
  watched.world.boxes.back().grey = [](double t_s) {
    return t_s < 15.0 ? 90.0 : 90.0 + 50.0 * (1.0 - std::exp(15.0 - t_s));
  };
  watched.until(25.0);
  ASSERT_EQ(watched.alarms().size(), 1u);
  const Anomaly alarm = watched.alarms()[0];
  EXPECT_EQ(alarm.kind, AnomalyKind::heated);
  EXPECT_EQ(alarm.state, AnomalyState::confirmed);
  EXPECT_LT((alarm.position_W - kOnTable).norm(), 0.15);  // of the sides that show
  EXPECT_NEAR(alarm.mean_change, 50.0, 12.0);
  EXPECT_GT(*watched.alarm_s, 15.0);
  EXPECT_LT(*watched.alarm_s, 18.5);
  EXPECT_LT(alarm.extent_m.maxCoeff(), 0.5);
  ASSERT_TRUE(alarm.crop);
  EXPECT_GT(alarm.crop->width, 20);
  // However long it goes on, it does not become normal.
  watched.until(60.0);
  ASSERT_EQ(watched.alarms().size(), 1u);
  EXPECT_EQ(watched.alarms()[0].state, AnomalyState::confirmed);
  EXPECT_FALSE(watched.stage.anomaly_points().points.empty());
}

TEST(Thermography, FindsInCountsWhatWarmsUpByFewKelvinWithinItsFirstLook) {
  Watched watched{.world = room(), .settings = counting(), .counts = true};
  watched.world.boxes.push_back(on_table(90.0));
  watched.world.boxes.back().there = [](double t_s) { return t_s > 5.0; };  // cool, so that it is no finding
  watched.world.boxes.back().grey = [](double t_s) {
    return t_s < 6.0 ? 90.0 : 90.0 + 60.0 * (1.0 - std::exp((6.0 - t_s) / 10.0));
  };
  watched.until(14.0);
  ASSERT_EQ(watched.alarms().size(), 1u) << watched.told();
  const Anomaly alarm = watched.alarms()[0];
  EXPECT_LT(*watched.alarm_s, 12.0) << "3 K are reached after 2.9 s, and must last, from two viewpoints";
  EXPECT_LT((alarm.position_W - kOnTable).norm(), 0.15);
  EXPECT_GT(alarm.extent_m.maxCoeff(), 0.2) << "the whole of it";
  EXPECT_LT(alarm.extent_m.maxCoeff(), 0.5) << "and no more";
}

TEST(Thermography, TakesTheUnitFromTheFirstImageAndNoOthersAfterIt) {
  Watched watched{.world = room(), .settings = counting(), .counts = true};
  watched.image();
  EXPECT_EQ(watched.stage.config().unit, IntensityUnit::count);
  EXPECT_EQ(watched.stage.config().map.model.min_change, 90.0);
  watched.counts = false;
  EXPECT_EQ(watched.image().use, ThermographyFrame::Use::other_depth);
  Watched video{.world = room(), .settings = counting()};
  video.image();
  EXPECT_EQ(video.stage.config().unit, IntensityUnit::grey);
}

TEST(Thermography, RaisesNoAlarmInCountsThatDrift) {
  Watched watched{.world = room(), .settings = counting(), .counts = true};
  watched.world.boxes.push_back({{4.6, 0.8, 0.6}, {0.6, 0.8, 0.6}, steady(170.0)});
  watched.until(30.0);
  EXPECT_TRUE(watched.alarms().empty()) << watched.told();
}

TEST(Thermography, TakesNoEdgeForHeatAsLongAsItIsToldThatTheCameraMayLookAside) {
  const auto alarms = [](double aim_sigma_px) {
    Watched watched{.world = room(), .settings = counting(), .counts = true};
    watched.world.boxes.push_back({{4.6, 0.8, 0.6}, {0.6, 0.8, 0.6}, steady(170.0)});
    watched.aim_sigma_px = aim_sigma_px;
    watched.aim_off_px = 3.0;
    watched.until(6.0);
    watched.aim_off_px = -3.0;
    watched.until(14.0);
    return watched.alarms().size();
  };
  EXPECT_GT(alarms(0.0), 0u) << "or this test tells nothing";
  EXPECT_EQ(alarms(1.5), 0u);
}

TEST(Thermography, TellsWhenEachHotPointWasLastSeenSoThatLoopsCanMoveIt) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back(on_table(90.0));
  watched.world.boxes.back().grey = [](double t_s) { return t_s > 12.0 ? 150.0 : 90.0; };
  watched.until(18.0);
  const PointTable points = watched.stage.anomaly_points();
  ASSERT_FALSE(points.points.empty());
  const std::vector<float>* seen_s = find_field(points, "seen_s");
  ASSERT_TRUE(seen_s);
  ASSERT_EQ(seen_s->size(), points.points.size());
  for (const float s : *seen_s) {
    EXPECT_GT(s, 12.0F);
    EXPECT_LE(s, static_cast<float>(watched.t_s));
  }
}

TEST(Thermography, TakesPartsThatLieCloseTogetherForOneThing) {
  Watched watched{.world = room()};
  for (const double side : {-1.0, 1.0}) {
    watched.world.boxes.push_back(on_table(90.0));
    Box& half = watched.world.boxes.back();
    half.centre_W.y() += side * 0.17;
    half.size_m.y() = 0.2;
    half.grey = [](double t_s) { return t_s < 12.0 ? 90.0 : 150.0; };
  }
  watched.until(20.0);
  ASSERT_EQ(watched.alarms().size(), 1u) << watched.told();
  EXPECT_GT(watched.alarms()[0].extent_m.y(), 0.35);
}

TEST(Thermography, WaitsForMoreViewpointsWhereHeatIsOneVoxelThick) {
  // A strip of the wall: in front of it the camera, with four pixels a decimetre, would not see it at all. It is two
  // pixels wide, so that these must be where they are said to be.
  const auto alarm_after_s = [](double width_m) {
    ThermographyConfig settings = config();
    settings.sampling.aim_px = 0;
    Watched watched{.world = room(), .settings = settings};
    watched.world.boxes.push_back(
        {{4.89, 0.125, 1.4}, {0.02, width_m, 0.8}, [](double t_s) { return t_s < 15.0 ? 95.0 : 215.0; }});
    watched.until(32.0);
    return watched.alarm_s ? *watched.alarm_s - 15.0 : std::numeric_limits<double>::infinity();
  };
  const double wide_s = alarm_after_s(0.3), thin_s = alarm_after_s(0.05);
  EXPECT_LT(wide_s, 3.0);
  EXPECT_GT(thin_s, wide_s);
  EXPECT_LT(thin_s, 15.0);
}

TEST(Thermography, FindsAHotThingThatWasBroughtIn) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back(on_table(150.0));
  watched.world.boxes.back().there = [](double t_s) { return t_s >= 15.0; };
  watched.until(25.0);
  ASSERT_EQ(watched.alarms().size(), 1u);
  const Anomaly alarm = watched.alarms()[0];
  EXPECT_EQ(alarm.kind, AnomalyKind::new_hot);
  EXPECT_LT((alarm.position_W - kOnTable).norm(), 0.15);
  EXPECT_LT(*watched.alarm_s, 18.0);
}

TEST(Thermography, SeesWhatStandsOnATableThatItSeesAtAGrazingAngle) {
  PlaneMap planes({});
  PointCloud top;
  std::vector<Vector3f> thing_W;
  for (int x = 0; x < 40; ++x)
    for (int y = -20; y < 20; ++y) {
      top.points_I.emplace_back(2.0F + 0.05F * static_cast<float>(x), 0.05F * static_cast<float>(y), 1.2F);
      if (x == 20 && std::abs(y) < 3) thing_W.push_back(top.points_I.back() + Vector3f(0.0F, 0.0F, 0.15F));
    }
  planes.insert(top, SE3::Identity());
  const auto seen_of = [&](const std::vector<Vector3f>& points_W) {
    Thermography stage(camera(), config());
    return stage
        .process({.time = Time(from_seconds(1e6)),
                  .T_W_C = pose_at(0.0),
                  .raw = cv::Mat(camera().height, camera().width, CV_8UC1, cv::Scalar(100)),
                  .points_W = points_W,
                  .planes = &planes})
        .observations;
  };
  EXPECT_EQ(seen_of(top.points_I), 0);
  EXPECT_EQ(seen_of(thing_W), static_cast<int>(thing_W.size()));
}

TEST(Thermography, LeavesAloneWhatIsBroughtInCold) {
  for (const double grey : {40.0, 85.0}) {
    Watched watched{.world = room()};
    watched.world.boxes.push_back(on_table(grey));
    watched.world.boxes.back().there = [](double t_s) { return t_s >= 15.0; };
    watched.until(25.0);
    EXPECT_TRUE(watched.alarms().empty()) << grey << ": " << watched.told();
  }
}

TEST(Thermography, LeavesAloneARadiatorThatWasHotAllAlong) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back({{4.6, 0.8, 0.6}, {0.6, 0.8, 0.6}, steady(170.0)});
  watched.until(30.0);
  EXPECT_TRUE(watched.alarms().empty()) << watched.told();
}

TEST(Thermography, LeavesAloneARadiatorThatComesIntoSightLate) {
  Watched watched{.world = room()};
  // A screen hides it at first.
  watched.world.boxes.push_back({{4.6, 0.8, 0.6}, {0.6, 0.8, 0.6}, steady(170.0)});
  watched.world.boxes.push_back({{2.2, 0.5, 1.5}, {0.1, 1.6, 3.0}, steady(88.0)});
  watched.world.boxes.back().there = [](double t_s) { return t_s < 15.0; };
  watched.until(30.0);
  EXPECT_TRUE(watched.alarms().empty()) << watched.told();
}

TEST(Thermography, LeavesAlonePeopleWhoWalkBy) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back({{2.5, 0.0, 0.9}, {0.3, 0.5, 1.8}, steady(160.0)});
  watched.world.boxes.back().moved = [](double t_s) {
    return Vector3d(0.0, 3.0 - std::abs(std::fmod(0.9 * t_s, 12.0) - 6.0), 0.0);
  };
  watched.until(40.0);
  EXPECT_TRUE(watched.alarms().empty()) << watched.told();
}

TEST(Thermography, SaysWhenHeatGoesAndWhenTheThingItselfDoes) {
  for (const bool taken_away : {false, true}) {
    Watched watched{.world = room()};
    watched.world.boxes.push_back(on_table(90.0));
    watched.world.boxes.back().grey = [&](double t_s) {
      return t_s > 12.0 && (taken_away || t_s < 20.0) ? 150.0 : 90.0;
    };
    watched.world.boxes.back().there = [&](double t_s) { return !taken_away || t_s < 20.0; };
    watched.until(18.0);
    ASSERT_EQ(watched.alarms().size(), 1u);
    EXPECT_EQ(watched.alarms()[0].state, AnomalyState::confirmed);
    watched.until(28.0);
    ASSERT_EQ(watched.alarms().size(), 1u);
    EXPECT_EQ(watched.alarms()[0].state, AnomalyState::gone) << taken_away << ": " << watched.told();
  }
}

TEST(Thermography, KeepsStillWhileLocalisationIsDegraded) {
  Watched watched{.world = room()};
  watched.world.boxes.push_back(on_table(90.0));
  watched.world.boxes.back().grey = [](double t_s) { return t_s > 12.0 ? 150.0 : 90.0; };
  watched.until(12.0);
  watched.until(16.0, false);
  EXPECT_TRUE(watched.stage.anomalies().empty());
  watched.until(18.0);
  EXPECT_EQ(watched.alarms().size(), 1u);
}

TEST(Thermography, TakesFrozenVideoForAClosedShutter) {
  using Use = ThermographyFrame::Use;
  Watched watched{.world = room()};
  watched.until(3.0);
  EXPECT_EQ(watched.image().use, Use::mapped);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(watched.image(true, true).use, Use::frozen);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(watched.image().use, Use::frozen);  // just opened
  watched.image();
  EXPECT_EQ(watched.image().use, Use::mapped);
}

TEST(Thermography, KeepsTemperaturesOfSurfacesWhereTheirEmissivityIsKnown) {
  ThermographyConfig settings = config();
  settings.unit_choice = UnitChoice::kelvin;
  settings.radiometry = {.emissivity = 0.6, .reflected_K = 290.0, .air_K = 285.0, .absorbed_per_m = 0.01};
  Thermography stage(camera(), settings);
  ThermographyInput input{.time = {}, .T_W_C = pose_at(0.0)};
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k < 40; ++k)
      input.points_W.emplace_back(4.0F, -1.5F + 0.05F * static_cast<float>(i), 0.5F + 0.05F * static_cast<float>(k));
  for (int image = 0; image < 20; ++image) {
    input.time = Time(from_seconds(1e6 + 0.1 * image));
    input.raw = cv::Mat(camera().height, camera().width, CV_16UC1, cv::Scalar(31'000 + image % 2));  // no frozen video
    stage.process(input);
  }
  const PointTable table = stage.map().table();
  ASSERT_GT(table.points.size(), 100u);
  const RadiometricEquation equation(settings.radiometry);
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    const double range_m = (table.points[i].cast<double>() - input.T_W_C.translation()).norm();
    EXPECT_NEAR((*find_field(table, "normal"))[i], equation.object_K(310.0, range_m), 0.1);
    EXPECT_NEAR((*find_field(table, "raw"))[i], 31'000.0, 1.0) << "what the camera gave stays";
  }
}

}  // namespace
}  // namespace pllit
