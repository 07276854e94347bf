// Options that commands add to a command line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/words/watch_options.hpp"
#include "config/load.hpp"
#include "control/tls.hpp"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace rubicon::cli {

/// An option or word whose text `take` turns into a value or refuses with a ValidationError.
CLI::Option* add_parsed(CLI::App& app, const char* name, const char* type, const char* text,
                        std::function<void(const std::string&)> take);

/// An option that takes the name of a file or folder.
CLI::Option* add_path(CLI::App& app, const char* name, const char* type, std::string& path,
                      const char* text);

/// FILE, the description of an ecology.
CLI::Option* add_file(CLI::App& app, std::string& file);

/// `--set`
CLI::Option* add_settings(CLI::App& app, config::settings& x);

/// Settings, and files that replace those that FILE names.
std::vector<CLI::Option*> add_overrides(CLI::App& app, config::overrides& x);

/// `--view`: the live page.
CLI::Option* add_page(CLI::App& app, std::optional<page_place>& x);

/// `--view-host`: further names of the page. @param where of the page, once the options before it
/// are parsed; nullptr: it is not served
CLI::Option* add_page_host(CLI::App& app, std::function<page_place*()> where);

/// `--metrics` and `--metrics-of-motes`. @param when they are served, behind what the first says
std::vector<CLI::Option*> add_metrics(CLI::App& app, std::optional<metrics_place>& x,
                                      const std::string& when = {});

/// `--log`
CLI::Option* add_log(CLI::App& app, std::string& level);

/// Certificates of the control plane.
void add_tls(CLI::App& app, control::tls_files& x);

} // namespace rubicon::cli
