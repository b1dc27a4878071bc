#include "pllit/thermal/decode_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

namespace pllit {
namespace {

using Eigen::Vector2f;

Vector2f quarter_turn(const Vector2f& v) { return {-v.y(), v.x()}; }

/// One cell's say: where the nearest point of a segment is, which way that runs and how far it reaches either way.
struct Vote {
  int row = 0, column = 0;
  float attraction = 0.0F, distance_px = 0.0F;
  Vector2f foot_px, along;
  float ahead_px = 0.0F, behind_px = 0.0F;
};

Vote vote_of(const MapView& map, int row, int column) {
  using namespace line_map;
  Vector2f direction(map.at(direction_x, row, column), map.at(direction_y, row, column));
  direction.normalize();
  const float distance_px = map.at(distance, row, column);
  constexpr float kFarthest_rad = 1.55F;  // 770 px; the tangent beyond says nothing
  const auto reach = [&](Channel channel) {
    return kEndScale_px * std::tan(std::min(map.at(channel, row, column), kFarthest_rad));
  };
  return {.row = row,
          .column = column,
          .attraction = map.at(attraction, row, column),
          .distance_px = distance_px,
          .foot_px = centre_px(row, column) + distance_px * direction,
          .along = quarter_turn(direction),
          .ahead_px = reach(end_ahead),
          .behind_px = reach(end_behind)};
}

/// The cells that take part, the surest first, and where on the map each is.
class Votes {
 public:
  Votes(const MapView& map, const cv::Size& image, double least_attraction)
      : columns_(map.columns), at_(map.plane(), -1) {
    const int rows = std::min(map.rows, (image.height + line_map::kStride_px - 1) / line_map::kStride_px);
    const int columns = std::min(map.columns, (image.width + line_map::kStride_px - 1) / line_map::kStride_px);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        if (map.at(line_map::attraction, row, column) >= static_cast<float>(least_attraction))
          votes_.push_back(vote_of(map, row, column));
    constexpr float kLessSure_perPx = 0.05F;
    std::ranges::stable_sort(votes_, std::ranges::greater{},
                             [](const Vote& v) { return v.attraction - kLessSure_perPx * v.distance_px; });
    for (std::size_t i = 0; i < votes_.size(); ++i) at_[place(votes_[i].row, votes_[i].column)] = static_cast<int>(i);
    rows_ = map.rows;
  }

  std::size_t size() const { return votes_.size(); }
  const Vote& operator[](std::size_t i) const { return votes_[i]; }
  /// Index of a cell's vote, -1 where it takes no part.
  int index(int row, int column) const {
    return row < 0 || column < 0 || row >= rows_ || column >= columns_ ? -1 : at_[place(row, column)];
  }

 private:
  std::size_t place(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int rows_ = 0, columns_ = 0;
  std::vector<Vote> votes_;
  std::vector<int> at_;
};

/// The straight line through feet, by weighted total least squares.
class Line {
 public:
  explicit Line(const Vote& first) : along_(first.along) { add(first); }

  void add(const Vote& vote) {
    const float weight = vote.attraction / (1.0F + 0.3F * vote.distance_px);
    const Vector2f& p = vote.foot_px;
    weight_ += weight;
    sum_ += weight * p;
    squares_ += weight * Eigen::Vector3f(p.x() * p.x(), p.y() * p.y(), p.x() * p.y());
    centre_ = sum_ / weight_;
    constexpr int kEnoughToTurn = 6;
    if (++count_ >= kEnoughToTurn) turn();
  }
  float along(const Vector2f& p) const { return along_.dot(p - centre_); }
  float across(const Vector2f& p) const { return quarter_turn(along_).dot(p - centre_); }
  Vector2f at(float t) const { return centre_ + t * along_; }
  const Vector2f& direction() const { return along_; }

