#include "pllit/map/anomalies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "support/box_before_wall.hpp"

namespace pllit {
namespace {

bool is_alarm(const AnomalyDetector& detector) {
  return std::ranges::any_of(detector.anomalies(),
                             [](const Anomaly& anomaly) { return anomaly.confirmed.has_value(); });
}

/// Whether an alarm is raised for 3 x 3 voxels of a wall that show 100, and from the sixth second on 160, while a
/// camera walks by; within a few pixels of them the image shows less all the time, by as much as `dip_of(y, z)` says.
/// The rest of the wall shows `around`, if anything.
template <class Dip>
bool is_alarm_where_less_is_beside(const Dip& dip_of, std::optional<float> around = std::nullopt,
                                   const AnomalyConfig& config = {}) {
  ThermalMap map({});
  const SightLog past({});
  AnomalyDetector detector(config);
  for (int image = 0; image < 90; ++image) {
    const Time time{std::chrono::milliseconds(100 * image)};
    ThermalView view{.time = time, .viewpoint_W = Vector3d(0.0, 0.1 * image, 0.0)};
    const auto show = [&](int y, int z, float grey, float dip) {
      view.observations.push_back({.p_W = Vector3d(3.0, 0.125 + 0.05 * y, 0.125 + 0.05 * z),
                                   .pixel_px = {0.0F, 0.0F},
                                   .intensity = grey,
                                   .dip = dip,
                                   .raw = grey});
    };
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) show(y, z, image < 60 ? 100.0F : 160.0F, image < 60 ? 0.0F : dip_of(y, z));
    for (int y = 5; around && y < 25; ++y)
      for (int z = -10; z < 10; ++z) show(y, z, *around, 0.0F);
    const auto seen = map.integrate(view);
    const Sight sight = sight_of(time, view.viewpoint_W, {}, past.config());
    detector.update({.map = map, .seen = seen, .sight = sight, .past = past}, view);
  }
  return is_alarm(detector);
}

TEST(Anomalies, AreWhatHasHeatedUp) {
  EXPECT_TRUE(is_alarm_where_less_is_beside([](int, int) { return 0.0F; }));
}

TEST(Anomalies, AreNotWhatMayAllBeAnEdgeThatIsSeenAFewPixelsOff) {
  const auto but_for_the_first = [](int sure) {
    return [sure](int y, int z) { return 3 * (y + 1) + z + 1 < sure ? 0.0F : 50.0F; };
  };
  EXPECT_FALSE(is_alarm_where_less_is_beside(but_for_the_first(0)));
  EXPECT_FALSE(is_alarm_where_less_is_beside(but_for_the_first(2))) << "two voxels of nine are not enough";
  EXPECT_TRUE(is_alarm_where_less_is_beside(but_for_the_first(3)));
}

/// Whether an alarm is raised for an upright strip, so many voxels wide, that shows 100, and `grey_of(image, y)` in its
/// y-th voxel from the sixth second on.
template <class Grey>
bool is_alarm_for_strip(const Grey& grey_of, int wide = 1) {
  ThermalMap map({});
  const SightLog past({});
  AnomalyDetector detector({});
  for (int image = 0; image < 120; ++image) {
    const Time time{std::chrono::milliseconds(100 * image)};
    ThermalView view{.time = time, .viewpoint_W = Vector3d(0.0, 0.1 * image, 0.0)};
    for (int y = 0; y < wide; ++y) {
      const float grey = image < 60 ? 100.0F : grey_of(image, y);
      for (int z = 0; z < 5; ++z)
        view.observations.push_back({.p_W = Vector3d(3.0, 0.125 + 0.05 * y, 0.125 + 0.05 * z),
                                     .pixel_px = {0.0F, 0.0F},
                                     .intensity = grey,
                                     .raw = grey});
    }
    const auto seen = map.integrate(view);
    const Sight sight = sight_of(time, view.viewpoint_W, {}, past.config());
    detector.update({.map = map, .seen = seen, .sight = sight, .past = past}, view);
  }
  return is_alarm(detector);
}

TEST(Anomalies, AreNotTheRimOfAThingBehindWhichSomethingHotPasses) {
  EXPECT_TRUE(is_alarm_for_strip([](int, int) { return 160.0F; })) << "a strip may be hot";
  EXPECT_FALSE(is_alarm_for_strip([](int image, int) { return image < 64 ? 600.0F : 140.0F; }));
}

TEST(Anomalies, MustLastWhereTheyAreUnevenlyHot) {
  const auto one_much_hotter_until = [](int end) {
    return [end](int image, int y) { return image >= end ? 100.0F : y == 0 ? 900.0F : 200.0F; };
  };
  EXPECT_FALSE(is_alarm_for_strip(one_much_hotter_until(75), 5)) << "a round thing's rim, as it is passed";
  EXPECT_TRUE(is_alarm_for_strip(one_much_hotter_until(120), 5)) << "a bearing on a warm motor";
  EXPECT_TRUE(is_alarm_for_strip([](int image, int) { return image < 75 ? 300.0F : 100.0F; }, 5)) << "even, as short";
}

TEST(Anomalies, InVideoAreOnlyWhatOutshinesWhatIsNormallyBrighter) {
  const auto none = [](int, int) { return 0.0F; };
  AnomalyConfig video;
  video.min_outshone = 0.7;
  EXPECT_TRUE(is_alarm_where_less_is_beside(none, 130.0F, video));
  EXPECT_FALSE(is_alarm_where_less_is_beside(none, 200.0F, video)) << "it is still darker";
  EXPECT_FALSE(is_alarm_where_less_is_beside(none, 90.0F, video)) << "nothing was brighter: the order is as before";
  EXPECT_TRUE(is_alarm_where_less_is_beside(none, 200.0F)) << "other units know how much a change is";
}

/// A hot box stands before a wall after 20 s, of which a camera that has learned the wall sees some columns at times.
class BoxThatCame {
 public:
  explicit BoxThatCame(const AnomalyConfig& config = {}) : detector_(config) {
    for (int i = 0; i < 60; ++i)
      past_.add(sight_of(at(i), {0.0, 0.002 * (i % 7), 0.0}, points(i >= 20), past_.config()));
    for (int image = 0; image < 20; ++image) see(0.1 * image, 0.05 * image, 0);
  }

