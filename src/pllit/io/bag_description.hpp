// What a recording holds: its topics, before anything is decoded.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/bag_file.hpp"
#include "pllit/io/bag_topics.hpp"

namespace pllit {

struct BagDescription {
  std::vector<TopicInfo> topics;  ///< of all bags, by bag and name
  std::vector<std::string> notes;
};

/// What the bags hold, whatever the type of the topics; times to the message.
Expected<BagDescription> describe_bags(const std::vector<std::filesystem::path>& paths);

namespace bag {

/// Errors: those of BagFile::open(), no path at all, and the same file twice.
Expected<std::vector<BagFile>> open_files(const std::vector<std::filesystem::path>& paths);

/// Topics of all files, by file and name; times to a chunk.
std::vector<TopicInfo> topics_of(const std::vector<BagFile>& files);

}  // namespace bag
}  // namespace pllit
