// Options that commands add to a command line.
#pragma once

#include <functional>
#include <string>

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

} // namespace rubicon::cli