  void see(double seconds, double viewpoint_m, int columns, int first = 0) {
    ThermalView view{.time = at(seconds), .viewpoint_W = Vector3d(0.0, viewpoint_m, 0.0)};
    const auto show = [&](double x, double y, double z, float grey) {
      view.observations.push_back({.p_W = Vector3d(x, y, z), .pixel_px = {0.0F, 0.0F}, .intensity = grey, .raw = grey});
    };
    for (double z = -0.35; z <= 0.351; z += 0.05) {
      for (double y = 1.0; y <= 1.501; y += 0.05) show(4.0, y, z, 80.0F);
      for (int column = first; column < first + columns; ++column) show(2.0, 0.05 * column - 0.35, z, 200.0F);
    }
    const auto seen = map_.integrate(view);
    const Sight sight = sight_of(view.time, Vector3d::Zero(), points(seconds >= 20.0), past_.config());
    detector_.update({.map = map_, .seen = seen, .sight = sight, .past = past_}, view);
  }
  bool is_told() const { return is_alarm(detector_); }

  static constexpr int kColumns = 15;

 private:
  static Time at(double seconds) { return Time{} + from_seconds(seconds); }
  static std::vector<Vector3f> points(bool box) {
    return test::box_before_wall(box ? std::optional(0.4) : std::nullopt);
  }

  SightLog past_{{.spacing_m = 0.001}};
  ThermalMap map_{{}};
  AnomalyDetector detector_;
};

TEST(Anomalies, AreWhatWasOnlyGlimpsedWhenItCame) {
  BoxThatCame box;
  for (int image = 0; image < 4; ++image) box.see(21.0 + 0.1 * image, 0.0, box.kColumns);
  EXPECT_FALSE(box.is_told()) << "not yet: it was too short a look";
  for (int image = 0; image < 60; ++image) box.see(22.0 + 0.5 * image, 0.0, 0);
  for (int image = 0; image < 4; ++image) box.see(53.0 + 0.1 * image, 0.3, box.kColumns);
  EXPECT_TRUE(box.is_told());
}

TEST(Anomalies, AreNotWhoWalksOnHiddenFromWhereHeWas) {
  AnomalyConfig config;
  config.watch.surround_deg = 35.0;
  config.least_still = 0.75;  // he is 45 cm wide and slow
  BoxThatCame stands(config), walks(config);
  for (int image = 0; image < 10; ++image) {
    stands.see(21.0 + 0.1 * image, 0.1 * image, 9);
    walks.see(21.0 + 0.1 * image, 0.1 * image, 9, 3 * image / 2);
    EXPECT_FALSE(walks.is_told());
  }
  EXPECT_TRUE(stands.is_told());
}

TEST(Anomalies, AreWhatComesIntoSightLittleByLittleIfAllOfItIsFoundToHaveCome) {
  AnomalyConfig config;
  config.watch.whole_things = true;
  config.watch.part_voxels = 2;
  config.watch.surround_deg = 35.0;
  config.enough_seeds = 100;  // more than the columns that are seen first
  BoxThatCame box(config);
  for (int image = 0; image < 15; ++image) box.see(21.0 + 0.1 * image, 0.05 * image, std::min(image + 1, box.kColumns));
  EXPECT_TRUE(box.is_told());
}

}  // namespace
}  // namespace pllit
