#include "cli/certs_command_line.hpp"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/add_option.hpp"

namespace rubicon::cli {

namespace {

void add_days(CLI::App& app, unsigned& days, const char* text) {
  app.add_option("--days", days, text)
      ->check(CLI::Range(1U, io::certificate_days_max))
      ->type_name("N");
}

/// One of both at most.
void add_use(CLI::App& app, io::certificate_use& use) {
  auto* const as_host = app.add_flag_function(
      "--host", [&use](auto) { use = io::certificate_use::host; },
      "It answers who deploys, and may not deploy itself");
  app.add_flag_function(
         "--coordinator", [&use](auto) { use = io::certificate_use::coordinator; },
         "It deploys, and is no host")
      ->excludes(as_host);
}

} // namespace

certs_command_line::certs_command_line(CLI::App& app)
    : app_(*app.add_subcommand(
          "certs", "Make, renew, revoke and list the certificates of a deployment's hosts")) {
  app_.require_subcommand(1);
  add_init();
  add_host();
  add_renew();
  add_revoke();
  add_list();
}

CLI::App& certs_command_line::add(const char* name, const char* text) {
  auto& app = *app_.add_subcommand(name, text);
  add_path(app, "--dir", "DIR", folder_, "Folder of the certificates; certs if not given");
  return app;
}

void certs_command_line::add_init() {
  auto& app = add("init", "Make an authority, which signs the certificates of hosts");
  app.add_option("--name", authority_.name, "Name of the deployment; rubicon if not given")
      ->type_name("NAME");
  add_days(app, authority_.days, "Days that it is valid; 3652, 10 years, if not given");
}

void certs_command_line::add_host() {
  auto& app = add("add", "Make the certificate and the key of a host");
  app.add_option("HOST", host_.host, "The host's name in the file")->required()->type_name("");
  app.add_option("--address", host_.addresses,
                 "An IP address or DNS name by which others reach it; may be given again")
      ->allow_extra_args(false) // else it would take HOST for another address
      ->type_name("ADDRESS");
  add_use(app, host_.use);
  add_days(app, host_.days, "Days that it is valid; 825 if not given");
}

void certs_command_line::add_renew() {
  auto& app = add("renew", "Make another certificate for a host, of the same use and addresses");
  app.add_option("HOST", renewal_.host, "The host's name")->required()->type_name("");
  app.add_flag("--new-key", renewal_.new_key,
               "Make another key, too: the former one may be in other hands");
  add_use(app, renewal_.use);
  add_days(app, renewal_.days, "Days that it is valid; 825 if not given");
  app.footer(
      "The former files are kept in the folder `former`. Without --new-key HOST.crt alone is\n"
      "new: its key, wherever that is, stays. A certificate for both uses gets one of them.");
}

void certs_command_line::add_revoke() {
  auto& app = add("revoke", "Take back the certificates of a host, with its former ones");
  app.add_option("HOST", revoked_.host, "The host's name")->required()->type_name("");
  app.footer("Writes ca.crl. Whoever has it beside ca.crt takes it to the hosts that he asks.");
}

void certs_command_line::add_list() {
  auto& app = add("list", "Tell which certificates there are, and whether they are good");
  app.add_flag("--json", list_.json, "Print JSON");
  app.footer(
      "Exit status 1: one has expired or was revoked, was not signed by the authority beside\n"
      "it, or has a key that others can read or that is not its own.");
}

std::optional<certs_command> certs_command_line::parsed() const {
  if (!app_.parsed())
    return std::nullopt;
  const auto is = [this](const char* name) { return app_.got_subcommand(name); };
  certs_command x{folder_, list_};
  if (is("init"))
    x.what = authority_;
  else if (is("add"))
    x.what = host_;
  else if (is("renew"))
    x.what = renewal_;
  else if (is("revoke"))
    x.what = revoked_;
  return x;
}

} // namespace rubicon::cli
