#include "pllit/slam/run.hpp"

#include <algorithm>
#include <format>

namespace pllit {
namespace {

class Run {
 public:
  Run(EventSource& source, const Rig& rig, const Config& config, std::unique_ptr<Vision> vision, const RunHooks& hooks,
      RunSummary& summary)
      : source_(source),
        hooks_(hooks),
        summary_(summary),
        assembler_(rig, {.images = vision != nullptr, .image_spacing = config.vision.image_spacing}),
        rig_(rig),
        odometry_(rig, config, std::move(vision)) {}

  Expected<void> to_the_end() {
    while (!hooks_.stop.stop_requested()) {
      StageClock clock;
      auto event = source_.next();
      if (!event) {
        const auto rest = drain(true);
        return rest ? std::unexpected(event.error()) : rest;
      }
      if (!*event) return drain(true);
      if (auto* imu = std::get_if<ImuSample>(&(*event)->data)) assembler_.push(*imu);
      if (auto* scan = std::get_if<LidarScan>(&(*event)->data)) assembler_.push(std::move(*scan));
      if (auto* image = std::get_if<CameraFrame>(&(*event)->data)) assembler_.push(std::move(*image));
      clock.charge(Stage::read);
      read_ms_ += clock.times_ms()[static_cast<std::size_t>(Stage::read)];
      if (const auto done = drain(false); !done) return done;
      hooks_.progress(source_.progress());
    }
    summary_.interrupted = true;
    return {};
  }

  void finish() {
    note_counts();
    for (std::string& text : source_.notes()) note(std::move(text));
    summary_.start = odometry_.start();
  }

 private:
  Expected<void> drain(bool all) {
    while (auto packet = all ? assembler_.flush() : assembler_.pop()) {
      ++packets_;
      auto frames = odometry_.process(std::move(*packet));
      if (!frames) return std::unexpected(frames.error());
      for (FrameEstimate& frame : *frames)
        if (const auto taken = take(frame); !taken) return taken;
      if (hooks_.stop.stop_requested()) break;
    }
    if (all && !hooks_.stop.stop_requested() && !odometry_.start()) return never_started();
    return {};
  }

  Expected<void> never_started() const {
    if (packets_ == 0) return input_error("no scan with points came; check the LiDAR topic with `pllit doctor`");
    return input_error(
        std::format("the recording ended before the odometry could start ({} scans); it needs more than a second of "
                    "scans with IMU data",
                    packets_));
  }

  Expected<void> take(FrameEstimate& frame) {
    frame.stage_ms[static_cast<std::size_t>(Stage::read)] = std::exchange(read_ms_, 0.0);
    map_heat(frame);
    add_to_summary(frame);
    return hooks_.sink(frame);
  }

  void map_heat(FrameEstimate& frame) {
    if (!hooks_.thermography || !frame.image) return;
    StageClock clock;
    if (auto input = thermography_input(frame, rig_, odometry_.map())) hooks_.thermography->process(*input);
    clock.charge(Stage::map);
    frame.stage_ms[static_cast<std::size_t>(Stage::map)] += clock.times_ms()[static_cast<std::size_t>(Stage::map)];
  }

  void add_to_summary(const FrameEstimate& frame) {
    const NavState& state = frame.posterior.mean;
    if (summary_.frames == 0) first_time_ = state.time;
    if (summary_.frames > 0) summary_.length_m += (state.p_W - last_p_W_).norm();
    last_p_W_ = state.p_W;
    summary_.duration_s = to_seconds(state.time - first_time_);
    ++summary_.frames;
    ++summary_.health[static_cast<std::size_t>(frame.health.state)];
    summary_.final_state = frame.health.state;
    if (frame.mount) summary_.mount = frame.mount;
    double total_ms = 0.0;
    for (std::size_t i = 0; i < stage_names.size(); ++i) {
      summary_.stage_ms[i].add(frame.stage_ms[i]);
      total_ms += frame.stage_ms[i];
    }
    summary_.frame_ms.add(total_ms);
  }

  void note(std::string text) {
    if (!std::ranges::contains(summary_.notes, text)) summary_.notes.push_back(std::move(text));
  }

  void note_counts() {
    const AssemblerCounts& counts = assembler_.counts();
    const auto tell = [this](int count, std::string_view what) {
      if (count > 0) note(std::format("{} {}", count, what));
    };
    tell(counts.imu_not_finite, "IMU samples were not finite and were dropped");
    tell(counts.imu_not_ascending, "IMU samples were duplicates or stepped back in time and were dropped");
    tell(counts.scans_too_late, "scans were duplicates, late or stepped back in time and were dropped");
    tell(counts.scans_empty, "scans held no points");
    tell(counts.images_too_late, "images were duplicates, late or stepped back in time and were dropped");
  }

  EventSource& source_;
  const RunHooks& hooks_;
  RunSummary& summary_;
  PacketAssembler assembler_;
  const Rig& rig_;
  Odometry odometry_;
  Time first_time_;
  Vector3d last_p_W_ = Vector3d::Zero();
  double read_ms_ = 0.0;
  int packets_ = 0;
};

}  // namespace

std::string RunSummary::doubts() const {
  std::string text;
  const auto add = [&text](const std::string& doubt) { text += (text.empty() ? "" : "; ") + doubt; };
  const int lost = count(HealthState::lost), degraded = count(HealthState::degraded);
  if (lost > 0) add(std::format("lost in {} of {} frames", lost, frames));
  if (10 * degraded > frames) add(std::format("degraded in {} of {} frames, more than a tenth", degraded, frames));
  if (final_state != HealthState::good) add(std::format("{} at the end", name_of(final_state)));
  return text;
}

Expected<void> run_odometry(EventSource& source, const Rig& rig, const Config& config, const RunHooks& hooks,
                            RunSummary& summary) {
  const auto begin = std::chrono::steady_clock::now();
  auto vision = make_vision(rig, config.vision);
  if (!vision) return std::unexpected(vision.error());
  Run run(source, rig, config, std::move(*vision), hooks, summary);
  const auto result = run.to_the_end();
  run.finish();
  summary.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace pllit
