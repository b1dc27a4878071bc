// Errors at the edges (files, configuration, input): values with full context, handled once.
#pragma once

#include <expected>
#include <string>
#include <utility>

namespace pllit {

/// What went wrong, where, and what to do about it.
struct Error {
  enum class Kind {
    failure,  ///< the run could not go on: disk full, internal limit (exit code 1)
    input     ///< wrong usage, configuration or recording (exit code 2)
  };
  Kind kind = Kind::failure;
  std::string message;
};

template <class T>
using Expected = std::expected<T, Error>;

inline std::unexpected<Error> input_error(std::string message) {
  return std::unexpected(Error{Error::Kind::input, std::move(message)});
}
inline std::unexpected<Error> failure(std::string message) {
  return std::unexpected(Error{Error::Kind::failure, std::move(message)});
}

/// Puts where it happened in front of what happened.
inline std::unexpected<Error> in_context(const std::string& where, Error error) {
  error.message = where + ": " + error.message;
  return std::unexpected(std::move(error));
}

}  // namespace pllit
