#include "cli/options/certs_command_line.hpp"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"

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
      "It runs a part of a deployment, and may not deploy");
  app.add_flag_function(
         "--coordinator", [&use](auto) { use = io::certificate_use::coordinator; },
         "It deploys, and runs no part")
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
  add_path(app, "--dir", "DIR", folder_, "Folder of the certificates; default: certs");
  return app;
}

void certs_command_line::add_init() {
  auto& app = add("init", "Create an authority, which signs the certificates of hosts");
  app.add_option("--name", authority_.name, "Name of the deployment; default: rubicon")
      ->type_name("NAME");
  add_days(app, authority_.days, "Validity in days; default: 3652, 10 years");
}

void certs_command_line::add_host() {
  auto& app = add("add", "Create the certificate and the key of a host");
  app.add_option("HOST", host_.host, "The host's name in the file")->required()->type_name("");
  app.add_option("--address", host_.addresses,
                 "An IP address or DNS name under which others reach it; may be repeated")
      ->allow_extra_args(false) // else it would take HOST for another address
      ->type_name("ADDRESS");
  add_use(app, host_.use);
  add_days(app, host_.days, "Validity in days; default: 825");
}

void certs_command_line::add_renew() {
  auto& app = add("renew", "Create a new certificate for a host, for the same use and addresses");
  app.add_option("HOST", renewal_.host, "The host's name")->required()->type_name("");
  app.add_flag("--new-key", renewal_.new_key,
               "Also create a new key: the old one may be compromised");
  add_use(app, renewal_.use);
  add_days(app, renewal_.days, "Validity in days; default: 825");
  app.footer(
      "The former files are kept in the folder `former`. Without --new-key only HOST.crt is\n"
      "new and its key stays valid. A certificate for both uses gets one of them.");
}

void certs_command_line::add_revoke() {
  auto& app = add("revoke", "Revoke the certificates of a host, including its former ones");
  app.add_option("HOST", revoked_.host, "The host's name")->required()->type_name("");
  app.footer(
      "Writes ca.crl. Commands that find it beside ca.crt send it to the hosts they contact.");
}

void certs_command_line::add_list() {
  auto& app = add("list", "List the certificates, and whether they are valid");
  app.add_flag("--json", list_.json, "Print JSON");
  app.footer(
      "Exit status 1: one has expired or was revoked, was not signed by the authority beside\n"
      "it, or has a key that others can read or that does not match it.");
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
