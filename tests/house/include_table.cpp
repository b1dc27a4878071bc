// Who may include whom: docs/ARCHITECTURE.md, checked on every #include "pllit/x/...".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Folders that each folder may include, itself apart.
const std::map<std::string, std::set<std::string>> table{
    {"base", {}},
    {"geometry", {"base"}},
    {"sensor", {"base", "geometry"}},
    {"state", {"base", "geometry", "sensor"}},
    {"lidar", {"base", "geometry", "sensor", "state"}},
    {"thermal", {"base", "geometry", "sensor", "state"}},
    {"map", {"base", "geometry", "sensor", "state"}},
    {"loop", {"base", "geometry", "sensor", "state"}},
    {"slam", {"base", "geometry", "sensor", "state", "lidar", "thermal", "map", "loop"}},
    {"io", {"base", "geometry", "sensor", "state"}},
    {"sim", {"base", "geometry", "sensor", "state"}},
    {"eval", {"base", "geometry", "sensor", "state"}},
    {"report", {"base", "geometry", "sensor", "state", "lidar", "thermal", "map", "loop", "slam", "eval"}},
};

std::vector<std::string> included_folders(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> folders;
  const std::regex pattern(R"re(^\s*#\s*include\s*"pllit/([a-z_]+)/)re");
  for (std::string line; std::getline(stream, line);)
    if (std::smatch match; std::regex_search(line, match, pattern)) folders.push_back(match[1]);
  return folders;
}

TEST(House, NoFolderIncludesOneThatItsArrowsDoNotAllow) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PLLIT_SOURCE_DIR) / "src/pllit")) {
    if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
    ++files;
    // The first folder below pllit/ counts: a room may have alcoves of its own.
    const std::string folder =
        entry.path().lexically_relative(fs::path(PLLIT_SOURCE_DIR) / "src/pllit").begin()->string();
    ASSERT_TRUE(table.contains(folder)) << folder << " has no row in the table";
    for (const std::string& other : included_folders(entry.path()))
      EXPECT_TRUE(other == folder || table.at(folder).contains(other))
          << entry.path().filename() << " in " << folder << "/ includes " << other << "/";
  }
  EXPECT_GT(files, 60);
}

TEST(House, RosHeadersStayOutOfTheProgram) {
  const std::regex ros(R"(#\s*include\s*[<"](ros|rosbag|sensor_msgs|std_msgs|topic_tools)/)");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PLLIT_SOURCE_DIR) / "src")) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_FALSE(std::regex_search(text, ros)) << entry.path();
  }
}

TEST(House, GtsamStaysInsideLoopClosing) {
  const std::regex gtsam(R"(#\s*include\s*[<"]gtsam/)");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PLLIT_SOURCE_DIR) / "src/pllit")) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!std::regex_search(text, gtsam)) continue;
    EXPECT_EQ(entry.path().parent_path().filename(), "loop") << entry.path();
    EXPECT_TRUE(entry.path().extension() == ".cpp" || entry.path().filename() == "gtsam_factors.hpp") << entry.path();
  }
}

TEST(House, FilesStaySmallEnoughToRead) {
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PLLIT_SOURCE_DIR) / "src")) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path());
    int lines = 0;
    for (std::string line; std::getline(stream, line);) ++lines;
    EXPECT_LE(lines, 300) << entry.path();
  }
}

}  // namespace
