// Any bytes are a scan that keeps its promises, or an input error.
#include <cstdint>

#include "pllit/io/livox_custom_msg.hpp"
#include "scan_invariants.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pllit;
  const auto decoded = decode_livox_custom_msg(std::as_bytes(std::span(data, size)));
  if (decoded) fuzz::check_invariants(decoded->scan);
  fuzz::require(decoded || (decoded.error().kind == Error::Kind::input && !decoded.error().message.empty()));
  return 0;
}
