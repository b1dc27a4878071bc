// A hash table from voxels to cells: open addressing in two flat arrays, so that a look-up is one or two cache lines
// and a walk over all cells has a fixed order.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace pllit {

/// Integer voxel coordinates packed into 64 bits, 21 bits an axis (a million voxels to each side of the origin);
/// coordinates beyond wrap around, which a map that slides with the robot never notices.
using VoxelKey = std::uint64_t;

inline VoxelKey voxel_key(const Eigen::Vector3i& voxel) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  const auto bits = [](int i) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(i)) & mask; };
  return bits(voxel.x()) << 42 | bits(voxel.y()) << 21 | bits(voxel.z());
}

inline Eigen::Vector3i voxel_of_key(VoxelKey key) {
  const auto coordinate = [key](int shift) {
    return static_cast<int>(static_cast<std::int64_t>(key >> shift << 43) >> 43);  // sign-extends 21 bits
  };
  return {coordinate(42), coordinate(21), coordinate(0)};
}

template <class Vector>
Eigen::Vector3i voxel_of(const Vector& point, double inverse_size) {
  return {static_cast<int>(std::floor(static_cast<double>(point.x()) * inverse_size)),
          static_cast<int>(std::floor(static_cast<double>(point.y()) * inverse_size)),
          static_cast<int>(std::floor(static_cast<double>(point.z()) * inverse_size))};
}

template <class Cell>
class VoxelTable {
 public:
  VoxelTable() { allocate(1024); }

  const Cell* find(VoxelKey key) const {
    for (std::size_t i = slot(key); keys_[i] != empty; i = (i + 1) & mask_)
      if (keys_[i] == key) return &cells_[i];
    return nullptr;
  }

  /// The cell of a voxel, made if absent; second: whether it was made.
  std::pair<Cell*, bool> insert(VoxelKey key) {
    if (2 * (size_ + 1) > keys_.size()) rebuild(2 * keys_.size(), [](VoxelKey, const Cell&) { return true; });
    std::size_t i = slot(key);
    for (; keys_[i] != empty; i = (i + 1) & mask_)
      if (keys_[i] == key) return {&cells_[i], false};
    keys_[i] = key;
    cells_[i] = Cell{};
    ++size_;
    return {&cells_[i], true};
  }

  /// Keeps only the cells for which keep(key, cell) holds.
  template <class Keep>
  void retain(const Keep& keep) {
    rebuild(keys_.size(), keep);
  }

  /// Takes out one cell, if it is there.
  void erase(VoxelKey key) {
    for (std::size_t i = slot(key); keys_[i] != empty; i = (i + 1) & mask_)
      if (keys_[i] == key) return erase_slot(i);
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < keys_.size(); ++i)
      if (keys_[i] != empty) visit(keys_[i], cells_[i]);
  }

  void clear() { allocate(1024); }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return keys_.capacity() * (sizeof(VoxelKey) + sizeof(Cell)); }

 private:
  static constexpr VoxelKey empty = ~VoxelKey{0};  // a packed key has 63 bits

  std::size_t slot(VoxelKey key) const {
    key ^= key >> 32;  // mixing steps of the finaliser of SplitMix64
    key *= 0x9e3779b97f4a7c15ULL;
    key ^= key >> 29;
    return key & mask_;
  }

  /// Cells further on that could have stood in the hole move up, so that no search ends early.
  void erase_slot(std::size_t hole) {
    for (std::size_t i = (hole + 1) & mask_; keys_[i] != empty; i = (i + 1) & mask_) {
      if (((i - slot(keys_[i])) & mask_) < ((i - hole) & mask_)) continue;
      keys_[hole] = keys_[i];
      cells_[hole] = cells_[i];
      hole = i;
    }
    keys_[hole] = empty;
    --size_;
  }

  void allocate(std::size_t capacity) {
    keys_.assign(capacity, empty);
    cells_.assign(capacity, Cell{});
    mask_ = capacity - 1;
    size_ = 0;
  }

  template <class Keep>
  void rebuild(std::size_t capacity, const Keep& keep) {
    const auto keys = std::move(keys_);
    const auto cells = std::move(cells_);
    allocate(capacity);
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] != empty && keep(keys[i], cells[i])) *insert(keys[i]).first = cells[i];
  }

  std::vector<VoxelKey> keys_;
  std::vector<Cell> cells_;
  std::size_t mask_ = 0, size_ = 0;
};

}  // namespace pllit
