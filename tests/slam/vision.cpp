// What images do to the odometry, on a corridor that a LiDAR cannot see along.
#include "pllit/slam/vision.hpp"

#include <gtest/gtest.h>

#include "pllit/slam/odometry.hpp"
#include "support/simulated_run.hpp"

namespace pllit {
namespace {

const std::string kCorridor = "sim:corridor?rig=hilti2022&bare=1&duration=12&seed=5";

Config without_images() {
  Config config;
  config.vision.enabled = false;
  return config;
}

/// The distance between the true and the estimated way from the first frame to the last.
double error_m(const test::SimulatedRun& run) {
  return test::relative_error_W(run, run.frames.front(), run.frames.back()).tail<3>().norm();
}

TEST(Vision, HoldsTheAxisOfACorridorThatTheLidarCannotSeeAlong) {
  const auto blind = test::run_simulation(kCorridor, without_images());
  const auto seeing = test::run_simulation(kCorridor);
  ASSERT_TRUE(blind.result && seeing.result);
  RecordProperty("without_images_m", std::to_string(error_m(blind)));
  RecordProperty("with_images_m", std::to_string(error_m(seeing)));
  EXPECT_LT(error_m(seeing), 0.5 * error_m(blind));
  EXPECT_LT(error_m(seeing), 0.15);
  EXPECT_GT(blind.summary.count(HealthState::degraded), static_cast<int>(blind.frames.size()) / 2);
  EXPECT_LT(seeing.summary.count(HealthState::degraded), static_cast<int>(seeing.frames.size()) / 10);
  const Vector6 sigma = seeing.frames.back().pose_covariance().diagonal().cwiseSqrt();
  EXPECT_LT(error_m(seeing), 4.0 * sigma.tail<3>().norm()) << "and knows how well";
}

TEST(Vision, FindsOutByHowMuchTheCamerasClockIsOff) {
  using namespace std::chrono_literals;
  for (const Duration early : {6ms, -6ms}) {
    const auto run = test::run_simulation("sim:room?rig=hilti2022&duration=10&seed=6&ideal=1", {}, early);
    ASSERT_TRUE(run.result && run.summary.mount);
    const double delay_s = run.summary.mount->mean.delay_s;
    const double sigma_s = std::sqrt(run.summary.mount->covariance(mount_index::delay, mount_index::delay));
    EXPECT_NEAR(delay_s, -to_seconds(early), 0.0015);
    EXPECT_LT(std::abs(delay_s + to_seconds(early)), 4.0 * sigma_s);
    EXPECT_LT(sigma_s, 0.001);
    EXPECT_LT(error_m(run), 0.02);
  }
}

/// A simulation whose images show nothing.
class Blank : public EventSource {
 public:
  explicit Blank(Simulation& simulation) : simulation_(simulation) {}
  Expected<std::optional<SensorEvent>> next() override {
    auto event = simulation_.next();
    if (event && *event)
      if (auto* image = std::get_if<CameraFrame>(&(*event)->data)) image->counts = cv::Mat::zeros(540, 720, CV_8UC1);
    return event;
  }

 private:
  Simulation& simulation_;
};

/// Poses of all frames; with or without looking at the images, cut at them in either case.
Trajectory poses_of(EventSource& source, const Rig& rig, std::unique_ptr<Vision> vision, const Config& config = {}) {
  PacketAssembler assembler(rig, {.images = true});
  Odometry odometry(rig, config, std::move(vision));
  Trajectory poses;
  const auto take = [&](std::optional<SensorPacket> packet) {
    if (!packet) return false;
    const auto frames = odometry.process(std::move(*packet));
    EXPECT_TRUE(frames);
    for (const FrameEstimate& frame : *frames)
      poses.push_back({frame.posterior.mean.time, frame.posterior.mean.T_W_I()});
    return true;
  };
  while (auto event = *source.next()) {
    std::visit([&](auto& data) { assembler.push(std::move(data)); }, event->data);
    while (take(assembler.pop())) {
    }
  }
  while (take(assembler.flush())) {
  }
  return poses;
}

TEST(Vision, LeavesTheTrajectoryOfBlankImagesAsItIsWithoutAny) {
  const std::string address = "sim:room?rig=hilti2022&duration=6&seed=6";
  auto seen = open_simulation(address), unseen = open_simulation(address);
  Blank blank(*seen), blank_too(*unseen);
  const Rig rig = seen->rig();
  auto vision = make_vision(rig, {});
  ASSERT_TRUE(vision && *vision);
  const Trajectory with = poses_of(blank, rig, std::move(*vision)), without = poses_of(blank_too, rig, nullptr);
  ASSERT_EQ(with.size(), without.size());
  ASSERT_GT(with.size(), 50U);
  for (std::size_t i = 0; i < with.size(); ++i)
    EXPECT_LT((with[i].T_W_I.translation() - without[i].T_W_I.translation()).norm(), 1e-9);
}

TEST(Vision, GivesTheSameTrajectoryOnOneThreadAsOnThree) {
  const auto poses_on = [](int threads) {
    auto simulation = open_simulation("sim:room?rig=hilti2022&duration=5&seed=7");
    const Rig rig = simulation->rig();
    Config config;
    config.threads = threads;
    return poses_of(*simulation, rig, *make_vision(rig, config.vision), config);
  };
  const Trajectory one = poses_on(1), three = poses_on(3);
  ASSERT_EQ(one.size(), three.size());
  ASSERT_GT(one.size(), 30U);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].T_W_I.coeffs(), three[i].T_W_I.coeffs()) << i;
}

TEST(Vision, SeesExplicitLinesOfTheMapAgain) {
  Config config, without_lines;
  without_lines.vision.residuals.lines = false;
  const auto with = test::run_simulation("sim:room?rig=hilti2022&duration=10&seed=6", config),
             without = test::run_simulation("sim:room?rig=hilti2022&duration=10&seed=6", without_lines);
  ASSERT_TRUE(with.result && without.result);
  const auto sees_lines = [](const FrameEstimate& frame) { return frame.facts.image.lines > 2; };
  EXPECT_GT(std::ranges::count_if(with.frames, sees_lines), std::ssize(with.frames) / 4);
  EXPECT_EQ(std::ranges::count_if(without.frames, sees_lines), 0);
  EXPECT_LT(error_m(with), std::max(1.2 * error_m(without), 0.02));
}

TEST(Vision, RefusesImagesOfAnotherSizeThanCalibrated) {
  auto simulation = open_simulation("sim:room?rig=hilti2022&duration=3&seed=6");
  Rig rig = simulation->rig();
  rig.camera->width = 640;
  RunSummary summary;
  const auto result =
      run_odometry(*simulation, rig, {}, {.sink = [](const FrameEstimate&) -> Expected<void> { return {}; }}, summary);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("720 x 540"), std::string::npos) << result.error().message;
}

TEST(Vision, NamesTheNetworkFileThatIsMissing) {
  auto simulation = open_simulation("sim:room?rig=hilti2022&duration=3&seed=6");
  VisionConfig config;
  config.model = "nowhere/pl_net.onnx";
  const auto vision = make_vision(simulation->rig(), config);
  ASSERT_FALSE(vision);
  EXPECT_NE(vision.error().message.find("nowhere/pl_net.onnx"), std::string::npos) << vision.error().message;
}

}  // namespace
}  // namespace pllit
