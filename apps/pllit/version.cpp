#include <format>

#include "program.hpp"
#include "version_text.hpp"

namespace pllit::app {

Version version() { return {.number = PLLIT_VERSION, .commit = PLLIT_COMMIT}; }

std::string version_line() {
  const auto [number, commit] = version();
  return std::format("pllit {} ({})", number, commit.empty() ? "not built from a git repository" : commit);
}

}  // namespace pllit::app
