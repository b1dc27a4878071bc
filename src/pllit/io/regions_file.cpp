#include "pllit/io/regions_file.hpp"

#include <algorithm>
#include <array>
#include <format>
#include <map>
#include <numbers>

#include "pllit/base/strict_yaml.hpp"
#include "pllit/io/file.hpp"

namespace pllit {
namespace {

using YamlEntries = std::map<std::string, YAML::Node>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kLongestTag = 60;
const Limits kCoordinates{-1e5, 1e5};  // metres; what lies beyond is no place of a visit

std::optional<double> number_at(const YamlEntries& entries, const std::string& key, const Limits& limits,
                                YamlProblems& problems) {
  const auto entry = entries.find(key);
  if (entry == entries.end()) return std::nullopt;
  const auto number = number_of<double>(entry->second, limits);
  if (number) return *number;
  problems.add(entry->second, std::format("{}: {}", key, number.error()));
  return std::nullopt;
}

std::optional<Vector3d> corner_at(const YamlEntries& box, const std::string& key, const YAML::Node& where,
                                  YamlProblems& problems) {
  const auto entry = box.find(key);
  if (entry == box.end()) {
    problems.add(where, std::format("box_m has no {}: give {}: [x, y, z] in metres", key, key));
    return std::nullopt;
  }
  if (!entry->second.IsSequence() || entry->second.size() != 3) {
    problems.add(entry->second,
                 std::format("box_m.{} must be a list of 3 numbers, but is {}", key, shape_of(entry->second)));
    return std::nullopt;
  }
  Vector3d corner_W;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = number_of<double>(entry->second[axis], kCoordinates);
    if (!number) {
      problems.add(entry->second, std::format("box_m.{}: number {}: {}", key, axis + 1, number.error()));
      return std::nullopt;
    }
    corner_W[axis] = *number;
  }
  return corner_W;
}

void read_box(const YAML::Node& node, Region& region, YamlProblems& problems) {
  static const std::array<std::string, 2> keys{"min", "max"};
  const YamlEntries box = entries_of(node, "box_m", keys, problems);
  if (!node.IsMap()) return;
  const auto min_W = corner_at(box, "min", node, problems), max_W = corner_at(box, "max", node, problems);
  if (!min_W || !max_W) return;
  region.min_W = *min_W;
  region.max_W = *max_W;
  for (int axis = 0; axis < 3; ++axis)
    if (!(region.min_W[axis] < region.max_W[axis]))
      problems.add(node, std::format("box_m: along {} it reaches from {} to {}; give the smaller number in min and the "
                                     "larger in max",
                                     "xyz"[axis], region.min_W[axis], region.max_W[axis]));
}

void read_limits(const YAML::Node& node, Region& region, YamlProblems& problems) {
  static const std::array<std::string, 2> keys{"change", "kelvin"};
  const YamlEntries limits = entries_of(node, "limits", keys, problems);
  region.limits = {.change = number_at(limits, "change", {1e-3, 1e5}, problems),
                   .kelvin = number_at(limits, "kelvin", {1.0, 5000.0}, problems)};
}

void read_tag(const YamlEntries& entries, const YAML::Node& where, Region& region, YamlProblems& problems) {
  const auto tag = entries.find("tag");
  if (tag == entries.end())
    return problems.add(where, "the region has no tag: give it a name that is its own, like tag: pump-3");
  if (!tag->second.IsScalar())
    return problems.add(tag->second, std::format("tag: must be a text, but is {}", shape_of(tag->second)));
  region.tag = tag->second.Scalar();
  const bool printable = std::ranges::none_of(region.tag, [](unsigned char c) { return c < ' ' || c == 0x7f; });
  if (region.tag.empty() || region.tag.size() > kLongestTag || !printable)
    problems.add(tag->second,
                 std::format("tag: {} is no name; give one line of 1 to {} bytes", in_quotes(region.tag), kLongestTag));
}

Region region_of(const YAML::Node& node, YamlProblems& problems) {
  static const std::array<std::string, 5> keys{"tag", "box_m", "yaw_deg", "emissivity", "limits"};
  Region region{.tag = "", .line = YamlProblems::line_of(node)};
  const YamlEntries entries = entries_of(node, "a region", keys, problems);
  if (!node.IsMap()) return region;
  read_tag(entries, node, region, problems);
  if (const auto box = entries.find("box_m"); box != entries.end())
    read_box(box->second, region, problems);
  else
    problems.add(node, "the region has no box: give box_m: {min: [x, y, z], max: [x, y, z]}");
  region.yaw_rad = number_at(entries, "yaw_deg", {-360.0, 360.0}, problems).value_or(0.0) * kDegree;
  region.emissivity = number_at(entries, "emissivity", {0.05, 1.0}, problems);
  if (const auto limits = entries.find("limits"); limits != entries.end())
    read_limits(limits->second, region, problems);
  return region;
}

}  // namespace

Expected<std::vector<Region>> parse_regions(std::string_view yaml_text, std::string_view source_name) {
  static const std::array<std::string, 1> keys{"regions"};
  const auto root = parse_yaml(yaml_text, source_name);
  if (!root) return std::unexpected(root.error());
  YamlProblems problems(source_name);
  YamlEntries entries = entries_of(*root, "the file", keys, problems);
  const YAML::Node list = entries["regions"];
  if (!problems.any() && (!list.IsSequence() || list.size() == 0))
    problems.add(*root, "regions: must be a list with at least one '- tag: ...'");
  std::vector<Region> regions;
  std::map<std::string, int> lines;
  for (std::size_t i = 0; list.IsSequence() && i < list.size() && !problems.enough(); ++i) {
    regions.push_back(region_of(list[i], problems));
    const Region& region = regions.back();
    const auto [first, fresh] = lines.emplace(region.tag, region.line);
    if (!fresh && !region.tag.empty())
      problems.add(region.line, std::format("tag {} is that of the region in line {} too; each needs its own",
                                            in_quotes(region.tag), first->second));
  }
  if (const auto result = problems.result(); !result) return std::unexpected(result.error());
  return regions;
}

Expected<std::vector<Region>> read_regions(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  return parse_regions(*text, path.string());
}

Expected<void> check_unit(std::span<const Region> regions, IntensityUnit unit, std::string_view source_name) {
  if (unit == IntensityUnit::kelvin) return {};
  YamlProblems problems(source_name);
  for (const Region& region : regions)
    for (const auto& [name, given] : {std::pair("emissivity", region.emissivity.has_value()),
                                      std::pair("limits.kelvin", region.limits.kelvin.has_value())})
      if (given)
        problems.add(region.line, std::format("{} of {} needs temperatures, and these visits are in {}, not in kelvin; "
                                              "take it out",
                                              name, in_quotes(region.tag), name_of(unit)));
  return problems.result();
}

std::string definition_of(const Region& region) {
  const auto text = [](const Vector3d& p) { return std::format("[{}, {}, {}]", p.x(), p.y(), p.z()); };
  std::string definition = std::format("{} to {} m", text(region.min_W), text(region.max_W));
  if (region.yaw_rad != 0.0) definition += std::format(", yaw {:.4g} deg", region.yaw_rad / kDegree);
  if (region.emissivity) definition += std::format(", emissivity {}", *region.emissivity);
  return definition;
}

}  // namespace pllit
