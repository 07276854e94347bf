#include "cli/words/add_option.hpp"

#include <utility>

#include <CLI/CLI.hpp>

namespace rubicon::cli {

CLI::Option* add_parsed(CLI::App& app, const char* name, const char* type, const char* text,
                        std::function<void(const std::string&)> take) {
  return app.add_option_function<std::string>(name, std::move(take), text)->type_name(type);
}

CLI::Option* add_path(CLI::App& app, const char* name, const char* type, std::string& path,
                      const char* text) {
  const auto is_named = [](const std::string& x) {
    return x.empty() ? std::string("a name is missing") : std::string();
  };
  return app.add_option(name, path, text)->type_name(type)->check(is_named);
}

} // namespace rubicon::cli
