// Any bytes are a scan that keeps its promises, or an input error.
#include <cstdint>

#include "pllit/io/point_cloud2.hpp"
#include "scan_invariants.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pllit;
  const Bytes message = std::as_bytes(std::span(data, size));
  for (const auto unit : {std::optional<TimeUnit>(), std::optional(TimeUnit::microseconds)}) {
    for (const bool stamp_at_scan_end : {false, true}) {
      const auto decoded = decode_point_cloud2(message, {.time_unit = unit, .stamp_at_scan_end = stamp_at_scan_end});
      if (decoded) fuzz::check_invariants(decoded->scan);
      fuzz::require(decoded || (decoded.error().kind == Error::Kind::input && !decoded.error().message.empty()));
    }
  }
  return 0;
}
