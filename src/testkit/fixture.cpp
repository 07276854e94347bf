#include "testkit/fixture.hpp"

#include <algorithm>
#include <stdexcept>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

namespace rubicon::test {

fixture::fixture(delivery when)
    : logger_before_(spdlog::default_logger()),
      mail_(when == delivery::when_asked, [this](mail::letter x, duration length) {
        static_cast<void>(world_.scheduler().supervisor().schedule(now() + length, std::move(x.to),
                                                                   std::move(x.content)));
      }) {
  auto logger = std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_st>(log_));
  logger->set_pattern("%v");
  spdlog::set_default_logger(std::move(logger));
  world_.scheduler().supervisor().watch().tap = &mail_;
}

fixture::~fixture() {
  mail_.close();
  world_.shutdown();
  spdlog::set_default_logger(logger_before_);
}

void fixture::begin(scheduler::actor& who, std::string path) {
  mail_.add(who, path);
  who.attach_functor([ends = ends_, path = std::move(path)](const caf::error& reason) {
    ends->push_back({path, caf::to_string(reason)});
  });
  settle();
}

/// With delivery::when_asked only what has been delivered is handled.
void fixture::settle() {
  if (!world_.drain())
    throw failure("actors keep each other busy without end");
  throw_what_scripts_threw();
}

void fixture::throw_what_scripts_threw() {
  if (thrown_)
    std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void fixture::run() {
  constexpr std::size_t messages_max = 1'000'000; // as drain() has it
  for (std::size_t i = 0; step(); ++i)
    if (i == messages_max)
      throw failure("actors keep each other busy without end; on their way are\n" + mail_.text());
  throw_what_scripts_threw();
}

bool fixture::step() {
  if (!mail_.deliver_first())
    return false;
  settle();
  return true;
}

void fixture::pass(duration length) {
  must_hold();
  world_.run_for(length);
}

void fixture::run_for(duration length) {
  const auto latest = now() + length;
  run();
  while (mail_.holds()) {
    const auto next = world_.scheduler().next_timeout();
    if (!next || *next > latest)
      break;
    world_.run_until(*next);
    run();
  }
  world_.run_until(latest);
  run();
}

bool fixture::run_until(const std::function<bool()>& done, duration limit, duration step) {
  const auto latest = now() + limit;
  while (!done() && now() < latest)
    run_for(std::min(step, latest - now()));
  return done();
}

void fixture::must_hold() const {
  if (!mail_.holds())
    throw std::logic_error("messages are delivered at once: make the fixture with "
                           "delivery::when_asked");
}

const mail::letter& fixture::expected(const message_pattern& x) {
  must_hold();
  if (const auto* letter = mail_.next(x))
    return *letter;
  throw failure("expected " + mail_.text(x) + ", but " + mail_.text_of_next(x) +
                (mail_.empty() ? "" : "\non their way are\n" + mail_.text()));
}

bool fixture::allowed(const message_pattern& x) {
  must_hold();
  const auto* letter = mail_.next(x);
  if (letter == nullptr)
    return false;
  mail_.deliver(*letter);
  settle();
  return true;
}

void fixture::disallowed(const message_pattern& x) {
  must_hold();
  if (mail_.find(x) != nullptr)
    throw failure("there should be no " + mail_.text(x) + ", but on their way are\n" +
                  mail_.text());
}

void fixture::expect_nothing() {
  must_hold();
  if (!mail_.empty())
    throw failure("there should be no messages, but on their way are\n" + mail_.text());
}

std::size_t fixture::logged(std::string_view text) const {
  std::istringstream lines(log_.str());
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);)
    count += line.find(text) != std::string::npos ? 1U : 0U;
  return count;
}

} // namespace rubicon::test
