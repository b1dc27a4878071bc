// One value of the configuration as text: how it is read, checked and written. For the files beside it only.
#pragma once

#include <yaml-cpp/yaml.h>

#include <expected>
#include <string>
#include <string_view>

#include "pllit/slam/config_keys.hpp"

namespace pllit {

/// Sets the key from a YAML node, or says in one clause what is wrong with it ("0 is out of range; give ...").
std::expected<void, std::string> read_value(const Key& key, const YAML::Node& node);

/// The value as YAML on one line; doubles with as many digits as give them back to the bit.
std::string value_text(const Key::Value& value);

/// What the value may be: "0.05 to 10", "auto | static | moving"; empty where anything goes.
std::string range_text(const Key& key);

}  // namespace pllit
