#include "support/virtual_world.hpp"

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

namespace rubicon::test {

virtual_world::virtual_world() : logger_before_(spdlog::default_logger()) {
  auto logger = std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_st>(log_));
  logger->set_pattern("%v");
  spdlog::set_default_logger(std::move(logger));
}

virtual_world::~virtual_world() {
  world_.shutdown();
  spdlog::set_default_logger(logger_before_);
}

bool virtual_world::run_until(const std::function<bool()>& done, duration limit, duration step) {
  const auto latest = now() + limit;
  while (!done() && now() < latest)
    run_for(std::min(step, latest - now()));
  return done();
}

void virtual_world::follow(std::string path_prefix) {
  world_.trace().observe([this, prefix = std::move(path_prefix)](const scheduler::delivery& x) {
    if (x.path.starts_with(prefix))
      followed_.push_back(std::string(x.path) + ' ' + x.content.stringify());
  });
}

std::size_t virtual_world::logged(std::string_view text) const {
  std::istringstream lines(log_.str());
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);)
    count += line.find(text) != std::string::npos ? 1U : 0U;
  return count;
}

} // namespace rubicon::test
