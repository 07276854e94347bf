#include "cli/certs_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include <nlohmann/json.hpp>

#include "cli/network/network_text.hpp"
#include "cli/print/console.hpp"
#include "config/summary_parts.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "io/tls/certificates.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

using std::chrono::sys_seconds;
using certificates = std::vector<io::listed_certificate>;

std::string two_digits(unsigned x) {
  return (x < 10 ? "0" : "") + std::to_string(x);
}

/// `2028-02-28`, in UTC
std::string date_text(sys_seconds x) {
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(x));
  return std::to_string(static_cast<int>(date.year())) + '-' +
         two_digits(static_cast<unsigned>(date.month())) + '-' +
         two_digits(static_cast<unsigned>(date.day()));
}

/// Whole ones; below 0 when it is over.
std::int64_t days_left(const io::listed_certificate& x, sys_seconds now) {
  return std::chrono::floor<std::chrono::days>(x.valid_until - now).count();
}

report::cell judged(std::string text, bool good) {
  return {std::move(text), good ? report::look::plain : report::look::bad};
}

report::cell time_left(const io::listed_certificate& x, sys_seconds now) {
  if (x.revoked)
    return judged("revoked", false);
  if (x.valid_until <= now)
    return judged("expired", false);
  if (x.valid_from > now)
    return judged("not yet", false);
  return std::to_string(days_left(x, now));
}

std::vector<report::cell> row_of(const io::listed_certificate& x, sys_seconds now) {
  const auto key = judged(std::string(to_string(x.key)),
                          x.key == io::key_state::safe || x.key == io::key_state::missing);
  if (!x.problem.empty())
    return {printable(x.name), "", "", "", judged("unreadable", false), "", key};
  return {printable(x.name),
          printable(config::joined(x.addresses, " ")),
          date_text(x.valid_until),
          time_left(x, now),
          judged(x.signed_by_authority ? "yes" : "no", x.signed_by_authority),
          x.file == "ca.crt" ? "" : std::string(to_string(x.use)),
          key};
}

std::string table_of(const certificates& all, sys_seconds now) {
  report::table table({{"name"},
                       {"addresses"},
                       {"valid until"},
                       {"days left", report::align::right},
                       {"signed by ca"},
                       {"use"},
                       {"key"}});
  for (const auto& x : all)
    table.add(row_of(x, now));
  const auto output = console_of(stdout);
  return table.render(output.room(), output.colour);
}

std::string json_of(const certificates& all, sys_seconds now) {
  std::vector<nlohmann::ordered_json> rows;
  for (const auto& x : all) {
    nlohmann::ordered_json row{{"file", x.file}, {"name", x.name}};
    if (x.problem.empty()) {
      row["addresses"] = x.addresses;
      row["valid_from"] = x.valid_from.time_since_epoch().count();
      row["valid_until"] = x.valid_until.time_since_epoch().count();
      row["days_left"] = days_left(x, now);
      row["signed_by_ca"] = x.signed_by_authority;
      row["use"] = to_string(x.use);
      row["revoked"] = x.revoked.has_value();
    } else {
      row["problem"] = x.problem;
    }
    row["key"] = to_string(x.key);
    row["good"] = is_good(x, now);
    rows.push_back(std::move(row));
  }
  return lines_of(rows);
}

/// Every problem that the table has no room for.
std::string unreadable_of(const certificates& all) {
  std::string text;
  for (const auto& x : all) {
    if (!x.problem.empty())
      text += printable(x.problem) + '\n';
  }
  return text;
}

/// @param folder where an authority should be
exit_status refuse_in(const std::string& folder, const std::string& why) {
  const auto authority = folder + '/' + std::string(io::authority_name) + ".crt";
  std::error_code error;
  const bool is_missing =
      why.starts_with(authority) && !std::filesystem::exists(authority, error) && !error;
  return refuse(why + (is_missing ? "; rubicon certs init creates an authority" : ""));
}

