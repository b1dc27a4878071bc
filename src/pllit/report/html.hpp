// Pieces of a page that needs nothing but itself.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

namespace pllit {

/// Text as it may stand between tags and in attributes.
std::string escaped(std::string_view text);
std::string base64(std::string_view bytes);
/// An <img> that carries its picture as PNG; empty for an empty picture. `alt` is escaped.
std::string image_tag(const cv::Mat& picture, std::string_view alt);
/// "2026-11-28 08:01:38 UTC" of seconds since 1970.
std::string utc_text(double seconds);

}  // namespace pllit
