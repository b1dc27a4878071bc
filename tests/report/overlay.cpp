#include "pllit/report/overlay.hpp"

#include <gtest/gtest.h>

#include "support/image_world.hpp"

namespace pllit {
namespace {

constexpr int caption_px = 26;

/// Where the picture is not grey.
cv::Point2d centre_of_colour(const cv::Mat& picture) {
  cv::Point2d sum;
  int count = 0;
  for (int y = caption_px; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const auto c = picture.at<cv::Vec3b>(y, x);
      if (c[0] == c[1] && c[1] == c[2]) continue;
      sum += cv::Point2d(x, y - caption_px);
      ++count;
    }
  return count > 0 ? cv::Point2d(sum.x / count, sum.y / count) : cv::Point2d(-1.0, -1.0);
}

TEST(OverlaySheet, PutsADotWhereTheCameraSeesThePoint) {
  const Camera camera = test::thermal_camera();
  const Vector3d p_C(0.7, -0.4, 4.0);
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    const cv::Mat sheet = overlay_sheet(
        std::vector<OverlayImage>{{.counts = cv::Mat(camera.height, camera.width, type, cv::Scalar::all(90)),
                                   .points_C = {p_C.cast<float>()},
                                   .caption = "one"}},
        camera);
    ASSERT_EQ(sheet.size(), cv::Size(camera.width, camera.height + caption_px));
    const Eigen::Vector2d px = *camera.project(p_C);
    const cv::Point2d dot = centre_of_colour(sheet);
    EXPECT_NEAR(dot.x, px.x(), 0.6);
    EXPECT_NEAR(dot.y, px.y(), 0.6);
  }
}

TEST(OverlaySheet, LeavesOutWhatLiesBehindTheCameraOrBesideTheImage) {
  const Camera camera = test::thermal_camera();
  const std::vector<OverlayImage> images{{.counts = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(90)),
                                          .points_C = {{0.0F, 0.0F, -3.0F}, {30.0F, 0.0F, 3.0F}},
                                          .caption = "none"}};
  EXPECT_EQ(centre_of_colour(overlay_sheet(images, camera)).x, -1.0);
}

TEST(OverlaySheet, ShowsNearPointsRedAndFarOnesBlue) {
  const Camera camera = test::thermal_camera();
  std::vector<Eigen::Vector3f> points_C;
  for (int i = 0; i < 20; ++i) {
    points_C.emplace_back(-0.5F, 0.0F, 2.0F);
    points_C.emplace_back(5.0F, 0.0F, 20.0F);
  }
  const std::vector<OverlayImage> images{{.counts = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(90)),
                                          .points_C = points_C,
                                          .caption = "two"}};
  const cv::Mat sheet = overlay_sheet(images, camera);
  const auto colour = [&](const Eigen::Vector3f& p_C) {
    const Eigen::Vector2d px = *camera.project(p_C.cast<double>());
    return sheet.at<cv::Vec3b>(caption_px + static_cast<int>(std::lround(px.y())),
                               static_cast<int>(std::lround(px.x())));
  };
  EXPECT_GT(colour(points_C[0])[2], 2 * colour(points_C[0])[0]);
  EXPECT_GT(colour(points_C[1])[0], 2 * colour(points_C[1])[2]);
}

TEST(OverlaySheet, IsEmptyWithoutImages) { EXPECT_TRUE(overlay_sheet({}, test::thermal_camera()).empty()); }

}  // namespace
}  // namespace pllit
