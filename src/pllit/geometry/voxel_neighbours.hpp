// Voxels around a voxel, and voxels that hang together.
#pragma once

#include <map>
#include <vector>

#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

/// Calls visit(key) for the voxels at most `reach` away along each axis, the voxel itself among them; x runs fastest.
template <class Visit>
void for_neighbours(VoxelKey key, int reach, const Visit& visit) {
  const Eigen::Vector3i centre = voxel_of_key(key);
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) visit(voxel_key(centre + Eigen::Vector3i(x, y, z)));
}

/// The cells in groups of neighbours, of which joined(first of the group, cell) holds.
template <class Cell, class Joined>
std::vector<std::vector<Cell>> connected(std::map<VoxelKey, Cell> cells, const Joined& joined) {
  std::vector<std::vector<Cell>> groups;
  while (!cells.empty()) {
    std::vector<Cell> group;
    std::vector<VoxelKey> open{cells.begin()->first};
    while (!open.empty()) {
      const auto found = cells.find(open.back());
      open.pop_back();
      if (found == cells.end() || !(group.empty() || joined(group.front(), found->second))) continue;
      const VoxelKey key = found->first;
      group.push_back(std::move(found->second));
      cells.erase(found);
      for_neighbours(key, 1, [&](VoxelKey next) {
        if (cells.contains(next)) open.push_back(next);
      });
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace pllit
