// Point clouds as binary PCD 0.7 (Point Cloud Library); scalar fields are float fields under their own names.
#pragma once

#include <filesystem>

#include "pllit/base/error.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

/// Writes a whole cloud. Fails on a full disk and on a table that check_field_names or check_points refuses.
Expected<void> write_pcd(const std::filesystem::path& path, const PointTable& table);

}  // namespace pllit
