// The wanted messages of one or several bags, in the order in which they were received.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "pllit/io/bag_file.hpp"

namespace pllit::bag {

struct Message {
  Time received;
  std::size_t file = 0;
  std::uint32_t connection = 0;
  Bytes bytes;  ///< valid until the next message is asked for
};

/// Opens each chunk only when its time has come and drops it when its last message is out, so memory grows neither with
/// the length of the recording nor, where many chunks overlap in time, beyond a fixed budget.
class BagMerger {
 public:
  /// `wanted[i]`: connections of `files[i]` to deliver.
  BagMerger(std::vector<BagFile> files, std::vector<std::set<std::uint32_t>> wanted);

  /// Nothing at the end. Chunks that cannot be read are skipped and noted.
  std::optional<Message> next();

  const std::vector<BagFile>& files() const { return files_; }
  /// What was found wrong so far, the files' own notes first, in words.
  std::vector<std::string> notes() const;
  Time first() const { return first_; }
  Time last() const { return last_; }

 private:
  /// When a chunk's next message was received, and which chunk it is; equal times keep the order of the files.
  using Place = std::tuple<Time, std::size_t, std::size_t>;
  struct Cursor {
    OpenChunk chunk;
    std::size_t next = 0;
  };

  void open_due_chunks();
  void open(const Place& place);
  void note_damage(std::string note);
  bool hold_bytes(const Place& place, Cursor& cursor);
  std::optional<Message> advance();

  std::vector<BagFile> files_;
  std::vector<std::set<std::uint32_t>> wanted_;
  std::vector<Place> pending_;  ///< chunks not opened yet, latest first
  std::map<Place, Cursor> open_;
  std::shared_ptr<ByteSource> delivered_;  ///< keeps the last message's bytes alive
  std::size_t held_bytes_ = 0;
  std::vector<std::string> notes_;  ///< the first few damaged chunks
  std::size_t damaged_chunks_ = 0;
  std::size_t unreadable_ = 0;
  Time first_;
  Time last_;
};

}  // namespace pllit::bag
