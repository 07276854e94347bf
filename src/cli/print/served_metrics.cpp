#include "cli/print/served_metrics.hpp"

#include <optional>
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
    const std::lock_guard guard(shown->lock);
    return io::web_file{report::exposition::content_type, shown->text};
  };
  auto opened = io::web_server::open(std::move(site));
  if (const auto* why = std::get_if<std::string>(&opened))
    throw std::runtime_error(*why);
  server_ = std::move(std::get<io::web_server>(opened));
  if (!where.at.address.starts_with("127."))
    say("metrics are not encrypted, and anyone on the network can read them");
  say("metrics: http://" + (where.at.address == "0.0.0.0" ? "127.0.0.1" : where.at.address) + ':' +
      std::to_string(server_->port()) + "/metrics");
}

void served_metrics::show(const report::run_report& x) {
  auto text = report::to_metrics(x, {.motes = motes_});
  const std::lock_guard guard(newest_->lock);
  newest_->text = std::move(text);
}

} // namespace rubicon::cli
