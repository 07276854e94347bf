#include "cli/options/add_option.hpp"

#include <utility>

#include <CLI/CLI.hpp>

#include "cli/options/option_values.hpp"

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

CLI::Option* add_file(CLI::App& app, std::string& file) {
  return app
      .add_option("FILE", file, "The TOML file that describes the ecology; - reads standard input")
      ->required()
      ->type_name("");
}

CLI::Option* add_settings(CLI::App& app, config::settings& x) {
  return app
      .add_option("--set", x,
                  "Set a key of the file, as in island.kitchen.id=3, with * for all tables; a name "
                  "alone is a parameter of the file; may be repeated")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
}

std::vector<CLI::Option*> add_overrides(CLI::App& app, config::overrides& x) {
  return {add_settings(app, x.settings),
          add_path(app, "--topology", "FILE", x.topology,
                   "TOSSIM topology with gains, instead of the one that the TOML file names"),
          add_path(app, "--noise-trace", "FILE", x.noise_trace,
                   "Noise readings, instead of those that the TOML file names")};
}

CLI::Option* add_page(CLI::App& app, std::optional<page_place>& x) {
  return add_parsed(
             app, "--view", "[PORT]",
             "Show the run live in a browser: prints the address, and keeps serving until Ctrl-C",
             [&x](const auto& text) {
               x.emplace();
               if (!text.empty())
                 parse_page_place(text, *x);
             })
      ->expected(0, 1);
}

CLI::Option* add_page_host(CLI::App& app, std::function<page_place*()> where) {
  return app
      .add_option_function<std::vector<std::string>>(
          "--view-host",
          [where = std::move(where)](const std::vector<std::string>& names) {
            if (auto* const page = where())
              for (const auto& each : names)
                parse_page_host(each, *page);
          },
          "Serve the page also under this name of a host, or of a proxy before it; may be repeated")
      ->allow_extra_args(false)
      ->type_name("NAME");
}

std::vector<CLI::Option*> add_metrics(CLI::App& app, std::optional<metrics_place>& x,
                                      const std::string& when) {
  const auto text = "Serve metrics for Prometheus at http://127.0.0.1:PORT/metrics, or at "
                    "ADDRESS:PORT" +
                    when;
  auto* const place = add_parsed(app, "--metrics", "PORT", text.c_str(), [&x](const auto& where) {
    x.emplace();
    parse_page_place(where, x->at, "--metrics");
  });
  auto* const motes = app.add_flag_callback(
      "--metrics-of-motes",
      [&x] {
        if (x)
          x->motes = true;
      },
      "Metrics of each mote too, not only of islands");
  return {place, motes->needs(place)};
}

CLI::Option* add_log(CLI::App& app, std::string& level) {
  return app.add_option("--log", level, "Least level logged on standard error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->type_name("LEVEL");
}

void add_tls(CLI::App& app, control::tls_files& x) {
  auto* const certificate = add_path(app, "--tls-cert", "FILE", x.certificate,
                                     "Own certificate, made by `rubicon certs add`");
  auto* const key = add_path(app, "--tls-key", "FILE", x.key, "Its key");
  auto* const authority = add_path(
      app, "--tls-ca", "FILE", x.authority,
      "Certificate of the authority: only peers with certificates signed by it are accepted");
  certificate->needs(key)->needs(authority);
  key->needs(certificate);
  authority->needs(certificate);
}

} // namespace rubicon::cli
