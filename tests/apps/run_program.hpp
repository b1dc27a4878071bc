// Runs the built program as a user does, and keeps what it says apart by stream.
#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
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

  /// Starts the program beside the test; its stdout and stderr are those that `finished` reads.
  pid_t start(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), PLLIT_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    constexpr int kNewFile = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, path("stdout.txt").c_str(), kNewFile, 0644);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, path("stderr.txt").c_str(), kNewFile, 0644);
    pid_t process = -1;
    EXPECT_EQ(posix_spawn(&process, PLLIT_PROGRAM, &files, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&files);
    return process;
  }
  /// Waits until a file that the program writes has grown; false where the program ended before, or after minutes.
  bool waited_for(pid_t process, const std::string& file, std::uintmax_t bytes) const {
    std::error_code absent;
    for (int tries = 0; tries < 6000; ++tries) {
      if (std::filesystem::exists(file) && std::filesystem::file_size(file, absent) > bytes) return true;
      siginfo_t ended{};
      if (waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 || ended.si_pid != 0)
        return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  /// Waits for its end. The exit code is -1 where a signal ended it.
  Outcome finished(pid_t process) const {
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("stdout.txt")), read(path("stderr.txt"))};
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace pllit::test
