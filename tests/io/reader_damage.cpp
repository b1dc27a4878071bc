// Damaged recordings: whatever is in the file, reading ends, in an error or in what could be saved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_reader.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit {
namespace {

using test::contents;
using test::sample_events;
using test::TemporaryFolder;
using test::write_bag;
using test::write_contents;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;

struct Reading {
  bool opened = false;
  std::size_t events = 0;
  std::vector<std::string> notes;
};

Reading read_all(const std::filesystem::path& path) {
  Reading reading;
  auto source = open_bags({path});
  if (!source) {
    EXPECT_EQ(source.error().kind, Error::Kind::input);
    EXPECT_FALSE(source.error().message.empty());
    return reading;
  }
  reading.opened = true;
  for (auto event = (*source)->next(); event && *event; event = (*source)->next()) ++reading.events;
  reading.notes = (*source)->notes();
  return reading;
}

class DamagedBag : public testing::Test {
 protected:
  void SetUp() override {
    write_bag(folder_ / "whole.bag", events_, kChunkBytes);
    bytes_ = contents(folder_ / "whole.bag");
  }
  Reading read_damaged(const std::vector<char>& bytes) const {
    write_contents(folder_ / "damaged.bag", bytes);
    return read_all(folder_ / "damaged.bag");
  }
  /// Position of the index that a whole bag ends with.
  std::size_t index_position() const {
    const std::string_view text(bytes_.data(), bytes_.size());
    std::uint64_t position = 0;
    std::memcpy(&position, bytes_.data() + text.find("index_pos=") + 10, sizeof(position));
    return position;
  }

  TemporaryFolder folder_;
  static constexpr std::size_t kChunkBytes = 50'000;  // ten chunks
  std::vector<SensorEvent> events_ = sample_events({.duration_s = 10.0});
  std::vector<char> bytes_;
};

TEST_F(DamagedBag, GivesEveryMessageWhereOnlyTheIndexIsMissing) {
  std::vector<char> cut = bytes_;
  cut.resize(index_position());
  const Reading reading = read_damaged(cut);
  EXPECT_EQ(reading.events, events_.size());
  EXPECT_THAT(reading.notes, Contains(HasSubstr("has no complete index")));
}

TEST_F(DamagedBag, GivesWhatARecorderLeftThatWasKilled) {
  // A recorder writes its last chunk's header with sizes of zero and fills them in when the chunk is full.
  const std::string_view text(bytes_.data(), bytes_.size());
  std::size_t last_chunk = 0;
  for (std::size_t at = text.find("compression=none"); at < index_position();
       at = text.find("compression=none", at + 1)) {
    last_chunk = at;
  }
  std::vector<char> killed(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(last_chunk + 25'000));
  const std::size_t size_field = text.find("size=", last_chunk) + 5;
  const std::size_t data_length = size_field + 4;
  ASSERT_LT(data_length - last_chunk, 40u);
  std::memset(killed.data() + size_field, 0, 8);  // uncompressed size, then the length of the data
  std::memset(killed.data() + text.find("index_pos=") + 10, 0, 8);
  const Reading reading = read_damaged(killed);
  const Reading up_to_there = [&] {
    std::vector<char> cut(killed.begin(), killed.begin() + static_cast<std::ptrdiff_t>(last_chunk - 20));
    return read_damaged(cut);
  }();
  EXPECT_GT(reading.events, up_to_there.events + 50);
  EXPECT_LT(reading.events, events_.size());
}

TEST_F(DamagedBag, LosesNoMoreThanWhatWasCutOff) {
  std::mt19937 random(5);
  for (int i = 0; i < 60; ++i) {
    std::vector<char> cut = bytes_;
    cut.resize(std::uniform_int_distribution<std::size_t>(0, bytes_.size() - 1)(random));
    const Reading reading = read_damaged(cut);
    const double share = static_cast<double>(cut.size()) / static_cast<double>(index_position());
    if (cut.size() < 20'000) continue;  // not every topic may be there yet
    ASSERT_TRUE(reading.opened) << cut.size();
    EXPECT_NEAR(static_cast<double>(reading.events), std::min(1.0, share) * static_cast<double>(events_.size()), 120.0);
  }
}

TEST_F(DamagedBag, SurvivesFlippedBitsAndLosesLittle) {
  std::mt19937 random(6);
  std::size_t worst = events_.size();
  for (int i = 0; i < 300; ++i) {
    std::vector<char> damaged = bytes_;
    // Half of the flips where they hurt most: file header, connection and chunk headers, index.
    const bool anywhere = i % 2 == 0;
    const std::size_t place = std::uniform_int_distribution<std::size_t>(0, bytes_.size() - 1)(random);
    const std::size_t in_index = index_position() + place % (bytes_.size() - index_position());
    const std::size_t in_start = 13 + place % 100;
    damaged[anywhere ? place : i % 4 == 1 ? in_index : in_start] ^= static_cast<char>(1 << (random() % 8));
    const Reading reading = read_damaged(damaged);
    if (reading.opened) worst = std::min(worst, reading.events);
  }
  EXPECT_GT(worst, events_.size() * 8 / 10);  // one chunk of ten at most
}

TEST_F(DamagedBag, SurvivesRubbishOverAnyPart) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    std::vector<char> damaged = bytes_;
    const std::size_t begin = std::uniform_int_distribution<std::size_t>(13, bytes_.size() - 1)(random);
    const std::size_t end = std::min(bytes_.size(), begin + (std::size_t{1} << random() % 18));
    const int fill = static_cast<int>(random() % 3);
    for (std::size_t place = begin; place < end; ++place) {
      damaged[place] = fill == 0 ? '\0' : fill == 1 ? '\xff' : static_cast<char>(random());
    }
    const Reading reading = read_damaged(damaged);
    EXPECT_LE(reading.events, events_.size());
  }
}

TEST_F(DamagedBag, SaysWhatWasLostInADamagedChunk) {
  std::vector<char> damaged = bytes_;
  const std::string_view text(bytes_.data(), bytes_.size());
  const std::size_t second_chunk = text.find("compression=none", text.find("compression=none") + 1);
  damaged[second_chunk + 3] ^= 0x20;   // the field's name
  damaged[second_chunk - 4] = '\x7f';  // and its length
  const Reading reading = read_damaged(damaged);
  EXPECT_LT(reading.events, events_.size());
  EXPECT_GT(reading.events, 0u);
  EXPECT_THAT(reading.notes, Contains(AllOf(HasSubstr("chunk at byte"), HasSubstr("messages skipped"))));
}

TEST_F(DamagedBag, IsDescribedByWhatCanBeRead) {
  std::vector<char> cut = bytes_;
  cut.resize(index_position() / 2);
  write_contents(folder_ / "damaged.bag", cut);
  const auto description = describe_bags({folder_ / "damaged.bag"});
  ASSERT_TRUE(description) << description.error().message;
  EXPECT_EQ(description->topics.size(), 3u);
  EXPECT_THAT(description->notes, Contains(HasSubstr("has no complete index")));
}

}  // namespace
}  // namespace pllit
