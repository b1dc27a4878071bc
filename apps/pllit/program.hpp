// What the verbs of the program share. A verb parses options, calls the library and prints; it holds no algorithm.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <string_view>

#include "pllit/base/error.hpp"

namespace pllit::app {

enum class ExitCode {
  done = 0,
  failed = 1,    ///< could not go on: disk full, internal limit
  usage = 2,     ///< wrong usage, configuration or input
  degraded = 3,  ///< finished, but was degraded or lost
  alarm = 4      ///< anomalies at or above the alarm level (only with --alarm-exit)
};

/// Of every JSON document on stdout and in a session: raised when a key changes its meaning or goes.
inline constexpr int kSchemaVersion = 1;

/// A subcommand and what it does once its options are parsed. `run` owns the options.
struct Verb {
  CLI::App* command;
  std::function<ExitCode()> run;
};

// One function a verb, each in verb_NAME.cpp: adds the subcommand with its options to the program.
Verb add_compare(CLI::App& program);
Verb add_config(CLI::App& program);
Verb add_doctor(CLI::App& program);
Verb add_eval(CLI::App& program);
Verb add_export(CLI::App& program);
Verb add_run(CLI::App& program);
Verb add_simulate(CLI::App& program);
Verb add_trends(CLI::App& program);

/// Logs the error to stderr and gives the exit code of its kind.
ExitCode report(const Error& error);

/// A line with the likely meaning of the first word on the command line that the program does not know; empty where it
/// knows them all.
std::string suggestion_for(const CLI::App& program, int argc, const char* const* argv);

/// A line about the first argument or value of an option that is empty, which every verb would take for one that was
/// not given; empty where there is none.
std::string complaint_about_empty(int argc, const char* const* argv);

struct Version {
  std::string_view number, commit;  ///< commit: empty where it was not known to the build
};
Version version();
std::string version_line();

}  // namespace pllit::app
