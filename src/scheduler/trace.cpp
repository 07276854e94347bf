#include "scheduler/trace.hpp"

#include "scheduler/process.hpp"
#include "scheduler/run_clock.hpp"

namespace rubicon::scheduler {

std::optional<instant> trace_recorder::now() const {
  return clock_ == nullptr ? std::nullopt : std::optional(to_instant(clock_->now()));
}

void trace_recorder::notify(instant time, std::string_view to, std::string_view from, envelope& x,
                            bool received, bool is_watched) {
  if (!observer_ && !is_watched)
    return;
  if (wants_remarks())
    x.number = ++numbers_given_;
  const delivery seen{time, to, from, x, x.number, provenance().number(), received};
  if (is_watched)
    watcher_(seen);
  if (observer_)
    observer_(seen);
}

void trace_recorder::note(remark x) {
  x.cause = provenance().number();
  if (clock_ == nullptr)
    return;
  x.time = to_instant(clock_->now());
  remark_observer_(x);
}

std::uint64_t trace_recorder::begin(std::string_view path, std::string_view what,
                                    std::uint64_t id) {
  const auto number = ++numbers_given_;
  note({.time = {}, .path = path, .what = what, .id = id, .octets = {}, .number = number});
  return number;
}

std::uint64_t trace_recorder::hash() const {
  std::uint64_t sum = 0;
  for (const auto& x : parts_)
    sum += x->sum();
  return fold64().add(sum).value();
}

std::uint64_t trace_recorder::events() const {
  std::uint64_t sum = 0;
  for (const auto& x : parts_)
    sum += x->events();
  return sum;
}

// -- what one process folds

void trace_part::fold(std::uint64_t& of, instant time, const envelope& message) {
  ++events_;
  fold64 next(of);
  next.add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
  next.add(message.type().name_hash());
  message.type().fold(message, next);
  sum_ += next.value() - of;
  of = next.value();
}

void traced_base::place(std::string path, process& where, trace_recorder* recorder) {
  path_hash_ = fold64().add(std::string_view(path)).value();
  fold_ = path_hash_;
  process_ = &where;
  recorder_ = path.empty() ? nullptr : recorder;
  is_watched_ = recorder_ != nullptr && recorder_->watches(path);
  if (recorder_ != nullptr) {
    path_ = &recorder_->messages().path(path);
  } else {
    own_path_ = std::make_unique<std::string>(std::move(path));
    path_ = own_path_.get();
  }
}

const std::string& traced_base::path() const {
  static const std::string nowhere;
  return path_ != nullptr ? *path_ : nowhere;
}

instant traced_base::time() const {
  return process_->now();
}

void traced_base::record(envelope& x, const traced_base* from, bool received) {
  const auto time = recorder_ == nullptr ? std::nullopt : recorder_->now();
  if (!time)
    return;
  part().fold(fold_, *time, x);
  recorder_->notify(*time, path(), from != nullptr ? std::string_view(from->path()) : "", x,
                    received, is_watched_);
}

trace_part& traced_base::part() const {
  return *process_->watch().trace;
}

traced_base::turn::turn(traced_base& whose) : process_(whose.process_) {
  if (process_ != nullptr)
    before_ = process_->acting(&whose);
}

traced_base::turn::~turn() {
  if (process_ != nullptr)
    static_cast<void>(process_->acting(before_));
}

} // namespace rubicon::scheduler
