// Any file is a recording that ends, or an error.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pllit;
  const auto path = std::filesystem::temp_directory_path() / ("pllit_fuzz_" + std::to_string(getpid()) + ".bag");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  static_cast<void>(describe_bags({path}));
  if (auto source = open_bags({path})) {
    for (auto event = (*source)->next(); event && *event; event = (*source)->next()) {
    }
    static_cast<void>((*source)->notes());
  }
  std::filesystem::remove(path);
  return 0;
}
