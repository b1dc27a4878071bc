#include "pllit/report/html.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace pllit {
namespace {

TEST(Html, EscapesWhatWouldBeMarkup) {
  EXPECT_EQ(escaped("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(Html, EncodesTheExamplesOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Html, CarriesAPictureAsPng) {
  const std::string tag = image_tag(cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3)), "a \"plan\"");
  EXPECT_TRUE(tag.starts_with("<img alt=\"a &quot;plan&quot;\" src=\"data:image/png;base64,iVBORw0KGgo")) << tag;
  EXPECT_EQ(image_tag({}, "nothing"), "");
}

TEST(Html, TellsTheTimeInUtc) { EXPECT_EQ(utc_text(1'700'000'000.4), "2023-11-14 22:13:20 UTC"); }

}  // namespace
}  // namespace pllit
