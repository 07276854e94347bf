#include "cli/run/message_reader.hpp"

#include <algorithm>
#include <utility>

#include "cli/print/console.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

message_reader::message_reader(const std::string& path, bound most,
                               std::shared_ptr<view::timeline> to)
    : record_(path, /*keeps_view=*/false), most_(std::move(most)), to_(std::move(to)),
      thread_([this] { run(); }) {
  to_->set_why_no_messages("The record is being read.");
  to_->set_on_messages([this] { ask(); });
}

message_reader::~message_reader() {
  to_->set_on_messages({});
  stopped_ = true;
  {
    const std::lock_guard guard(lock_); // it waits, or has not asked yet whether it is to
  }
  wake_.notify_one();
  thread_.join();
}

void message_reader::ask() {
  {
    const std::lock_guard guard(lock_);
    asked_ = true;
  }
  wake_.notify_one();
}

void message_reader::finish() {
  {
    const std::lock_guard guard(lock_);
    over_ = true;
  }
  wake_.notify_one();
}

void message_reader::run() {
  auto rests_until = steady::now();
  std::unique_lock guard(lock_);
  const auto is_urgent = [this] { return stopped_ || over_; };
  for (bool is_whole = false; !is_whole;) {
    wake_.wait(guard, [&] { return asked_ || is_urgent(); });
    wake_.wait_until(guard, rests_until, is_urgent);
    if (stopped_)
      return;
    is_whole = over_;
    asked_ = false;
    guard.unlock();
    const auto begun = steady::now();
    read(is_whole);
    const auto ended = steady::now();
    rests_until = ended + std::max<steady::duration>(age, rest_factor * (ended - begun));
    guard.lock();
  }
}

void message_reader::read(bool is_whole) {
  const auto until = steady::now() + reading_time_max;
  const auto may_go_on = [&] {
    return !stopped_ && (is_whole || (record_.octets() < most_.octets && steady::now() < until));
  };
  while (may_go_on() && record_.read_part()) {
  }
  if (stopped_)
    return;
  if (is_whole)
    record_.finish();
  show(is_whole);
}

void message_reader::show(bool is_whole) {
  const auto& problem = record_.problem();
  const bool is_new = record_.octets() != octets_shown_ || is_whole;
  if (record_.has_begun() && is_new)
    to_->set(std::make_shared<const view::message_list>(
        std::make_shared<const explain::traces>(is_whole ? record_.result() : record_.so_far()),
        is_whole));
  octets_shown_ = record_.octets();
  const bool is_beyond = record_.octets() >= most_.octets && (!is_whole || most_.is_of_record);
  to_->set_why_no_messages(!problem.empty()      ? problem
                           : is_beyond           ? most_.beyond
                           : record_.has_begun() ? ""
                                                 : "Nothing is recorded yet.");
  if (!problem.empty() && is_whole)
    static_cast<void>(print(stderr, printable(problem) + '\n'));
}

} // namespace rubicon::cli
