#include "pllit/slam/loop_stage.hpp"

#include <chrono>

namespace pllit {
namespace {

constexpr std::size_t kMostWaiting = 20;  // frames

}  // namespace

LoopStage::LoopStage(const LoopConfig& config)
    : config_(config), maker_(config.keyframes), closer_(config), thread_([this] { work(); }) {}

LoopStage::~LoopStage() {
  if (!thread_.joinable()) return;
  close_queue();
  thread_.join();
}

void LoopStage::close_queue() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void LoopStage::take(const FrameEstimate& frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kMostWaiting; });
  waiting_.push_back(frame);
  changed_.notify_all();
}

void LoopStage::work() {
  while (true) {
    FrameEstimate frame;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      frame = std::move(waiting_.front());
      waiting_.pop_front();
      changed_.notify_all();
    }
    take_in(frame);
  }
}

void LoopStage::take_in(const FrameEstimate& frame) try {
  if (!stopped_.empty()) return;
  const auto begin = std::chrono::steady_clock::now();
  if (auto keyframe = maker_.take(frame)) closer_.add(std::move(*keyframe));
  frame_ms_.add(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
} catch (const std::exception& problem) {  // the solver's: a graph it cannot solve must not end the odometry
  stopped_ = problem.what();
}

LoopResult LoopStage::finish() {
  close_queue();
  thread_.join();
  if (stopped_.empty()) try {
      closer_.finish();
    } catch (const std::exception& problem) {
      stopped_ = problem.what();
    }
  LoopResult result{
      .records = closer_.records(), .accepted = closer_.accepted(), .frame_ms = frame_ms_, .stopped = stopped_};
  if (result.closed()) result.correction = correction();
  return result;
}

Correction LoopStage::correction() const {
  std::vector<MovedKeyframe> moved;
  for (std::size_t k = 0; k < closer_.keyframes().size(); ++k)
    moved.push_back({closer_.keyframes()[k].time, closer_.keyframes()[k].T_O_I, closer_.poses_M()[k]});
  return Correction(std::move(moved));
}

}  // namespace pllit
