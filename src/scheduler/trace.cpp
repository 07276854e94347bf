#include "scheduler/trace.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <caf/abstract_actor.hpp>
#include <caf/actor.hpp>
#include <caf/actor_addr.hpp>
#include <caf/actor_cast.hpp>
#include <caf/error.hpp>
#include <caf/group.hpp>
#include <caf/system_messages.hpp>
#include <caf/type_nr.hpp>
#include <cxxabi.h>

#include "scheduler/fold_serializer.hpp"
#include "scheduler/process.hpp"
#include "scheduler/run_clock.hpp"

namespace rubicon::scheduler {

namespace {

/// CAF's own types that say which actor, process, request or timer by a number CAF made up.
constexpr std::array numbered_by_caf = {
    caf::type_nr<caf::actor>::value,           caf::type_nr<std::vector<caf::actor>>::value,
    caf::type_nr<caf::actor_addr>::value,      caf::type_nr<std::vector<caf::actor_addr>>::value,
    caf::type_nr<caf::down_msg>::value,        caf::type_nr<caf::downstream_msg>::value,
    caf::type_nr<caf::exit_msg>::value,        caf::type_nr<caf::group>::value,
    caf::type_nr<caf::group_down_msg>::value,  caf::type_nr<caf::message>::value,
    caf::type_nr<caf::message_id>::value,      caf::type_nr<caf::node_id>::value,
    caf::type_nr<caf::open_stream_msg>::value, caf::type_nr<caf::strong_actor_ptr>::value,
    caf::type_nr<caf::timeout_msg>::value,     caf::type_nr<caf::upstream_msg>::value,
    caf::type_nr<caf::weak_actor_ptr>::value,
};

constexpr auto error_number = caf::type_nr<caf::error>::value;

/// How the Itanium ABI begins the name of every caf::typed_actor.
constexpr std::string_view typed_handle_prefix = "N3caf11typed_actorI";

/// A message's name without the namespaces in which it is kept today; of templates the whole name.
std::string lasting_name(const std::type_info& x) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(x.name(), nullptr, nullptr, &status), &std::free);
  const std::string_view name = status == 0 ? text.get() : x.name();
  const auto last = name.find('<') == name.npos ? name.rfind("::") : name.npos;
  return std::string(last == name.npos ? name : name.substr(last + 2));
}

const traced_base* traced_in(const caf::strong_actor_ptr& x) {
  return x ? dynamic_cast<const traced_base*>(caf::actor_cast<caf::abstract_actor*>(x)) : nullptr;
}

} // namespace

void trace_recorder::start(const caf::actor_clock& clock, bool shared) {
  clock_ = &clock;
  shared_ = shared;
  home_ = std::this_thread::get_id();
}

void trace_recorder::stop() {
  const auto lock = guard();
  clock_ = nullptr;
}

std::unique_lock<std::mutex> trace_recorder::guard() const {
  return shared_ ? std::unique_lock(mutex_) : std::unique_lock<std::mutex>();
}

void trace_recorder::record(trace_part& part, traced_base& to, const caf::mailbox_element& x,
                            bool heard) {
  if (!shared_ && executed_process == nullptr && std::this_thread::get_id() != home_)
    return;
  const auto cause = provenance().number();
  const auto lock = guard();
  if (clock_ == nullptr)
    return;
  const auto time = to_instant(clock_->now());
  part.fold(to.fold_, time, x.content());
  if (!observer_ && !to.is_watched_)
    return;
  const auto* sender = observer_ ? traced_in(x.sender) : nullptr; // costs as much as all the rest
  const auto number = wants_remarks() ? ++numbers_given_ : 0;
  if (number != 0)
    numbers_[&x] = number;
  const delivery seen{
      time,        to.path(), sender != nullptr ? std::string_view(sender->path()) : "",
      x.content(), number,    cause,
      heard};
  if (to.is_watched_)
    watcher_(seen);
  if (observer_)
    observer_(seen);
}

void trace_recorder::note(remark x) {
  x.cause = provenance().number();
  if (!shared_ && std::this_thread::get_id() != home_)
    return;
  const auto lock = guard();
  if (clock_ == nullptr)
    return;
  x.time = to_instant(clock_->now());
  remark_observer_(x);
}

std::uint64_t trace_recorder::begin(std::string_view path, std::string_view what,
                                    std::uint64_t id) {
  const auto number = [&] {
    const auto lock = guard();
    return ++numbers_given_;
  }();
  note({.time = {}, .path = path, .what = what, .id = id, .octets = {}, .number = number});
  return number;
}

std::uint64_t trace_recorder::number_of(const caf::mailbox_element* x) const {
  const auto lock = guard();
  const auto found = x != nullptr ? numbers_.find(x) : numbers_.end();
  return found != numbers_.end() ? found->second : 0;
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

void trace_part::fold(std::uint64_t& of, instant time, const caf::type_erased_tuple& content) {
  ++events_;
  fold64 next(of);
  next.add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
  fold(next, content);
  sum_ += next.value() - of;
  of = next.value();
}

void trace_part::fold(fold64& into, const caf::type_erased_tuple& content) {
  fold_serializer sink(into);
  const auto size = content.size();
  into.add(size);
  for (std::size_t i = 0; i < size; ++i) {
    const auto type = content.type(i);
    const auto entry = entry_of(type);
    into.add(entry.hash);
    if (type.first == error_number) {
      // The context of an error may hold anything.
      const auto& error = content.get_as<caf::error>(i);
      into.add(error.code()).add(static_cast<std::uint64_t>(error.category()));
    } else if (!entry.opaque) {
      // An error ends the folding of this element, the same way in every run.
      static_cast<void>(content.save(i, sink));
    }
  }
}

trace_part::type_entry trace_part::entry_of(caf::rtti_pair type) {
  if (type.second != nullptr && type.second == last_type_)
    return last_entry_;
  if (type.second == nullptr)
    return entry_of_number(type.first);
  const auto [i, added] = named_types_.try_emplace(type.second);
  if (added) {
    const auto name = lasting_name(*type.second);
    i->second = {fold64().add(std::string_view(name)).value(),
                 std::string_view(type.second->name()).starts_with(typed_handle_prefix)};
  }
  last_type_ = type.second;
  last_entry_ = i->second;
  return i->second;
}

trace_part::type_entry trace_part::entry_of_number(std::uint16_t number) {
  if (numbered_types_.empty())
    numbered_types_.resize(caf::type_nrs);
  auto& entry = numbered_types_[number];
  if (entry.hash == 0) {
    const std::string_view name = caf::numbered_type_names[number - 1];
    entry = {fold64().add(name).value(), std::ranges::count(numbered_by_caf, number) != 0};
  }
  return entry;
}

void traced_base::place(std::string path, process& where, trace_recorder* recorder) {
  path_ = std::move(path);
  path_hash_ = fold64().add(std::string_view(path_)).value();
  fold_ = path_hash_;
  process_ = &where;
  recorder_ = path_.empty() ? nullptr : recorder;
  is_watched_ = recorder_ != nullptr && recorder_->watches(path_);
}

trace_part& traced_base::part() const {
  return process_->trace();
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
