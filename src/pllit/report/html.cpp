#include "pllit/report/html.hpp"

#include <chrono>
#include <cstdint>
#include <format>
#include <vector>

#include "pllit/report/pictures.hpp"

namespace pllit {

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0u;
  };
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (std::size_t digit = 0; digit < 4; ++digit)
      text += i + digit <= bytes.size() ? kDigits[three >> (18 - 6 * digit) & 63] : '=';
  }
  return text;
}

std::string image_tag(const cv::Mat& picture, std::string_view alt) {
  if (picture.empty()) return "";
  return std::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escaped(alt), base64(png_of(picture)));
}

std::string utc_text(double seconds) {
  const std::chrono::sys_seconds time{std::chrono::seconds(static_cast<std::int64_t>(seconds))};
  return std::format("{:%Y-%m-%d %H:%M:%S} UTC", time);
}

}  // namespace pllit
