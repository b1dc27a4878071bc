#include "pllit/io/reading_tally.hpp"

#include <format>
#include <utility>

namespace pllit {
namespace {

constexpr std::size_t kMostBadAtStart = 20;

}  // namespace

bool ReadingTally::add_bad(const std::string& topic, const std::string& reason) {
  Messages& messages = messages_[topic];
  if (messages.bad++ == 0) messages.first_reason = reason;
  return messages.good > 0 || messages.bad < kMostBadAtStart;
}

void ReadingTally::add_scan(const DecodedScan& decoded) {
  kept_points_ += decoded.scan.points_L.size();
  dropped_.not_finite += decoded.dropped.not_finite;
  dropped_.zero += decoded.dropped.zero;
  dropped_.bad_time += decoded.dropped.bad_time;
  dropped_.noise += decoded.dropped.noise;
  scans_without_time_ += !decoded.has_time && !decoded.scan.points_L.empty() ? 1 : 0;
  scans_with_other_clock_ += decoded.clocks_differ ? 1 : 0;
}

std::vector<std::string> ReadingTally::notes(const std::string& lidar_topic) const {
  std::vector<std::string> notes;
  const auto note_if = [&](std::size_t count, std::string text) {
    if (count > 0) notes.push_back(std::move(text));
  };
  for (const auto& [topic, messages] : messages_) {
    note_if(messages.bad, std::format("{}: {} of {} messages skipped. The first: {}", topic, messages.bad,
                                      messages.bad + messages.good, messages.first_reason));
  }
  note_if(
      dropped_.not_finite + dropped_.zero + dropped_.bad_time + dropped_.noise,
      std::format("{}: {} points kept; dropped: {} missing returns at (0, 0, 0), {} not finite, {} without valid time, "
                  "{} tagged as noise",
                  lidar_topic, kept_points_, dropped_.zero, dropped_.not_finite, dropped_.bad_time, dropped_.noise));
  note_if(scans_without_time_,
          std::format("{}: {} scans carry no usable point time; they cannot be corrected for motion during the sweep",
                      lidar_topic, scans_without_time_));
  note_if(scans_with_other_clock_,
          std::format("{}: {} scans have point times over 1 s from their header stamp; the header stamp was used",
                      lidar_topic, scans_with_other_clock_));
  note_if(unstamped_, std::format("{} messages have no header stamp; the time received was used", unstamped_));
  note_if(out_of_order_, std::format("{} messages were received before one that comes earlier", out_of_order_));
  return notes;
}

}  // namespace pllit