 private:
  void turn() {
    const Eigen::Vector3f mean = squares_ / weight_;
    const float xx = mean[0] - centre_.x() * centre_.x(), yy = mean[1] - centre_.y() * centre_.y(),
                xy = mean[2] - centre_.x() * centre_.y();
    constexpr float kLeastLength_px2 = 9.0F;  // feet in a heap have no direction of their own
    if (xx + yy < kLeastLength_px2) return;
    const float angle = 0.5F * std::atan2(2.0F * xy, xx - yy);
    const Vector2f turned(std::cos(angle), std::sin(angle));
    along_ = turned.dot(along_) < 0.0F ? Vector2f(-turned) : turned;
  }
  int count_ = 0;
  float weight_ = 0.0F;
  Vector2f sum_ = Vector2f::Zero(), centre_ = Vector2f::Zero(), along_;
  Eigen::Vector3f squares_ = Eigen::Vector3f::Zero();
};

struct Region {
  Line line;
  std::vector<std::size_t> votes;
};

/// Gathers neighbours of neighbours from a seed on whose feet lie on the line so far. Marks what it takes as used.
Region grown(const Votes& votes, std::size_t seed, std::vector<bool>& used, const LineDecoding& config) {
  Region region{Line(votes[seed]), {seed}};
  used[seed] = true;
  const auto least_cos = static_cast<float>(std::cos(config.grow_deg * std::numbers::pi / 180.0));
  for (std::size_t next = 0; next < region.votes.size(); ++next) {
    const Vote& from = votes[region.votes[next]];
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        const int other = votes.index(from.row + dr, from.column + dc);
        if (other < 0 || used[static_cast<std::size_t>(other)]) continue;
        const Vote& vote = votes[static_cast<std::size_t>(other)];
        if (std::abs(vote.along.dot(region.line.direction())) < least_cos ||
            std::abs(region.line.across(vote.foot_px)) > static_cast<float>(config.grow_px))
          continue;
        used[static_cast<std::size_t>(other)] = true;
        region.votes.push_back(static_cast<std::size_t>(other));
        region.line.add(vote);
      }
  }
  return region;
}

/// Where the line ends in the direction `sign`: the last foot, corrected by what the votes near it say, the nearest
/// most.
float end_of(const Region& region, const Votes& votes, float sign) {
  const Vector2f along = sign * region.line.direction();
  float last = -1e9F;
  for (const std::size_t i : region.votes) last = std::max(last, sign * region.line.along(votes[i].foot_px));
  float weight = 0.0F, sum = 0.0F;
  for (const std::size_t i : region.votes) {
    const Vote& vote = votes[i];
    const float here = sign * region.line.along(vote.foot_px);
    constexpr float kNear_px = 32.0F, kSure_px = 4.0F, kLess_px = 6.0F, kMore_px = 10.0F;
    if (last - here > kNear_px) continue;
    const float reach = vote.along.dot(along) > 0.0F ? vote.ahead_px : vote.behind_px;
    const float share = vote.attraction / ((reach + kSure_px) * (reach + kSure_px));
    weight += share;
    sum += share * std::clamp(here + reach, last - kLess_px, last + kMore_px);
  }
  return sign * (weight > 0.0F ? sum / weight : last);
}

/// Moves an end along its line to where the nearest junction is.
float moved_to_junction(const Line& line, float end, const std::vector<Junction>& junctions,
                        const LineDecoding& config) {
  float nearest = static_cast<float>(config.match_along_px), moved = end;
  for (const Junction& junction : junctions) {
    const float t = line.along(junction.at_px);
    if (std::abs(t - end) >= nearest ||
        std::abs(line.across(junction.at_px)) > static_cast<float>(config.match_across_px))
      continue;
    nearest = std::abs(t - end);
    moved = t;
  }
  return moved;
}

Vector2f within(const Vector2f& p, const cv::Size& image) {
  return p.cwiseMax(0.0F).cwiseMin(Vector2f(static_cast<float>(image.width - 1), static_cast<float>(image.height - 1)));
}

/// One line through both where one goes on or covers the other; nothing where they are two lines.
std::optional<LineSegment> merged_pair(const LineSegment& a, const LineSegment& b, const LineDecoding& config) {
  const LineSegment &longer = a.length_px() >= b.length_px() ? a : b, &shorter = a.length_px() >= b.length_px() ? b : a;
  const float length = longer.length_px();
  const Vector2f along = (longer.end_px - longer.start_px) / length;
  if (std::abs(along.dot(shorter.end_px - shorter.start_px)) <
      static_cast<float>(std::cos(config.merge_deg * std::numbers::pi / 180.0)) * shorter.length_px())
    return std::nullopt;
  const auto across = [&](const Vector2f& p) { return std::abs(quarter_turn(along).dot(p - longer.start_px)); };
  if (std::max(across(shorter.start_px), across(shorter.end_px)) > static_cast<float>(config.merge_px))
    return std::nullopt;
  const float t0 = along.dot(shorter.start_px - longer.start_px), t1 = along.dot(shorter.end_px - longer.start_px);
  const auto gap = static_cast<float>(config.merge_gap_px);
  if (std::max(t0, t1) < -gap || std::min(t0, t1) > length + gap) return std::nullopt;
  LineSegment both = longer;
  if (std::min(t0, t1) < 0.0F) both.start_px = t0 < t1 ? shorter.start_px : shorter.end_px;
  if (std::max(t0, t1) > length) both.end_px = t0 < t1 ? shorter.end_px : shorter.start_px;
  return both;
}

/// Longest first, takes up every other that it can be merged with as long as the field agrees with the whole.
std::vector<LineSegment> without_duplicates(std::vector<LineSegment> segments, const MapView& map,
                                            const LineDecoding& config) {
  std::ranges::stable_sort(segments, std::ranges::greater{}, &LineSegment::length_px);
  std::vector<bool> gone(segments.size(), false);
  std::vector<LineSegment> kept;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (gone[i]) continue;
    for (std::size_t k = i + 1; k < segments.size(); ++k) {
      if (gone[k]) continue;
      const std::optional<LineSegment> both = merged_pair(segments[i], segments[k], config);
      if (!both || line_support(map, *both) < static_cast<float>(config.least_support)) continue;
      segments[i] = *both;
      gone[k] = true;
    }
    kept.push_back(segments[i]);
  }
  return kept;
}

}  // namespace

