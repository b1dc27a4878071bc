// Decoding of sensor_msgs/PointCloud2, by field name, datatype and offset.
#pragma once

#include <optional>

#include "pllit/base/error.hpp"
#include "pllit/io/byte_reader.hpp"
#include "pllit/io/decoded_scan.hpp"
#include "pllit/io/point_time.hpp"

namespace pllit {

struct PointCloudOptions {
  std::optional<TimeUnit> time_unit{};  ///< nothing: found from the span of the scan
  bool stamp_at_scan_end = false;       ///< the header stamp of offsets that count from 0 is the end of the sweep
};

/// Decodes one serialised message. Metres in L. Needs fields x, y, z of any number type; intensity (or reflectivity,
/// else zeros) and point time (time, t, timestamp, offset_time, ...) are optional. Organised clouds, padding and
/// big-endian data are read as they come. Point times never pass through float32 unless recorded so: they become
/// integer nanoseconds straight from the recorded number. Errors: truncated or inconsistent messages, and those of
/// find_time_layout().
Expected<DecodedScan> decode_point_cloud2(Bytes message, const PointCloudOptions& options = {});

}  // namespace pllit
