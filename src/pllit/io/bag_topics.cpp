#include "pllit/io/bag_topics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <format>
#include <map>
#include <span>
#include <utility>

#include "pllit/base/words.hpp"

namespace pllit {
namespace {

struct RoleFacts {
  std::string_view name;
  std::string_view option;
  std::string_view needed;
  std::span<const std::string_view> types;
  std::span<const std::string_view> likely;    ///< parts of names that speak for the role
  std::span<const std::string_view> unlikely;  ///< and against it
};

constexpr std::array<std::string_view, 1> kImuTypes = {"sensor_msgs/Imu"};
constexpr std::array<std::string_view, 3> kLidarTypes = {"sensor_msgs/PointCloud2", "livox_ros_driver/CustomMsg",
                                                         "livox_ros_driver2/CustomMsg"};
constexpr std::array<std::string_view, 2> kImageTypes = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};
constexpr std::array<std::string_view, 2> kImuLikely = {"imu", "data"};
constexpr std::array<std::string_view, 2> kImuUnlikely = {"mag", "filter"};
constexpr std::array<std::string_view, 9> kLidarLikely = {"lidar",  "velodyne", "ouster",  "os_cloud", "hesai",
                                                          "pandar", "livox",    "rslidar", "points"};
constexpr std::array<std::string_view, 6> kLidarUnlikely = {"map",   "registered", "radar",
                                                            "depth", "camera",     "filtered"};
constexpr std::array<std::string_view, 7> kImageLikely = {"thermal", "infra", "lwir", "flir", "boson", "/ir", "image"};
constexpr std::array<std::string_view, 3> kImageUnlikely = {"depth", "rgb", "right"};

const RoleFacts& facts_of(SensorRole role) {
  static constexpr RoleFacts kImu = {"IMU", "input.imu_topic", "sensor_msgs/Imu", kImuTypes, kImuLikely, kImuUnlikely};
  static constexpr RoleFacts kLidar = {"LiDAR",     "input.lidar_topic", "sensor_msgs/PointCloud2 or Livox CustomMsg",
                                       kLidarTypes, kLidarLikely,        kLidarUnlikely};
  static constexpr RoleFacts kImage = {"image",     "input.image_topic", "sensor_msgs/Image or CompressedImage",
                                       kImageTypes, kImageLikely,        kImageUnlikely};
  return role == SensorRole::imu ? kImu : role == SensorRole::lidar ? kLidar : kImage;
}

/// A topic of all bags together.
std::vector<TopicInfo> by_name(const std::vector<TopicInfo>& topics) {
  std::map<std::pair<std::string, std::string>, TopicInfo> merged;
  for (const TopicInfo& topic : topics) {
    const auto [entry, is_new] = merged.try_emplace({topic.name, topic.type}, topic);
    if (is_new) continue;
    entry->second.count += topic.count;
    entry->second.first = std::min(entry->second.first, topic.first);
    entry->second.last = std::max(entry->second.last, topic.last);
  }
  std::vector<TopicInfo> result;
  for (auto& [key, topic] : merged) result.push_back(std::move(topic));
  return result;
}

std::string listed(const std::vector<TopicInfo>& topics) {
  std::string text = "The recording holds:";
  for (const TopicInfo& topic : topics) {
    text += std::format("\n  {}  {}  {} messages  {:.1f} Hz", topic.name, topic.type, topic.count, topic.rate_hz());
  }
  return text;
}

int likelihood(const RoleFacts& facts, const TopicInfo& topic) {
  std::string name = topic.name;
  std::ranges::transform(name, name.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const auto hits = [&](std::span<const std::string_view> parts) {
    return static_cast<int>(std::ranges::count_if(parts, [&](std::string_view part) { return name.contains(part); }));
  };
  return hits(facts.likely) - 2 * hits(facts.unlikely);
}

/// The first with the best name; of equal names the one with most messages.
const TopicInfo& likeliest(const RoleFacts& facts, const std::vector<TopicInfo>& candidates) {
  return *std::ranges::max_element(
      candidates, {}, [&](const TopicInfo& topic) { return std::pair(likelihood(facts, topic), topic.count); });
}

std::unexpected<Error> missing(const RoleFacts& facts, const std::string& wanted,
                               const std::vector<TopicInfo>& candidates, const std::vector<TopicInfo>& all) {
  std::string message = std::format("there is no topic '{}' for the {}.", wanted, facts.name);
  const auto same_name = std::ranges::find(all, wanted, &TopicInfo::name);
  if (same_name != all.end()) {
    message =
        std::format("topic '{}' is a {}, but the {} needs {}.", wanted, same_name->type, facts.name, facts.needed);
  }
  if (!candidates.empty()) {
    const auto& nearest = *std::ranges::min_element(
        candidates, {}, [&](const TopicInfo& topic) { return edit_distance(topic.name, wanted); });
    message += std::format(" Likely meant: --set {}={}.", facts.option, nearest.name);
  }
  return input_error(message + "\n" + listed(all));
}

}  // namespace

bool serves(SensorRole role, std::string_view type) { return std::ranges::contains(facts_of(role).types, type); }

Expected<std::optional<std::string>> choose_topic(SensorRole role, const std::string& wanted,
                                                  const std::vector<TopicInfo>& topics) {
  const RoleFacts& facts = facts_of(role);
  const std::vector<TopicInfo> all = by_name(topics);
  std::vector<TopicInfo> candidates;
  std::ranges::copy_if(all, std::back_inserter(candidates),
                       [&](const TopicInfo& topic) { return topic.count > 0 && serves(role, topic.type); });
  if (!wanted.empty()) {
    if (std::ranges::contains(candidates, wanted, &TopicInfo::name)) return wanted;
    return missing(facts, wanted, candidates, all);
  }
  if (candidates.size() == 1) return candidates.front().name;
  if (!candidates.empty()) {
    return input_error(std::format("{} topics could be the {}. Likely meant: --set {}={}.\n{}", candidates.size(),
                                   facts.name, facts.option, likeliest(facts, candidates).name, listed(all)));
  }
  if (role == SensorRole::image) return std::nullopt;
  return input_error(std::format("there is no {} topic: {} is needed.\n{}", facts.name, facts.needed, listed(all)));
}

}  // namespace pllit
