// The one list of configuration keys: loader, --set, dump, documentation and equality are all written on top of it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pllit/base/limits.hpp"
#include "pllit/slam/config.hpp"

namespace pllit {

/// A value that is one of a few words.
struct Choice {
  std::span<const std::string_view> words;
  std::function<std::size_t()> get;  ///< index of the word that stands
  std::function<void(std::size_t)> set;
};

/// One key: its name in the file, where its value lies, and what a user must know about it.
struct Key {
  using Value =
      std::variant<int*, double*, std::string*, Duration*, PoseConfig*, std::span<int>, std::span<double>, Choice>;
  std::string path;  ///< with its sections: "map.voxel_m"
  Value value;
  std::string doc;   ///< one line
  std::string unit;  ///< empty where the value has none
  Limits limits;
};

/// A group of keys in the file: "map".
struct KeySection {
  std::string path, doc;
};

struct KeyList {
  std::vector<KeySection> sections;  ///< a parent before its children
  std::vector<Key> keys;             ///< those of one section in a row

  const Key* find(std::string_view path) const;
  const KeySection* find_section(std::string_view path) const;
  /// The key or section whose name is nearest to what was written: the likely meaning of a typing error.
  std::string nearest(std::string_view path) const;
};

/// Every key, bound to the members of `config`, which must outlive the list.
KeyList keys_of(Config& config);

/// Keys below this section are for experts and not part of the 25 that users are expected to know.
inline constexpr std::string_view kAdvanced = "advanced.";

}  // namespace pllit