std::vector<Junction> decode_junctions(const MapView& map, const cv::Size& image, double least_score) {
  using namespace line_map;
  std::vector<Junction> junctions;
  const auto best_around = [&](int row, int column) {
    float best = 0.0F;
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, map.rows - 1); ++r)
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, map.columns - 1); ++c)
        if (r != row || c != column) best = std::max(best, map.at(junction, r, c));
    return best;
  };
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      const float score = map.at(junction, row, column);
      if (score < static_cast<float>(least_score) || score < best_around(row, column)) continue;
      const Vector2f at =
          centre_px(row, column) + Vector2f(map.at(junction_x, row, column), map.at(junction_y, row, column));
      if (at.x() <= static_cast<float>(image.width - 1) && at.y() <= static_cast<float>(image.height - 1))
        junctions.push_back({at, score});
    }
  std::ranges::stable_sort(junctions, std::ranges::greater{}, &Junction::score);
  return junctions;
}

float line_support(const MapView& map, const LineSegment& segment) {
  const float length = segment.length_px();
  constexpr float kStep_px = 2.0F, kOff_px = 3.0F, kSquare = 0.85F, kOnLine_px = 1.0F;
  const int places = std::max(static_cast<int>(length / kStep_px), 1);
  const Vector2f across = quarter_turn((segment.end_px - segment.start_px) / std::max(length, 1e-3F));
  float sum = 0.0F;
  for (int i = 0; i < places; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(places);
    const Vector2f at = segment.start_px + share * (segment.end_px - segment.start_px);
    const int row = std::clamp(static_cast<int>((at.y() + 0.5F) / line_map::kStride_px), 0, map.rows - 1);
    const int column = std::clamp(static_cast<int>((at.x() + 0.5F) / line_map::kStride_px), 0, map.columns - 1);
    const Vote vote = vote_of(map, row, column);
    if (vote.distance_px > kOnLine_px && std::abs(vote.along.dot(across)) > std::sqrt(1.0F - kSquare * kSquare))
      continue;
    sum += vote.attraction * std::max(0.0F, 1.0F - std::abs(across.dot(vote.foot_px - at)) / kOff_px);
  }
  return sum / static_cast<float>(places);
}

std::vector<LineSegment> decode_lines(const MapView& map, const cv::Size& image, const LineDecoding& config) {
  const std::vector<Junction> junctions = decode_junctions(map, image, config.least_junction);
  const Votes votes(map, image, config.least_attraction);
  std::vector<bool> used(votes.size(), false);
  std::vector<LineSegment> segments;
  constexpr std::size_t kFewestVotes = 4;
  constexpr float kShortestPiece = 0.5F;  // of the least length: pieces may yet be merged
  for (std::size_t seed = 0; seed < votes.size(); ++seed) {
    if (used[seed]) continue;
    const Region region = grown(votes, seed, used, config);
    if (region.votes.size() < kFewestVotes) continue;
    const auto end = [&](float sign) {
      const float t = moved_to_junction(region.line, end_of(region, votes, sign), junctions, config);
      return within(region.line.at(t), image);
    };
    const LineSegment segment{.start_px = end(-1.0F), .end_px = end(1.0F), .score = 0.0F};
    if (segment.length_px() >= kShortestPiece * static_cast<float>(config.least_length_px) &&
        line_support(map, segment) >= static_cast<float>(config.least_support))
      segments.push_back(segment);
  }
  std::vector<LineSegment> lines = without_duplicates(std::move(segments), map, config);
  std::erase_if(lines,
                [&](const LineSegment& s) { return s.length_px() < static_cast<float>(config.least_length_px); });
  constexpr float kLong_px = 20.0F;
  for (LineSegment& line : lines)
    line.score = std::min(line_support(map, line), 1.0F) * line.length_px() / (line.length_px() + kLong_px);
  std::ranges::stable_sort(lines, std::ranges::greater{}, &LineSegment::score);
  if (lines.size() > static_cast<std::size_t>(std::max(config.most, 0)))
    lines.resize(static_cast<std::size_t>(std::max(config.most, 0)));
  return lines;
}

}  // namespace pllit
