#include "pllit/io/tum.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <format>
#include <limits>
#include <string>
#include <string_view>

namespace pllit {
namespace {

constexpr std::string_view kHeader = "# time_s x_m y_m z_m qx qy qz qw\n";
constexpr std::string_view kBlank = " \t\r";
constexpr double kQuaternionTolerance = 0.01;  // files with three decimals still pass

/// Exponent after 'e' or 'E'; nothing unless it is a small integer.
std::optional<int> exponent_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > 30) return std::nullopt;
  return exponent;
}

/// Nanoseconds from decimal seconds such as 1403636579.763555527 or 1.403636579763555527e+09, rounded half away from
/// zero after the ninth decimal. The digits are shifted as text: a double holds only 100 ns of such a time.
std::optional<Time> time_from_text(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const auto e = text.find_first_of("eE");
  const auto exponent = e == text.npos ? 0 : exponent_of(text.substr(e + 1));
  if (!exponent) return std::nullopt;
  const std::string_view mantissa = text.substr(0, e);
  const auto point = mantissa.find('.');
  std::string digits(mantissa.substr(0, point));
  const auto whole = static_cast<int>(digits.size());
  if (point != mantissa.npos) digits += mantissa.substr(point + 1);
  if (digits.empty() || digits.find_first_not_of("0123456789") != digits.npos) return std::nullopt;

  const int wanted = whole + *exponent + 9;  // digits that lie before the nanosecond's end
  if (wanted < 0) return Time{};
  digits.resize(std::max(digits.size(), static_cast<std::size_t>(wanted) + 1), '0');
  std::int64_t nanoseconds = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + wanted, nanoseconds);
  if (wanted > 0 && parsed.ec != std::errc{}) return std::nullopt;
  if (nanoseconds == std::numeric_limits<std::int64_t>::max()) return std::nullopt;  // no room left to round up
  if (digits[static_cast<std::size_t>(wanted)] >= '5') ++nanoseconds;
  return Time(Duration(negative ? -nanoseconds : nanoseconds));
}

std::optional<double> number_from_text(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto begin = line.find_first_not_of(kBlank); begin != line.npos;) {
    const auto end = std::min(line.find_first_of(kBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlank, end);
  }
  return words;
}

/// One pose; the error says what is wrong with the line, without saying where it is.
Expected<StampedPose> pose_from_line(std::string_view line) {
  const auto words = words_of(line);
  if (words.size() != 8)
    return input_error(std::format("{} columns, expected 8 separated by spaces: t x y z qx qy qz qw", words.size()));
  const auto time = time_from_text(words[0]);
  if (!time)
    return input_error(std::format("'{}' is not a time in seconds (nanosecond stamps: divide by 1e9)", words[0]));
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto number = number_from_text(words[i + 1]);
    if (!number) return input_error(std::format("column {}: '{}' is not a finite number", i + 2, words[i + 1]));
    v[i] = *number;
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > kQuaternionTolerance)
    return input_error(std::format("quaternion of length {:.4g}, expected 1 (order qx qy qz qw)", q.norm()));
  return StampedPose{*time, pose_from(rotation_from(q), Vector3d(v[0], v[1], v[2]))};
}

std::string seconds_text(Time time) {
  const std::int64_t ns = nanoseconds_of(time);
  const auto magnitude = ns < 0 ? ~static_cast<std::uint64_t>(ns) + 1 : static_cast<std::uint64_t>(ns);
  return std::format("{}{}.{:09}", ns < 0 ? "-" : "", magnitude / 1'000'000'000, magnitude % 1'000'000'000);
}

std::string line_of(const StampedPose& pose) {
  const Vector3d p = pose.T_W_I.translation();
  const Eigen::Quaterniond q = pose.T_W_I.quat();
  return std::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", seconds_text(pose.time), p.x(), p.y(),
                     p.z(), q.x(), q.y(), q.z(), q.w());
}

Expected<Trajectory> poses_from_text(std::string_view text, const std::filesystem::path& path) {
  Trajectory trajectory;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto first = line.find_first_not_of(kBlank);
    if (first == line.npos || line[first] == '#') continue;
    const auto where = [&] { return std::format("{} line {}", path.string(), number); };
    const auto pose = pose_from_line(line);
    if (!pose) return in_context(where(), pose.error());
    if (!trajectory.empty() && pose->time <= trajectory.back().time)
      return input_error(std::format("{}: time {} does not come after {}, the time before it; sort the file by time",
                                     where(), seconds_text(pose->time), seconds_text(trajectory.back().time)));
    trajectory.push_back(*pose);
  }
  return trajectory;
}

}  // namespace

Expected<Trajectory> read_tum(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  auto trajectory = poses_from_text(*text, path);
  if (trajectory && trajectory->empty())
    return input_error(std::format("{}: holds no pose (expected lines of t x y z qx qy qz qw)", path.string()));
  return trajectory;
}

Expected<Trajectory> read_interrupted_tum(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  const auto last_end = text->rfind('\n');
  return poses_from_text(std::string_view(*text).substr(0, last_end == text->npos ? 0 : last_end + 1), path);
}

Expected<void> write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  auto writer = TumWriter::create(path);
  if (!writer) return std::unexpected(writer.error());
  for (const StampedPose& pose : trajectory)
    if (auto written = writer->append(pose); !written) return written;
  return writer->close();
}

Expected<TumWriter> TumWriter::create(const std::filesystem::path& path) {
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  if (auto written = file->write(kHeader); !written) return std::unexpected(written.error());
  return TumWriter(std::move(*file));
}

Expected<void> TumWriter::append(const StampedPose& pose) {
  if (!pose.T_W_I.coeffs().allFinite())
    return failure(std::format("{}: pose at {} s is not finite", file_.path().string(), seconds_text(pose.time)));
  if (last_ && pose.time <= *last_)
    return failure(std::format("{}: pose at {} s does not come after {} s", file_.path().string(),
                               seconds_text(pose.time), seconds_text(*last_)));
  const std::uint64_t before = file_.size();
  if (auto written = file_.write(line_of(pose)); !written) {
    file_.cut_to(before);
    return written;
  }
  last_ = pose.time;
  return {};
}

}  // namespace pllit
