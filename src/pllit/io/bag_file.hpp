// One ROS 1 bag: which chunks and connections it holds, and the messages of a chunk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"
#include "pllit/io/bag_format.hpp"
#include "pllit/io/byte_source.hpp"

namespace pllit::bag {

struct Connection {
  std::string topic;
  std::string type;
  std::string md5;
};

/// Where a chunk lies. A bag's index tells only `record`; the rest is then read when the chunk is opened.
struct Chunk {
  std::uint64_t record = 0;  ///< position of the chunk's record
  Time start{};
  Time end{};
  std::map<std::uint32_t, std::uint64_t> counts{};  ///< messages a connection
  bool located = false;                             ///< the three below are known
  Compression compression = Compression::none;
  std::uint64_t data_offset = 0;
  std::uint64_t data_size = 0;
  std::uint32_t size = 0;  ///< once decompressed
};

/// Where a message lies in its chunk's bytes.
struct MessageRef {
  Time time;
  std::uint32_t connection = 0;
  std::uint32_t size = 0;
  std::uint64_t offset = 0;
};

/// The messages of a chunk in the order of the file, and the bytes they lie in: the file's own where the chunk is not
/// compressed, so that only messages that are wanted are read.
struct OpenChunk {
  std::vector<MessageRef> messages;
  std::shared_ptr<ByteSource> bytes;
  std::size_t held_bytes = 0;  ///< memory that `bytes` takes
  std::uint64_t end = 0;       ///< where reading stopped
  bool damaged = false;        ///< it stopped at a record that makes no sense
};

/// Reads the format itself rather than through rosbag, whose reader trusts every offset and length of the file, holds
/// an index entry for each message in memory, and refuses a bag that its recorder did not close. Whatever a damaged
/// file claims is compared with what is there before it is believed.
class BagFile {
 public:
  /// Errors: no such file, not a ROS 1 bag, an encrypted one, or nothing in it that can be read.
  static Expected<BagFile> open(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// What was found wrong while opening, in words.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Errors: a chunk that is not where the index says, or does not decompress.
  Expected<OpenChunk> open_chunk(std::size_t index);

 private:
  BagFile(std::filesystem::path path, std::shared_ptr<FileBytes> file)
      : path_(std::move(path)), file_(std::move(file)) {}

  Expected<void> check_version();
  bool read_index(const Record& file_header);
  bool read_index_record(const Record& record);
  void salvage();
  std::uint64_t salvage_chunk(std::uint64_t position, const Record& record);
  std::uint64_t salvage_open_end(std::uint64_t position);
  bool summarise_from_index(std::uint64_t& position, Chunk& chunk);
  bool summarise_from_messages(Chunk& chunk);
  Expected<void> locate(Chunk& chunk);
  OpenChunk list_messages(std::shared_ptr<ByteSource> bytes, std::uint64_t begin, std::uint64_t end);
  bool add_connection(ByteSource& bytes, const Record& record);
  bool index_is_consistent() const;

  std::filesystem::path path_;
  std::shared_ptr<FileBytes> file_;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<Chunk> chunks_;
  std::vector<std::string> notes_;
};

}  // namespace pllit::bag
