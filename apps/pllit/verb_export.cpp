// pllit export: a session's map or trajectory in another format.
#include <array>
#include <cstdio>
#include <filesystem>
#include <format>
#include <functional>
#include <memory>
#include <vector>

#include "pllit/io/las.hpp"
#include "pllit/io/pcd.hpp"
#include "pllit/io/ply.hpp"
#include "pllit/io/session.hpp"
#include "pllit/io/tum.hpp"
#include "program.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;

struct Format {
  const char* name;
  const char* default_file;  ///< made inside the session
  Expected<void> (*write)(const fs::path&, const Session&);
};

constexpr std::array<Format, 4> kFormats{{
    {"ply", "export.ply", [](const fs::path& file, const Session& session) { return write_ply(file, session.map); }},
    {"pcd", "map.pcd", [](const fs::path& file, const Session& session) { return write_pcd(file, session.map); }},
    {"las", "map.las", [](const fs::path& file, const Session& session) { return write_las(file, session.map); }},
    {"tum", "export.tum",
     [](const fs::path& file, const Session& session) { return write_tum(file, session.trajectory); }},
}};

struct ExportOptions {
  std::string session, format, out;
  bool overwrite = false;
};

Expected<fs::path> export_session(const ExportOptions& options) {
  const auto format = std::ranges::find(kFormats, options.format, &Format::name);
  const fs::path file = options.out.empty() ? fs::path(options.session) / format->default_file : fs::path(options.out);
  if (fs::exists(file) && !options.overwrite)
    return input_error(std::format("'{}' exists; give another name with --out, or --overwrite", file.string()));
  const auto session = open_session(options.session);
  if (!session) return std::unexpected(session.error());
  if (const auto written = format->write(file, *session); !written) return std::unexpected(written.error());
  return file;
}

ExitCode run(const ExportOptions& options) {
  const auto file = export_session(options);
  if (!file) return report(file.error());
  std::puts(file->c_str());
  return ExitCode::done;
}

}  // namespace

Verb add_export(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("export", "Write a session's map or trajectory in another format");
  const auto options = std::make_shared<ExportOptions>();
  verb->add_option("session", options->session, "Folder that a run has written")->type_name("SESSION")->required();
  std::vector<std::string> names;
  for (const Format& format : kFormats) names.emplace_back(format.name);
  verb->add_option("--format", options->format, "ply, pcd, las: the map; tum: the trajectory")
      ->check(CLI::IsMember(names).description(""))
      ->type_name("ply|pcd|las|tum")
      ->required();
  verb->add_option("--out", options->out,
                   "File to write; its path is printed (default: beside the session's own files)")
      ->type_name("FILE");
  verb->add_flag("--overwrite", options->overwrite, "Replace the file if it exists");
  verb->footer(
      "Examples:\n"
      "  pllit export results/latest --format las\n"
      "  pllit export results/latest --format tum --out walk.tum");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
