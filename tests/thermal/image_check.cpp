#include "pllit/thermal/image_check.hpp"

#include <gtest/gtest.h>

#include "thermal/pictures.hpp"

namespace pllit {
namespace {

using Kind = ImageVerdict::Kind;

CameraFrame frame(cv::Mat counts, double seconds) {
  return {.time = Time(from_seconds(seconds)), .counts = std::move(counts)};
}

/// What a stream of images is judged to be.
std::vector<ImageVerdict> judged(const std::vector<CameraFrame>& stream) {
  ImageHistory history;
  std::vector<ImageVerdict> verdicts;
  for (const CameraFrame& one : stream) {
    verdicts.push_back(judge(one, history, {}));
    history = remembered(one, verdicts.back(), history);
  }
  return verdicts;
}

TEST(ImageCheck, PassesLiveImagesOfAStandingRig) {
  const cv::Mat greys = test::scene({}, 1);
  std::vector<CameraFrame> stream;
  for (unsigned i = 0; i < 5; ++i) stream.push_back(frame(test::seen(greys, 0.3, i), 0.1 * i));
  for (const ImageVerdict& verdict : judged(stream)) {
    EXPECT_TRUE(verdict.usable()) << verdict.reason;
    EXPECT_FALSE(verdict.after_shutter);
  }
}

TEST(ImageCheck, NoticesAFrozenVideoAndTheImageAfterTheShutter) {
  std::vector<CameraFrame> stream;
  for (unsigned i = 0; i < 3; ++i) stream.push_back(frame(test::picture({}, i), 0.1 * i));
  for (unsigned i = 3; i < 7; ++i) stream.push_back(frame(stream[2].counts.clone(), 0.1 * i));
  stream.push_back(frame(test::picture({}, 9), 0.7));
  stream.push_back(frame(test::picture({}, 10), 0.8));
  const auto verdicts = judged(stream);
  for (std::size_t i = 3; i < 7; ++i) EXPECT_EQ(verdicts[i].kind, Kind::repeated);
  EXPECT_NE(verdicts[3].reason.find("repeats"), std::string::npos);
  EXPECT_TRUE(verdicts[7].usable());
  EXPECT_TRUE(verdicts[7].after_shutter);
  EXPECT_FALSE(verdicts[8].after_shutter);
}

TEST(ImageCheck, TakesOneDoubledImageForADoubledImage) {
  const cv::Mat a = test::picture({}, 1), b = test::picture({}, 2);
  const auto verdicts = judged({frame(a, 0.0), frame(a, 0.1), frame(b, 0.15)});
  EXPECT_EQ(verdicts[1].kind, Kind::repeated);
  EXPECT_TRUE(verdicts[2].usable());
  EXPECT_FALSE(verdicts[2].after_shutter);
}

TEST(ImageCheck, SaysWhyAnImageShowsNothing) {
  const auto kind_of = [](const cv::Mat& image) { return judge(frame(image, 0.0), {}, {}).kind; };
  cv::Mat half = test::picture({}, 3);
  half.rowRange(0, 140) = 255;
  EXPECT_EQ(kind_of(half), Kind::saturated);
  EXPECT_EQ(kind_of(cv::Mat(100, 100, CV_8UC1, cv::Scalar(120))), Kind::blank);
  EXPECT_EQ(kind_of(cv::Mat(100, 100, CV_8UC1, cv::Scalar(2))), Kind::dark);
  EXPECT_EQ(kind_of(cv::Mat(100, 100, CV_8UC1, cv::Scalar(253))), Kind::bright);
  EXPECT_EQ(kind_of(cv::Mat(100, 100, CV_16UC1, cv::Scalar(7000))), Kind::blank);
  EXPECT_EQ(kind_of(cv::Mat(100, 100, CV_32FC1, cv::Scalar(1))), Kind::unknown_format);
  EXPECT_EQ(kind_of(cv::Mat()), Kind::unknown_format);
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    cv::Mat image = test::picture({}, 4);
    if (type == CV_8UC3) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
    if (type == CV_16UC1) image.convertTo(image, CV_16U, 4.0, 7000.0);
    EXPECT_EQ(kind_of(image), Kind::good);
    EXPECT_TRUE(judge(frame(image, 0.0), {}, {}).reason.empty());
  }
}

TEST(ImageCheck, ComparesOnlyImagesOfOneFormat) {
  const cv::Mat image = test::picture({}, 5);
  cv::Mat smaller = image.rowRange(0, 100).clone();
  EXPECT_TRUE(judged({frame(image, 0.0), frame(smaller, 0.1)})[1].usable());
}

}  // namespace
}  // namespace pllit
