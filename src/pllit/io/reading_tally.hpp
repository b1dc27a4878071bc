// What reading a recording met with and survived, for its notes.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pllit/io/decoded_scan.hpp"

namespace pllit {

class ReadingTally {
 public:
  void add_good(const std::string& topic) { ++messages_[topic].good; }
  /// False once the topic has given 20 bad messages and not one good: it cannot be read.
  bool add_bad(const std::string& topic, const std::string& reason);
  void add_scan(const DecodedScan& decoded);
  void add_unstamped() { ++unstamped_; }
  void add_out_of_order() { ++out_of_order_; }

  const std::string& first_reason(const std::string& topic) { return messages_[topic].first_reason; }

  /// In words; scans are named by `lidar_topic`.
  std::vector<std::string> notes(const std::string& lidar_topic) const;

 private:
  struct Messages {
    std::size_t good = 0;
    std::size_t bad = 0;
    std::string first_reason;
  };
  std::map<std::string, Messages> messages_;
  std::size_t kept_points_ = 0;
  DroppedPoints dropped_;
  std::size_t scans_without_time_ = 0;
  std::size_t scans_with_other_clock_ = 0;
  std::size_t unstamped_ = 0;
  std::size_t out_of_order_ = 0;
};

}  // namespace pllit
