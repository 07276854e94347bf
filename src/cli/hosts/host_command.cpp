#include "cli/hosts/host_command.hpp"

#include <chrono>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "cli/hosts/hosted_part.hpp"
#include "cli/hosts/hosted_seeds.hpp"
#include "cli/print/console.hpp"
#include "cli/print/served_metrics.hpp"
#include "cli/words/version.hpp"
#include "control/server.hpp"
#include "core/overloads.hpp"
#include "core/text/printable.hpp"
#include "deploy/host_metrics.hpp"
#include "io/files/file_lock.hpp"
#include "io/files/stored_number.hpp"
#include "io/loop.hpp"
#include "io/process/hangup_watch.hpp"
#include "io/process/machine.hpp"
#include "io/process/signal_watch.hpp"

namespace rubicon::cli {

namespace {

namespace fs = std::filesystem;
using steady = std::chrono::steady_clock;

/// How long the part may take to report when the host ends.
constexpr duration host_goodbye_max = 10s;
constexpr duration host_look_every = 100ms;
constexpr duration host_retry_every = 1s;

class host_service {
public:
  host_service(const host_command& x, fs::path folder, fs::path files)
      : command_(x), with_{x.name, std::move(folder), std::move(files), x.access, x.known},
        signals_(
            loop_, [this](int) { end(); }, /*hangup_too=*/!renews()),
        identity_(x.tls, x.name, (with_.folder / x.name).string()),
        part_(loop_, with_, [this](const std::string& text) { say(text); }), seeds_(loop_, with_) {}

  exit_status run() {
    if (renews())
      hangups_.emplace(loop_, [this] {
        if (server_)
          server_->renew();
      });
    auto opened = listen();
    if (ending_)
      return exit_status::good;
    if (const auto* why = std::get_if<std::string>(&opened)) {
      say(*why);
      return exit_status::refused;
    }
    server_.emplace(std::get<control::server>(std::move(opened)));
    say("listens on " + command_.address + ':' + std::to_string(server_->port()) +
        (command_.tls.empty() ? ", for this computer only"
                              : ", for certificates of " + command_.tls.authority));
    for (const auto& each : identity_.own().warnings())
      say(each);
    if (command_.metrics)
      metrics_.emplace(*command_.metrics);
    while (!ending_ || (part_.is_running() && steady::now() < *ending_ + host_goodbye_max)) {
      loop_.wait_until(steady::now() + host_look_every);
      part_.on_time();
      seeds_.on_time();
      show_metrics();
    }
    hangups_.reset();
    server_.reset();
    return exit_status::good;
  }

private:
  /// A computer that has just started may not have its address yet.
  std::variant<control::server, std::string> listen() {
    bool is_reported = false;
    for (;;) {
      const bool is_there = io::has_address(command_.address);
      auto opened = control::server::open(
          identity_, loop_, command_.address, command_.port,
          [this](deploy::question x) { return answer(std::move(x)); },
          [this](const std::string& line) { say(line); });
      const auto* why = std::get_if<std::string>(&opened);
      if (why == nullptr || is_there || ending_)
        return opened;
      if (!std::exchange(is_reported, true))
        say(*why + "; waits until this computer has the address");
      const auto until = steady::now() + host_retry_every;
      while (!ending_ && steady::now() < until)
        loop_.wait_until(until);
    }
  }

  /// SIGHUP notifies a service of a new certificate.
  [[nodiscard]] bool renews() const { return !command_.tls.empty() && !has_terminal_; }

  void say(const std::string& text) const {
    static_cast<void>(print(stderr, printable(command_.name + "  " + text) + '\n'));
  }

  void show_metrics() {
    if (!metrics_ || steady::now() < next_metrics_)
      return;
    metrics_->show(part_.newest_report(), to_metrics(facts()));
    next_metrics_ = steady::now() + served_metrics::collect_every;
  }

  void end() {
    if (ending_)
      return;
    ending_ = steady::now();
    part_.end_all();
    loop_.wake();
  }

  deploy::host_facts facts() {
    auto out = part_.facts();
    const auto& own = identity_.own();
    out.revocations = own.revoked() ? own.revoked()->number() : 0;
    out.may_deploy = own.identity() && own.identity()->use() == io::certificate_use::any;
    return out;
  }

  deploy::answer answer(deploy::question question) {
    return std::visit(
        overloads{
            [](const deploy::greeting&) -> deploy::answer { return deploy::greeting{version}; },
            [this](const deploy::ask_facts&) -> deploy::answer { return facts(); },
            [this](deploy::offer& x) -> deploy::answer { return part_.offer(std::move(x)); },
            [this](const deploy::begin_part& x) -> deploy::answer { return part_.begin(x); },
            [this](const deploy::end_part& x) -> deploy::answer { return part_.end(x); },
            [this](const deploy::cause_fault& x) -> deploy::answer { return part_.cause(x); },
            [this](const deploy::ask_news& x) -> deploy::answer { return part_.news_after(x); },
            [this](const deploy::offer_seeds& x) -> deploy::answer { return seeds_.offer(x); },
            [this](const deploy::run_seeds& x) -> deploy::answer { return seeds_.run(x); },
            // The server's own.
            [](const deploy::send_revoked&) -> deploy::answer { return deploy::verdict{}; },
        },
        question);
  }

  const host_command& command_;
  const bool has_terminal_ = io::has_terminal();
  const hosting with_;
  std::optional<steady::time_point> ending_;
  io::loop loop_;
  io::signal_watch signals_;
  control::system identity_;
  hosted_part part_;
  hosted_seeds seeds_;
  std::optional<served_metrics> metrics_;
  steady::time_point next_metrics_{};     ///< the first at once
  std::optional<control::server> server_; ///< refers to all of these
  std::optional<io::hangup_watch> hangups_;
};

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

} // namespace

exit_status perform(const host_command& x) {
  if (x.tls.empty() && !is_loopback(x.address))
    return refuse("host " + x.name + " would listen on " + x.address +
                  " without authentication: give it certificates (--tls-cert, --tls-key, --tls-ca; "
                  "`rubicon certs` makes them), or let it listen on 127.0.0.1");
  if (x.tls.empty() && x.access.commands)
    return refuse("--allow-commands without certificates would let every user of this computer "
                  "start programs as you: give --tls-cert, --tls-key and --tls-ca");
  if (x.tls.empty() && x.access.firmware)
    return refuse("--allow-firmware without certificates would let every user of this computer "
                  "run code as you: give --tls-cert, --tls-key and --tls-ca");
  if (x.tls.empty() && !x.access.devices.empty())
    return refuse("--allow-devices without certificates would let every user of this computer "
                  "open devices as you: give --tls-cert, --tls-key and --tls-ca");
  fs::path folder = x.state_folder;
  if (folder.empty())
    folder = fs::path(io::state_file("host")).parent_path();
  if (folder.empty())
    return refuse("there is no folder for the part's files; use --state DIR");
  std::error_code error;
  fs::create_directories(folder, error);
  folder = fs::absolute(folder);
  const auto held = io::file_lock::take((folder / (x.name + ".lock")).string());
  if (const auto* why = std::get_if<std::string>(&held))
    return refuse("host " + x.name + " runs already: " + *why);
  const auto files =
      x.files_folder.empty() ? folder / (x.name + "-files") : fs::absolute(x.files_folder);
  fs::create_directories(files, error);
  if (x.files_folder.empty())
    fs::permissions(files, fs::perms::owner_all, error);
  return host_service(x, folder, files).run();
}

} // namespace rubicon::cli
