#include "pllit/io/bag_merger.hpp"

#include <algorithm>
#include <format>
#include <tuple>
#include <utility>

namespace pllit::bag {
namespace {

constexpr std::size_t kHeldBytesBudget = 256u << 20;  // decompressed chunks in memory; usually two of 768 KiB
constexpr std::size_t kMostNotes = 5;

bool holds_any(const Chunk& chunk, const std::set<std::uint32_t>& wanted) {
  return std::ranges::any_of(chunk.counts, [&](const auto& entry) { return wanted.contains(entry.first); });
}

std::uint64_t total(const Chunk& chunk, const std::set<std::uint32_t>& wanted) {
  std::uint64_t messages = 0;
  for (const auto& [connection, count] : chunk.counts) messages += wanted.contains(connection) ? count : 0;
  return messages;
}

}  // namespace

BagMerger::BagMerger(std::vector<BagFile> files, std::vector<std::set<std::uint32_t>> wanted)
    : files_(std::move(files)), wanted_(std::move(wanted)) {
  for (std::size_t file = 0; file < files_.size(); ++file) {
    const auto& chunks = files_[file].chunks();
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (!holds_any(chunks[i], wanted_[file])) continue;
      last_ = pending_.empty() ? chunks[i].end : std::max(last_, chunks[i].end);
      pending_.emplace_back(chunks[i].start, file, i);
    }
  }
  std::ranges::sort(pending_, std::greater{});
  if (!pending_.empty()) first_ = std::get<Time>(pending_.back());
}

void BagMerger::note_damage(std::string note) {
  ++damaged_chunks_;
  if (notes_.size() < kMostNotes) notes_.push_back(std::move(note));
}

void BagMerger::open(const Place& place) {
  const auto [start, file_index, index] = place;
  BagFile& file = files_[file_index];
  const auto& wanted = wanted_[file_index];
  const std::uint64_t expected = total(file.chunks()[index], wanted);
  Expected<OpenChunk> chunk = file.open_chunk(index);
  if (!chunk) {
    note_damage(std::format("{}; {} messages skipped", chunk.error().message, expected));
    return;
  }
  std::erase_if(chunk->messages, [&](const MessageRef& message) { return !wanted.contains(message.connection); });
  if (chunk->damaged) {
    note_damage(std::format("{}, chunk at byte {}: damaged from byte {} of it on, {} of {} messages were read",
                            file.path().string(), file.chunks()[index].record, chunk->end, chunk->messages.size(),
                            expected));
  }
  if (chunk->messages.empty()) return;
  std::ranges::stable_sort(chunk->messages, {}, &MessageRef::time);
  held_bytes_ += chunk->held_bytes;
  const Time first = chunk->messages.front().time;
  open_.emplace(Place(first, file_index, index), Cursor{.chunk = std::move(*chunk)});
}

void BagMerger::open_due_chunks() {
  while (!pending_.empty() && (open_.empty() || pending_.back() <= open_.begin()->first)) {
    const Place place = pending_.back();
    pending_.pop_back();
    open(place);
  }
}

/// Sees that the cursor's bytes are in memory. Where that exceeds the budget, those of all others go and are read again
/// when their turn comes.
bool BagMerger::hold_bytes(const Place& place, Cursor& cursor) {
  if (!cursor.chunk.bytes) {
    Expected<OpenChunk> again = files_[std::get<1>(place)].open_chunk(std::get<2>(place));
    if (!again) return false;
    cursor.chunk.bytes = std::move(again->bytes);
    held_bytes_ += cursor.chunk.held_bytes;
  }
  if (held_bytes_ <= kHeldBytesBudget) return true;
  for (auto& [other, waiting] : open_) {
    if (waiting.chunk.held_bytes > 0) waiting.chunk.bytes.reset();
  }
  held_bytes_ = cursor.chunk.held_bytes;
  return true;
}

/// Takes the earliest message; nothing where its bytes could not be read.
std::optional<Message> BagMerger::advance() {
  auto node = open_.extract(open_.begin());
  Cursor& cursor = node.mapped();
  const auto [time, file, index] = node.key();
  if (!hold_bytes(node.key(), cursor)) {
    unreadable_ += cursor.chunk.messages.size() - cursor.next;
    return std::nullopt;
  }
  const MessageRef message = cursor.chunk.messages[cursor.next++];
  delivered_ = cursor.chunk.bytes;
  if (cursor.next < cursor.chunk.messages.size()) {
    node.key() = Place(cursor.chunk.messages[cursor.next].time, file, index);
    open_.insert(std::move(node));
  } else {
    held_bytes_ -= cursor.chunk.held_bytes;
  }
  const Bytes bytes = delivered_->at(message.offset, message.size);
  if (bytes.size() != message.size) {
    ++unreadable_;
    return std::nullopt;
  }
  return Message{message.time, file, message.connection, bytes};
}

std::optional<Message> BagMerger::next() {
  while (true) {
    open_due_chunks();
    if (open_.empty()) return std::nullopt;
    if (auto message = advance()) return message;
  }
}

std::vector<std::string> BagMerger::notes() const {
  std::vector<std::string> result;
  for (const BagFile& file : files_) result.insert(result.end(), file.notes().begin(), file.notes().end());
  result.insert(result.end(), notes_.begin(), notes_.end());
  if (damaged_chunks_ > notes_.size()) {
    result.push_back(std::format("{} more chunks are damaged", damaged_chunks_ - notes_.size()));
  }
  if (unreadable_ > 0) result.push_back(std::format("{} messages could not be read from the disk", unreadable_));
  return result;
}

}  // namespace pllit::bag
