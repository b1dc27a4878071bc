#include "pllit/slam/config_value.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <format>

#include "pllit/base/strict_yaml.hpp"

namespace pllit {
namespace {

using Complaint = std::unexpected<std::string>;
using Read = std::expected<void, std::string>;

constexpr double kUnitTolerance = 1e-3;  // what is farther off than a number rounded to four digits is a mistake

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};

template <class T>
Read read_number(const YAML::Node& node, const Limits& limits, T& target) {
  const auto value = number_of<T>(node, limits);
  if (!value) return Complaint(value.error());
  target = *value;
  return {};
}

template <class T>
Read read_list(const YAML::Node& node, const Limits& limits, std::span<T> target) {
  if (!node.IsSequence() || node.size() != target.size())
    return Complaint(std::format("must be a list of {} numbers, but is {}", target.size(), shape_of(node)));
  std::vector<T> values(target.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const auto read = read_number(node[i], limits, values[i]); !read)
      return Complaint(std::format("number {}: {}", i + 1, read.error()));
  }
  std::ranges::copy(values, target.begin());
  return {};
}

Read read_topic(const YAML::Node& node, std::string& target) {
  if (!node.IsScalar()) return Complaint(std::format("must be a text, but is {}; write \"\" for none", shape_of(node)));
  const std::string& text = node.Scalar();
  if (!std::ranges::all_of(text, [](char c) { return c > ' ' && c < '\x7f'; }))
    return Complaint(std::format("{} has spaces or characters that no name has", in_quotes(text)));
  target = text;
  return {};
}

Read read_choice(const YAML::Node& node, const Key& key, const Choice& choice) {
  const auto word = std::ranges::find(choice.words, node.IsScalar() ? node.Scalar() : "");
  if (word == choice.words.end())
    return Complaint(std::format("must be {}, but is {}", range_text(key), shape_of(node)));
  choice.set(static_cast<std::size_t>(word - choice.words.begin()));
  return {};
}

/// Rows of a homogeneous 4x4 matrix, the rotation as exact as its digits.
Read read_matrix(const YAML::Node& node, const Limits& limits, PoseConfig& target) {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 4; ++i) {
    std::array<double, 4> row{};
    if (const auto read = read_list(node[i], limits, std::span<double>(row)); !read)
      return Complaint(std::format("row {}: {}", i + 1, read.error()));
    matrix.row(i) = Eigen::Map<const Eigen::RowVector4d>(row.data());
  }
  const Matrix3d R = matrix.topLeftCorner<3, 3>();
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)))
    return Complaint("the last row of a 4x4 pose must be [0, 0, 0, 1]");
  if ((R * R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kUnitTolerance || R.determinant() < 0.0)
    return Complaint("the upper left 3x3 part is not a rotation (orthonormal rows, determinant +1)");
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Quaterniond q(Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  target.rotation_xyzw = {q.x(), q.y(), q.z(), q.w()};
  Eigen::Map<Vector3d>(target.translation_m.data()) = matrix.topRightCorner<3, 1>();
  return {};
}

Read read_pose(const YAML::Node& node, const Limits& limits, PoseConfig& target) {
  if (node.IsSequence() && node.size() == 4) return read_matrix(node, limits, target);
  const YAML::Node translation = node.IsMap() ? node["translation_m"] : YAML::Node();
  const YAML::Node rotation = node.IsMap() ? node["rotation_xyzw"] : YAML::Node();
  if (!node.IsMap() || node.size() != 2 || !translation || !rotation)
    return Complaint("must hold translation_m: [x, y, z] and rotation_xyzw: [x, y, z, w], or be a 4x4 matrix");
  PoseConfig pose;
  if (const auto read = read_list(translation, limits, std::span<double>(pose.translation_m)); !read)
    return Complaint("translation_m " + read.error());
  if (const auto read = read_list(rotation, Limits{}, std::span<double>(pose.rotation_xyzw)); !read)
    return Complaint("rotation_xyzw " + read.error());
  const double length = Eigen::Map<const Eigen::Vector4d>(pose.rotation_xyzw.data()).norm();
  if (!(std::abs(length - 1.0) <= kUnitTolerance))
    return Complaint(std::format("rotation_xyzw is not a unit quaternion: its length is {:.6g}", length));
  target = pose;
  return {};
}

Read read_duration(const YAML::Node& node, const Limits& limits, Duration& target) {
  double seconds = 0.0;
  const auto read = read_number(node, limits, seconds);
  if (read) target = from_seconds(seconds);
  return read;
}

template <class T>
std::string list_text(std::span<const T> values) {
  std::string text = "[";
  for (const T& value : values) text += std::format("{}{}", text.size() > 1 ? ", " : "", value);
  return text + "]";
}

std::string topic_text(std::string_view topic) {
  std::string text = "\"";
  for (const char c : topic) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string pose_text(const PoseConfig& pose) {
  return std::format("{{translation_m: {}, rotation_xyzw: {}}}", list_text(std::span<const double>(pose.translation_m)),
                     list_text(std::span<const double>(pose.rotation_xyzw)));
}

}  // namespace

std::expected<void, std::string> read_value(const Key& key, const YAML::Node& node) {
  return std::visit(Overloaded{
                        [&](std::string* target) { return read_topic(node, *target); },
                        [&](Duration* target) { return read_duration(node, key.limits, *target); },
                        [&](PoseConfig* target) { return read_pose(node, key.limits, *target); },
                        [&](const Choice& choice) { return read_choice(node, key, choice); },
                        [&](auto* target) { return read_number(node, key.limits, *target); },
                        [&](auto target) { return read_list(node, key.limits, target); },
                    },
                    key.value);
}

std::string value_text(const Key::Value& value) {
  return std::visit(Overloaded{
                        [](const std::string* text) { return topic_text(*text); },
                        [](const Duration* duration) { return std::format("{}", to_seconds(*duration)); },
                        [](const PoseConfig* pose) { return pose_text(*pose); },
                        [](const Choice& choice) { return std::string(choice.words[choice.get()]); },
                        [](const auto* number) { return std::format("{}", *number); },
                        [](std::span<int> list) { return list_text(std::span<const int>(list)); },
                        [](std::span<double> list) { return list_text(std::span<const double>(list)); },
                    },
                    value);
}

std::string range_text(const Key& key) {
  if (const auto* choice = std::get_if<Choice>(&key.value)) {
    std::string text;
    for (const std::string_view word : choice->words) text += std::format("{}{}", text.empty() ? "" : " | ", word);
    return text;
  }
  return std::isfinite(key.limits.min) ? std::format("{} to {}", key.limits.min, key.limits.max) : "";
}

}  // namespace pllit
