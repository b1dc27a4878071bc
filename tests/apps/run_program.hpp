// Runs the built program as a user does, and keeps what it says apart by stream.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace pllit::test {

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

/// Each test has a folder of its own.
class ProgramTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  static std::string read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  /// No argument may hold a single quote.
  Outcome run(const std::vector<std::string>& arguments) const {
    const std::string out = path("stdout.txt"), err = path("stderr.txt");
    std::string command = std::string("'") + PLLIT_PROGRAM + "'";
    for (const std::string& argument : arguments) command += " '" + argument + "'";
    const int status = std::system((command + " >'" + out + "' 2>'" + err + "'").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace pllit::test
