// Point clouds as LAS 1.4 (ASPRS), for surveyors; scalar fields are "extra bytes" of type float under their own names.
#pragma once

#include <filesystem>

#include "pllit/base/error.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

/// Writes a whole cloud, point format 0, without a coordinate reference system. Coordinates are rounded to 0.1 mm, or
/// to the next power of ten that still spans the cloud. The creation date stays zero, so that equal clouds give equal
/// files. Fails on a full disk, on a table that check_field_names or check_points refuses, on more than 341 scalar
/// fields and on more than 2^32 - 1 points.
Expected<void> write_las(const std::filesystem::path& path, const PointTable& table);

}  // namespace pllit
