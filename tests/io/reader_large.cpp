// A recording larger than the memory that reading it may take.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "pllit/io/bag_reader.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;

constexpr int kFrames = 2050;  // of 1 MiB each
constexpr int kImuSamples = 200'000;
constexpr rlim_t kAddressSpace = rlim_t{600} << 20;
constexpr long kLargestGrowth_KiB = 200 * 1024;

/// Messages of a recording of 2 GiB: large images and very many small messages.
void write_large_bag(const std::filesystem::path& path) {
  auto writer = BagWriter::create(path);
  ASSERT_TRUE(writer) << writer.error().message;
  const Time start(1000s);
  const LidarScan scan{start, {{1, 2, 3}}, {0ns}, {1}};
  ASSERT_TRUE(writer->write_scan("/points", start, scan));
  CameraFrame frame{start, cv::Mat(1024, 512, CV_16UC1, cv::Scalar(7000))};
  for (int i = 0; i < kImuSamples; ++i) {
    const Time time = start + i * 1ms;
    ASSERT_TRUE(writer->write_imu("/imu", time, {time, {}, {0, 0, 9.81}}));
    if (i % (kImuSamples / kFrames) != 0 || i / (kImuSamples / kFrames) >= kFrames) continue;
    frame.time = time;
    ASSERT_TRUE(writer->write_image("/image", time, frame));
  }
  ASSERT_TRUE(writer->close());
}

long peak_KiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// In a process of its own, whose address space is limited: 0 where all was read within the limits.
int read_within_limits(const std::filesystem::path& path) {
  const rlimit limit{kAddressSpace, kAddressSpace};
  if (setrlimit(RLIMIT_AS, &limit) != 0) return 10;
  const long before_KiB = peak_KiB();
  auto source = open_bags({path});
  if (!source) return 11;
  int events = 0;
  for (auto event = (*source)->next(); event && *event; event = (*source)->next()) ++events;
  if (events != kImuSamples + kFrames + 1) return 12;
  return peak_KiB() - before_KiB < kLargestGrowth_KiB ? 0 : 13;
}

TEST(LargeRecording, IsReadInLittleMemory) {
  const test::TemporaryFolder folder;
  if (std::filesystem::space(folder / "").available < (std::uintmax_t{3} << 30)) {
    GTEST_SKIP() << "the temporary folder has less than 3 GiB left";
  }
  const auto path = folder / "large.bag";
  write_large_bag(path);
  ASSERT_GT(std::filesystem::file_size(path), std::uintmax_t{2} << 30);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) _exit(read_within_limits(path));
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace pllit
