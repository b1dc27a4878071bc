#include "pllit/io/bag_reader.hpp"

#include <algorithm>
#include <format>
#include <set>
#include <utility>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_merger.hpp"
#include "pllit/io/livox_custom_msg.hpp"
#include "pllit/io/point_cloud2.hpp"
#include "pllit/io/reading_tally.hpp"
#include "pllit/io/ros_messages.hpp"

namespace pllit {
namespace {

using std::chrono::seconds;

Expected<BagTopics> choose_topics(const std::vector<TopicInfo>& topics, const BagOptions& options) {
  const auto imu = choose_topic(SensorRole::imu, options.imu_topic, topics);
  if (!imu) return std::unexpected(imu.error());
  const auto lidar = choose_topic(SensorRole::lidar, options.lidar_topic, topics);
  if (!lidar) return std::unexpected(lidar.error());
  BagTopics chosen{.imu = imu->value(), .lidar = lidar->value()};
  if (!options.with_images) return chosen;
  auto image = choose_topic(SensorRole::image, options.image_topic, topics);
  if (!image) return std::unexpected(image.error());
  chosen.image = *image;
  return chosen;
}

/// Headers that nobody stamped; a clock that itself starts at zero is told by the time received.
bool is_unstamped(Time stamp, Time received) { return stamp == Time{} && received > Time{} + seconds(2); }

}  // namespace

struct BagSource::Impl {
  bag::BagMerger merger;
  BagTopics topics;
  BagOptions options;
  std::vector<std::string> opening_notes{};
  Time now{};
  Time latest{};
  std::optional<TimeLayout> layout{};
  ReadingTally tally{};

  Expected<SensorEvent> decode(const bag::Message& message, const bag::Connection& connection);
  Expected<DecodedScan> decode_scan(Bytes bytes, const std::string& type);
  Time stamp_or_received(Time stamp, Time received);
};

BagSource::BagSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BagSource::~BagSource() = default;
const BagTopics& BagSource::topics() const { return impl_->topics; }
std::optional<TimeLayout> BagSource::time_layout() const { return impl_->layout; }

Time BagSource::Impl::stamp_or_received(Time stamp, Time received) {
  if (!is_unstamped(stamp, received)) return stamp;
  tally.add_unstamped();
  return received;
}

Expected<DecodedScan> BagSource::Impl::decode_scan(Bytes bytes, const std::string& type) {
  if (type != "sensor_msgs/PointCloud2") return decode_livox_custom_msg(bytes);
  PointCloudOptions cloud_options{.time_unit = options.point_time_unit, .stamp_at_scan_end = options.scan_stamp_at_end};
  // A unit found with certainty holds for the recording, so that a short scan cannot be misread.
  if (layout && layout->unit_is_certain) cloud_options.time_unit = layout->unit;
  return decode_point_cloud2(bytes, cloud_options);
}

Expected<SensorEvent> BagSource::Impl::decode(const bag::Message& message, const bag::Connection& connection) {
  const Time received = message.received;
  if (connection.topic == topics.imu) {
    auto sample = decode_imu(message.bytes);
    if (!sample) return std::unexpected(sample.error());
    sample->time = stamp_or_received(sample->time, received);
    return SensorEvent{received, *sample};
  }
  if (connection.topic == topics.lidar) {
    auto decoded = decode_scan(message.bytes, connection.type);
    if (!decoded) return std::unexpected(decoded.error());
    tally.add_scan(*decoded);
    if (decoded->time_layout && (!layout || !layout->unit_is_certain)) layout = decoded->time_layout;
    const bool from_points = decoded->time_layout && decoded->time_layout->absolute && !decoded->clocks_differ;
    LidarScan& scan = decoded->scan;
    if (!from_points && is_unstamped(decoded->header_stamp, received)) {
      tally.add_unstamped();
      scan.start = received - (scan.end() - scan.start);  // a scan is received when its sweep ends
    }
    return SensorEvent{received, std::move(scan)};
  }
  auto frame =
      connection.type == "sensor_msgs/Image" ? decode_image(message.bytes) : decode_compressed_image(message.bytes);
  if (!frame) return std::unexpected(frame.error());
  frame->time = stamp_or_received(frame->time, received);
  return SensorEvent{received, std::move(*frame)};
}

Expected<std::optional<SensorEvent>> BagSource::next() {
  while (const auto message = impl_->merger.next()) {
    if (message->received < impl_->latest) impl_->tally.add_out_of_order();
    impl_->now = message->received;
    impl_->latest = std::max(impl_->latest, message->received);
    const bag::Connection& connection = impl_->merger.files()[message->file].connections().at(message->connection);
    auto event = impl_->decode(*message, connection);
    if (event) {
      impl_->tally.add_good(connection.topic);
      return std::optional(std::move(*event));
    }
    if (!impl_->tally.add_bad(connection.topic, event.error().message)) {
      return input_error(std::format("{}: none of its first messages can be read. The first: {}", connection.topic,
                                     impl_->tally.first_reason(connection.topic)));
    }
  }
  return std::nullopt;
}

double BagSource::progress() const {
  const auto& merger = impl_->merger;
  if (impl_->now == Time{} || merger.last() <= merger.first()) return impl_->now == Time{} ? 0.0 : 1.0;
  return std::clamp(to_seconds(impl_->now - merger.first()) / to_seconds(merger.last() - merger.first()), 0.0, 1.0);
}

std::vector<std::string> BagSource::notes() const {
  std::vector<std::string> notes = impl_->opening_notes;
  std::ranges::move(impl_->merger.notes(), std::back_inserter(notes));
  std::ranges::move(impl_->tally.notes(impl_->topics.lidar), std::back_inserter(notes));
  return notes;
}

Expected<std::unique_ptr<BagSource>> open_bags(const std::vector<std::filesystem::path>& paths,
                                               const BagOptions& options) {
  auto files = bag::open_files(paths);
  if (!files) return std::unexpected(files.error());
  auto topics = choose_topics(bag::topics_of(*files), options);
  if (!topics) return std::unexpected(topics.error());
  std::vector<std::set<std::uint32_t>> wanted(files->size());
  for (std::size_t i = 0; i < files->size(); ++i) {
    for (const auto& [id, connection] : (*files)[i].connections()) {
      const bool is_imu = connection.topic == topics->imu && serves(SensorRole::imu, connection.type);
      const bool is_lidar = connection.topic == topics->lidar && serves(SensorRole::lidar, connection.type);
      const bool is_image = connection.topic == topics->image && serves(SensorRole::image, connection.type);
      if (is_imu || is_lidar || is_image) wanted[i].insert(id);
    }
  }
  auto impl = std::make_unique<BagSource::Impl>(BagSource::Impl{
      .merger = bag::BagMerger(std::move(*files), std::move(wanted)), .topics = *topics, .options = options});
  if (options.with_images && !topics->image) impl->opening_notes.push_back("there is no image topic");
  return std::unique_ptr<BagSource>(new BagSource(std::move(impl)));
}

}  // namespace pllit
