#include "pllit/io/bag_description.hpp"

#include <algorithm>
#include <format>
#include <map>
#include <set>
#include <utility>

namespace pllit {
namespace {

using ConnectionIds = std::set<std::uint32_t>;

/// Times of the topic's messages in one chunk; none where it cannot be read.
std::vector<Time> times_in(bag::BagFile& file, std::size_t chunk_index, const ConnectionIds& ids) {
  std::vector<Time> times;
  if (const auto chunk = file.open_chunk(chunk_index)) {
    for (const bag::MessageRef& message : chunk->messages) {
      if (ids.contains(message.connection)) times.push_back(message.time);
    }
  }
  return times;
}

ConnectionIds ids_of(const bag::BagFile& file, const TopicInfo& topic) {
  ConnectionIds ids;
  for (const auto& [id, connection] : file.connections()) {
    if (connection.topic == topic.name && connection.type == topic.type) ids.insert(id);
  }
  return ids;
}

std::uint64_t count_in(const bag::Chunk& chunk, const ConnectionIds& ids) {
  std::uint64_t count = 0;
  for (const auto& [id, messages] : chunk.counts) count += ids.contains(id) ? messages : 0;
  return count;
}

/// Replaces times known to a chunk by those of the messages.
void narrow_times(bag::BagFile& file, TopicInfo& topic) {
  const ConnectionIds ids = ids_of(file, topic);
  std::optional<std::size_t> first;
  std::optional<std::size_t> last;
  const auto& chunks = file.chunks();
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (count_in(chunks[i], ids) == 0) continue;
    if (!first || chunks[i].start < chunks[*first].start) first = i;
    if (!last || chunks[i].end > chunks[*last].end) last = i;
  }
  if (!first) return;
  const std::vector<Time> early = times_in(file, *first, ids);
  const std::vector<Time> late = first == last ? early : times_in(file, *last, ids);
  if (!early.empty()) topic.first = std::ranges::min(early);
  if (!late.empty()) topic.last = std::ranges::max(late);
}

std::vector<TopicInfo> topics_of_file(const bag::BagFile& file) {
  std::map<std::pair<std::string, std::string>, TopicInfo> topics;
  for (const auto& [id, connection] : file.connections()) {
    topics.try_emplace({connection.topic, connection.type},
                       TopicInfo{.name = connection.topic, .type = connection.type, .bag = file.path()});
  }
  for (const bag::Chunk& chunk : file.chunks()) {
    for (const auto& [id, count] : chunk.counts) {
      const auto connection = file.connections().find(id);
      if (connection == file.connections().end() || count == 0) continue;
      TopicInfo& topic = topics.at({connection->second.topic, connection->second.type});
      topic.first = topic.count == 0 ? chunk.start : std::min(topic.first, chunk.start);
      topic.last = topic.count == 0 ? chunk.end : std::max(topic.last, chunk.end);
      topic.count += count;
    }
  }
  std::vector<TopicInfo> result;
  for (auto& [key, topic] : topics) result.push_back(std::move(topic));
  return result;
}

}  // namespace

namespace bag {

Expected<std::vector<BagFile>> open_files(const std::vector<std::filesystem::path>& paths) {
  if (paths.empty()) return input_error("no bag was given");
  std::vector<BagFile> files;
  std::set<std::filesystem::path> seen;
  for (const std::filesystem::path& path : paths) {
    std::error_code code;
    if (!seen.insert(std::filesystem::weakly_canonical(path, code)).second) {
      return input_error(std::format("'{}' was given twice", path.string()));
    }
    auto file = BagFile::open(path);
    if (!file) return std::unexpected(file.error());
    files.push_back(std::move(*file));
  }
  return files;
}

std::vector<TopicInfo> topics_of(const std::vector<BagFile>& files) {
  std::vector<TopicInfo> topics;
  for (const BagFile& file : files) std::ranges::move(topics_of_file(file), std::back_inserter(topics));
  return topics;
}

}  // namespace bag

Expected<BagDescription> describe_bags(const std::vector<std::filesystem::path>& paths) {
  auto files = bag::open_files(paths);
  if (!files) return std::unexpected(files.error());
  BagDescription description;
  for (bag::BagFile& file : *files) {
    for (TopicInfo& topic : topics_of_file(file)) {
      narrow_times(file, topic);
      description.topics.push_back(std::move(topic));
    }
    std::ranges::copy(file.notes(), std::back_inserter(description.notes));
  }
  return description;
}

}  // namespace pllit
