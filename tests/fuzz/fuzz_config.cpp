// Any text is a configuration or an input error; a configuration survives its dump.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pllit/slam/config_yaml.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto config = pllit::load_config(text, "fuzz")) {
    const auto again = pllit::load_config(pllit::dump_config(*config), "dump");
    if (!again || !(*again == *config)) std::abort();
    pllit::make_rig(config->rig);
  } else if (config.error().kind != pllit::Error::Kind::input || config.error().message.empty()) {
    std::abort();
  }
  (void)pllit::apply_setting({}, text);
  return 0;
}