/// @param next what a user does then
exit_status print_made(const io::made_certificate& made, const std::string& about_key,
                       const std::string& next = {}) {
  const auto text = printable(made.file) + ", valid until " + date_text(made.valid_until) + '\n' +
                    printable(made.key_file) + ", its key: " + about_key + '\n' +
                    (next.empty() ? "" : "Next: " + next + '\n');
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

/// `copy these two and certs/ca.crt to kitchen; there: rubicon host --name kitchen ...`
std::string next_of(const io::made_certificate& made, const std::string& folder,
                    const io::new_certificate& x) {
  const auto authority = folder + '/' + std::string(io::authority_name) + ".crt";
  if (x.use == io::certificate_use::coordinator)
    return "rubicon deploy FILE --tls-cert " + printable(shell_word(made.file)) + " --tls-key " +
           printable(shell_word(made.key_file)) + " --tls-ca " + printable(shell_word(authority));
  return "copy these two and " + printable(authority) + " to " + x.host +
         "; there: rubicon host --name " + x.host + " --listen ADDRESS:4242 --tls-cert " + x.host +
         ".crt --tls-key " + x.host + ".key --tls-ca ca.crt";
}

exit_status perform_in(const std::string& folder, const io::new_authority& x) {
  const auto made = io::make_authority(folder, x, io::system_time());
  if (const auto* why = std::get_if<std::string>(&made))
    return refuse(*why);
  return print_made(std::get<io::made_certificate>(made),
                    "anyone who has it can make certificates, so keep it off the hosts",
                    "rubicon certs add HOST --host for each host, and rubicon certs add NAME "
                    "--coordinator for whoever deploys");
}

exit_status perform_in(const std::string& folder, const io::new_certificate& x) {
  if (x.use == io::certificate_use::any)
    return refuse("choose the use of `" + x.host +
                  "`: --host, which runs a part, or --coordinator, which deploys");
  const auto made = io::make_certificate(folder, x, io::system_time());
  if (const auto* why = std::get_if<std::string>(&made))
    return refuse_in(folder, *why);
  const auto& found = std::get<io::made_certificate>(made);
  return print_made(found, "for " + x.host + " only, beside ca.crt", next_of(found, folder, x));
}

exit_status perform_in(const std::string& folder, const io::renewal& x) {
  const auto made = io::renew_certificate(folder, x, io::system_time());
  if (const auto* why = std::get_if<std::string>(&made))
    return refuse_in(folder, *why);
  const auto& found = std::get<io::made_certificate>(made);
  if (!found.key_file.empty())
    return print_made(found, "for " + x.host + " only, beside ca.crt");
  const auto text = printable(found.file) + ", valid until " + date_text(found.valid_until) +
                    "; its key is unchanged\n";
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

exit_status perform_in(const std::string& folder, const revoke_host& x) {
  const auto made = io::revoke_certificate(folder, x.host, io::system_time());
  if (const auto* why = std::get_if<std::string>(&made))
    return refuse_in(folder, *why);
  const auto& found = std::get<io::made_revocation>(made);
  const auto text = printable(found.file) + ", number " + std::to_string(found.number) + ": " +
                    report::counted(found.added, "certificate") + " of " + x.host +
                    " more; keep it beside ca.crt: `rubicon deploy`, `status` and `doctor` send it "
                    "to hosts\n";
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

exit_status perform_in(const std::string& folder, const list_certificates& x) {
  const auto found = io::list_certificates(folder);
  if (const auto* why = std::get_if<std::string>(&found))
    return refuse_in(folder, *why);
  const auto& all = std::get<certificates>(found);
  const auto now = io::system_time();
  static_cast<void>(print(stderr, unreadable_of(all)));
  if (!print(stdout, x.json ? json_of(all, now) : table_of(all, now)))
    return exit_status::refused;
  const bool all_good =
      std::all_of(all.begin(), all.end(), [&](const auto& each) { return is_good(each, now); });
  return all_good ? exit_status::good : exit_status::failed;
}

} // namespace

exit_status perform(const certs_command& x) {
  return std::visit([&](const auto& what) { return perform_in(x.folder, what); }, x.what);
}

} // namespace rubicon::cli
