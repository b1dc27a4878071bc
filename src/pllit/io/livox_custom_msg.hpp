// Decoding of livox_ros_driver/CustomMsg and livox_ros_driver2/CustomMsg, which are laid out alike.
#pragma once

#include "pllit/base/error.hpp"
#include "pllit/io/byte_reader.hpp"
#include "pllit/io/decoded_scan.hpp"

namespace pllit {

/// Decodes one serialised message. Metres in L; intensity is the reflectivity, 0 to 255. Missing returns (0, 0, 0) go,
/// and so do third returns and points tagged as noise with high confidence (tag byte, Livox user manuals): the tag's
/// first two return numbers and its less certain noise classes stay. Times count from `timebase`, the time of the first
/// point; where it is zero or over a second from the header stamp the driver had no common clock, and the header stamp
/// is the start. Errors: a message that is cut short or laid out differently.
Expected<DecodedScan> decode_livox_custom_msg(Bytes message);

}  // namespace pllit
