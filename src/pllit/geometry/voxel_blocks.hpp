// Voxels in blocks that lie together in memory as they do in space: for large cells, and for who walks by place, over
// what an image shows or what is around a voxel.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

/// Cells keep their places in memory until one is made in their block, or any is taken out.
template <class Cell>
class VoxelBlocks {
 public:
  static constexpr std::uint32_t kSide = 8;

  class Block {
   public:
    /// Its first voxel.
    const Eigen::Vector3i& corner() const { return corner_; }
    bool empty() const { return entries_.empty(); }
    /// visit(voxel, cell), in the order in which the cells were made.
    template <class Visit>
    void for_each(const Visit& visit) {
      for (Entry& entry : entries_) visit(voxel(entry.place), entry.cell);
    }
    template <class Visit>
    void for_each(const Visit& visit) const {
      for (const Entry& entry : entries_) visit(voxel(entry.place), entry.cell);
    }

   private:
    friend class VoxelBlocks;
    struct Entry {
      Cell cell{};
      std::uint32_t place = 0;
    };

    Eigen::Vector3i voxel(std::uint32_t place) const {
      return corner_ + Eigen::Vector3<std::uint32_t>(place / (kSide * kSide), place / kSide % kSide, place % kSide)
                           .template cast<int>();
    }
    std::size_t bytes() const { return entries_.capacity() * sizeof(Entry); }

    Eigen::Vector3i corner_ = Eigen::Vector3i::Zero();
    std::vector<Entry> entries_;
  };

  const Cell* find(VoxelKey key) const {
    const auto [at, place] = split(voxel_of_key(key));
    const std::uint32_t* index = block_of_.find(at);
    if (!index) return nullptr;
    const std::uint16_t number = numbers_[*index][place];
    return number == 0 ? nullptr : &blocks_[*index].entries_[number - 1U].cell;
  }

  /// The cell of a voxel, made if absent; second: whether it was made.
  std::pair<Cell*, bool> insert(VoxelKey key) {
    const Eigen::Vector3i voxel = voxel_of_key(key);
    const auto [at, place] = split(voxel);
    const std::uint32_t index = index_of(at, voxel);
    std::uint16_t& number = numbers_[index][place];
    Block& block = blocks_[index];
    if (number != 0) return {&block.entries_[number - 1U].cell, false};
    cell_bytes_ -= block.bytes();
    block.entries_.push_back({.place = place});
    cell_bytes_ += block.bytes();
    number = static_cast<std::uint16_t>(block.entries_.size());
    ++size_;
    return {&block.entries_.back().cell, true};
  }

  /// Keeps only the cells for which keep(voxel, cell) holds, of the next so many blocks, in turn.
  template <class Keep>
  void retain_in(std::size_t blocks, const Keep& keep) {
    for (blocks = std::min(blocks, blocks_.size()); blocks > 0; --blocks) {
      if (next_ >= blocks_.size()) next_ = 0;
      thin(next_++, keep);
    }
  }
  template <class Keep>
  void retain(const Keep& keep) {
    retain_in(blocks_.size(), keep);
  }

  /// Empty ones among them.
  std::vector<Block>& blocks() { return blocks_; }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Block& block : blocks_) block.for_each(visit);
  }

  std::size_t size() const { return size_; }
  std::size_t bytes() const {
    return block_of_.bytes() + blocks_.capacity() * sizeof(Block) + numbers_.size() * sizeof(Numbers) + cell_bytes_;
  }

 private:
  /// 1 + number of the cell at each place of a block, 0: none.
  using Numbers = std::array<std::uint16_t, kSide * kSide * kSide>;

  /// Key of a voxel's block, and its place in there.
  static std::pair<VoxelKey, std::uint32_t> split(const Eigen::Vector3i& voxel) {
    static_assert(kSide == 8);
    const Eigen::Vector3<std::uint32_t> within =
        voxel.unaryExpr([](int i) { return i & 7; }).template cast<std::uint32_t>();
    return {voxel_key(voxel.unaryExpr([](int i) { return i >> 3; })),
            (within.x() * kSide + within.y()) * kSide + within.z()};
  }

  std::uint32_t index_of(VoxelKey at, const Eigen::Vector3i& voxel) {
    const auto [index, is_new] = block_of_.insert(at);
    if (!is_new) return *index;
    if (spare_.empty()) {
      spare_.push_back(static_cast<std::uint32_t>(blocks_.size()));
      blocks_.emplace_back();
      numbers_.emplace_back();
    }
    *index = spare_.back();
    spare_.pop_back();
    blocks_[*index].corner_ = voxel.unaryExpr([](int i) { return i & ~7; });
    return *index;
  }

  template <class Keep>
  void thin(std::uint32_t index, const Keep& keep) {
    Block& block = blocks_[index];
    const std::size_t bytes_before = block.bytes();
    const std::size_t dropped =
        std::erase_if(block.entries_, [&](const auto& entry) { return !keep(block.voxel(entry.place), entry.cell); });
    if (dropped == 0) return;
    size_ -= dropped;
    Numbers& numbers = numbers_[index];
    numbers.fill(0);
    for (std::size_t i = 0; i < block.entries_.size(); ++i)
      numbers[block.entries_[i].place] = static_cast<std::uint16_t>(i + 1);
    if (block.empty()) {
      block.entries_.shrink_to_fit();
      block_of_.erase(split(block.corner_).first);
      spare_.push_back(index);
    }
    cell_bytes_ = cell_bytes_ - bytes_before + block.bytes();
  }

  VoxelTable<std::uint32_t> block_of_;
  std::vector<Block> blocks_;
  std::deque<Numbers> numbers_;       ///< of each block
  std::vector<std::uint32_t> spare_;  ///< blocks that hold nothing any more
  std::size_t size_ = 0, cell_bytes_ = 0;
  std::uint32_t next_ = 0;  ///< block to be thinned
};

}  // namespace pllit
