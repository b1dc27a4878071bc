// The likely meaning of a mistyped word.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace pllit {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal string
/// alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate with the smallest distance to `word`, the first one of equals; empty without candidates.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

}  // namespace pllit
