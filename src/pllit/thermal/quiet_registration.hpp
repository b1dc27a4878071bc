// Keeps a packaging fault of Debian's ONNX Runtime from filling the terminal.
#pragma once

#include <iostream>
#include <sstream>
#include <string>

namespace pllit {

/// While one lives, std::cerr is held back; its end passes on all but the lines "Schema error: Trying to register …"
/// and the empty ones between them. Debian links ONNX Runtime to a libonnx that has registered its operators already,
/// so the first environment of a process registers each a second time and says so 1,200 times. Not for two threads at
/// once.
class QuietRegistration {
 public:
  QuietRegistration() : terminal_(std::cerr.rdbuf(held_.rdbuf())) {}
  ~QuietRegistration() {
    std::cerr.rdbuf(terminal_);
    std::istringstream lines(held_.str());
    for (std::string line; std::getline(lines, line);)
      if (!line.empty() && !line.starts_with("Schema error: Trying to register")) std::cerr << line << '\n';
  }
  QuietRegistration(const QuietRegistration&) = delete;
  QuietRegistration& operator=(const QuietRegistration&) = delete;

 private:
  std::ostringstream held_;
  std::streambuf* terminal_;
};

}  // namespace pllit
