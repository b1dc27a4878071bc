#include "pllit/io/point_records.hpp"

#include <algorithm>
#include <format>
#include <set>

namespace pllit {
namespace {

constexpr std::size_t kLongestName = 31;  // LAS extra bytes, with their final zero
constexpr std::string_view kNameCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";

}  // namespace

std::vector<std::string> field_names(const PointTable& table) {
  std::vector<std::string> names;
  for (const ScalarField& field : table.fields) names.push_back(field.name);
  return names;
}

Expected<void> check_field_names(const std::vector<std::string>& names) {
  std::set<std::string> used{"x", "y", "z"};
  for (const std::string& name : names) {
    if (name.empty() || name.size() > kLongestName || name.find_first_not_of(kNameCharacters) != name.npos)
      return failure(std::format("scalar field '{}': a name has 1 to {} letters, digits or _ . -", name, kLongestName));
    if (!used.insert(name).second) return failure(std::format("scalar field '{}': the name is already taken", name));
  }
  return {};
}

Expected<void> check_points(const PointTable& table) {
  for (const ScalarField& field : table.fields)
    if (field.values.size() != table.points.size())
      return failure(std::format("scalar field '{}' has {} values for {} points", field.name, field.values.size(),
                                 table.points.size()));
  const auto bad = std::ranges::find_if(table.points, [](const auto& point) { return !point.allFinite(); });
  if (bad != table.points.end()) return failure(std::format("point {} is not finite", bad - table.points.begin()));
  return {};
}

std::string float_rows(const PointTable& table, std::size_t begin, std::size_t end) {
  std::string rows;
  rows.reserve((end - begin) * (3 + table.fields.size()) * sizeof(float));
  for (std::size_t i = begin; i < end; ++i) {
    for (const float coordinate : table.points[i]) append_bytes(rows, coordinate);
    for (const ScalarField& field : table.fields) append_bytes(rows, field.values[i]);
  }
  return rows;
}

}  // namespace pllit
