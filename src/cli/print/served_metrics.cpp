#include "cli/print/served_metrics.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/print/console.hpp"
#include "report/print/exposition.hpp"
#include "report/print/metrics.hpp"

namespace rubicon::cli {

served_metrics::served_metrics(const metrics_place& where) : motes_(where.motes) {
  io::web_site site;
  site.address = where.at.address;
  site.port = where.at.port;
  site.on_request = [shown = newest_](std::string_view name) -> std::optional<io::web_file> {
    if (name != "metrics")
      return std::nullopt;
    std::shared_ptr<const std::string> text;
    {
      const std::lock_guard guard(shown->lock);
      text = shown->text;
    }
    return io::web_file{report::exposition::content_type, *text};
  };
  auto opened = io::web_server::open(std::move(site));
  if (const auto* why = std::get_if<std::string>(&opened))
    throw std::runtime_error(*why);
  server_ = std::move(std::get<io::web_server>(opened));
  if (!where.at.address.starts_with("127."))
    say("metrics are not encrypted, and anyone on the network can read them");
  say("metrics: http://" + (where.at.address == "0.0.0.0" ? "127.0.0.1" : where.at.address) + ':' +
      std::to_string(server_->port()) + "/metrics");
  maker_ = std::thread([this] { make_texts(); });
}

served_metrics::~served_metrics() {
  {
    const std::lock_guard guard(lock_);
    over_ = true;
  }
  wake_.notify_one();
  maker_.join();
}

void served_metrics::show(std::optional<report::run_report> x, std::string first) {
  {
    const std::lock_guard guard(lock_);
    waiting_.emplace(shown{std::move(x), std::move(first)});
  }
  wake_.notify_one();
}

void served_metrics::make_texts() {
  std::unique_lock guard(lock_);
  for (;;) {
    wake_.wait(guard, [this] { return waiting_ || over_; });
    if (over_)
      return;
    const auto x = std::move(*std::exchange(waiting_, std::nullopt));
    guard.unlock();
    auto text = std::make_shared<std::string>(x.first);
    if (x.report)
      *text += report::to_metrics(*x.report, {.motes = motes_});
    {
      const std::lock_guard served(newest_->lock);
      newest_->text = std::move(text);
    }
    guard.lock();
  }
}

} // namespace rubicon::cli
