// Finds the recordings that tests use: $PLLIT_DATA, or ../shared/data beside the project.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

namespace pllit::test {

/// Path of a recording, or nothing where it is absent (the test then skips, by name).
inline std::optional<std::filesystem::path> recording(std::string_view relative) {
  const char* folder = std::getenv("PLLIT_DATA");
  const auto project = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  const auto path = (folder ? std::filesystem::path(folder) : project.parent_path() / "shared/data") / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace pllit::test

/// Skips the running test, naming the recording it misses; otherwise declares `variable` with its path.
#define PLLIT_RECORDING(variable, relative)                                                    \
  const auto variable##_found = pllit::test::recording(relative);                              \
  if (!variable##_found) GTEST_SKIP() << "recording absent: " << relative << " ($PLLIT_DATA)"; \
  const std::filesystem::path variable = *variable##_found
