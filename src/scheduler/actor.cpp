#include "scheduler/actor.hpp"

#include <typeinfo>

#include <caf/exit_reason.hpp>
#include <caf/sec.hpp>
#include <caf/send.hpp>
#include <caf/type_nr.hpp>

#include "scheduler/coordinator.hpp"
#include "scheduler/process.hpp"

namespace rubicon::scheduler {

namespace {

/// What CAF itself sends: exits, ends of others.
struct system_message {
  caf::mailbox_element_ptr element;
};

std::string_view name_of(caf::rtti_pair type) {
  return type.second != nullptr ? type.second->name() : caf::numbered_type_names[type.first - 1];
}

const caf::type_erased_tuple& content_of(const envelope& x) {
  return x.as<system_message>()->element->content();
}

/// Its content names actors by numbers that CAF made up.
void fold_types(const envelope& x, fold64& into) {
  const auto& content = content_of(x);
  for (std::size_t i = 0; i < content.size(); ++i)
    into.add(name_of(content.type(i)));
}

} // namespace

template <>
const message_type type_of<system_message>::value{
    "system_message",
    fold_types,
    [](const envelope& x, std::string& out) { out += content_of(x).stringify(); },
    [](const envelope&) { return std::size_t{0}; }, // it names actors: no length of its own
    nullptr,
    [](envelope* x) noexcept { delete static_cast<carrier<system_message>*>(x); }};

caf::error failure_of(const std::exception_ptr& x) {
  try {
    std::rethrow_exception(x);
  } catch (const std::exception& e) {
    return caf::make_error(caf::sec::runtime_error, std::string(e.what()));
  } catch (...) {
    return caf::make_error(caf::sec::runtime_error, std::string("unknown exception"));
  }
}

// -- being sent to

void actor::deliver(envelope_ptr x, actor* from) {
  if (from != nullptr)
    x->sender = from->id();
  auto& its = *where();
  if (&its != executed_process) {
    auto* const here = its.owner().sender_here();
    if (here != &its) {
      timeout crossing{caf::strong_actor_ptr(ctrl()), std::move(x),
                       caf::strong_actor_ptr(from != nullptr ? from->ctrl() : nullptr)};
      if (here != nullptr)
        here->send(its, std::move(crossing), {});
      else
        its.owner().clock().schedule(instant{}, std::move(crossing));
      return;
    }
  }
  if (auto* const tap = its.watch().tap; tap != nullptr && tap->takes(*this, x, from))
    return;
  const bool ended = has_ended();
  record(*x, from, !ended);
  if (ended) {
    if (provenance_here.account != nullptr)
      note_lost_copy();
    return;
  }
  if (provenance_here.account != nullptr)
    x->account = account_ref(provenance_here.account);
  mailbox_.push(std::move(x));
  if (!is_ready_) {
    is_ready_ = true;
    its.queue().push(*this);
  }
}

/// A copy of a message has come to an actor that is no more.
void actor::note_lost_copy() {
  const provenance copy;
  const turn_of here(source());
  note_loss(copy, loss::node_stopped);
}

void actor::enqueue(caf::mailbox_element_ptr x, caf::execution_unit*) {
  deliver(make_envelope(system_message{std::move(x)}), nullptr);
}

// -- sending

instant actor::now() const {
  return to_instant(where()->owner().clock().now());
}

void actor::send_at(instant due, caf::strong_actor_ptr to, envelope_ptr x) {
  where()->owner().clock().schedule(due,
                                    {std::move(to), std::move(x), caf::strong_actor_ptr(ctrl())});
}

void post_at(const caf::strong_actor_ptr& to, instant due, envelope_ptr x) {
  actor_at(to)->where()->owner().clock().schedule(due, {to, std::move(x)});
}

void post_exit(const caf::strong_actor_ptr& to, caf::exit_reason reason) {
  if (to)
    caf::anon_send_exit(to, reason);
}

// -- turns

void actor::launch(caf::execution_unit*, bool, bool) {
  is_ready_ = true;
  where()->owner().sender_here()->queue().push(*this);
}

actor::turn_result actor::take_turn(std::size_t messages_max) {
  const turn_of provenance_turn(source());
  const turn its_turn(*this);
  if (has_ended())
    return turn_result::ended;
  if (!has_begun()) {
    begun_ = true;
    carry_out([this] { behavior_ = begin(); });
  }
  for (; messages_max > 0 && !mailbox_.empty(); --messages_max) {
    const auto x = mailbox_.pop();
    current_ = x.get();
    turn_of::handles(x->number, x->account);
    carry_out([this, &x] { receive(*x); });
    turn_of::handles_nothing();
    current_ = nullptr;
  }
  if (!mailbox_.empty())
    return turn_result::has_more;
  is_ready_ = false;
  return has_ended() ? turn_result::ended : turn_result::waits;
}

template <class Action>
void actor::carry_out(Action action) {
  try {
    action();
  } catch (...) {
    fail(std::current_exception());
  }
  if (quits_)
    finish();
}

void actor::receive(envelope& x) {
  if (behavior_.handle(x))
    return;
  const auto* const system = x.as<system_message>();
  assert(system != nullptr); // nothing else can be sent that is not taken
  handle_system_message(*system->element);
}

void actor::handle_system_message(caf::mailbox_element& x) {
  auto& content = x.content();
  if (content.match_elements<caf::exit_msg>())
    on_exit_message(content.get_as<caf::exit_msg>(0));
  else if (content.match_elements<caf::down_msg>() && hooks_ && hooks_->on_down)
    hooks_->on_down(content.get_as<caf::down_msg>(0));
}

void actor::on_exit_message(const caf::exit_msg& x) {
  if (x.reason != caf::exit_reason::kill && hooks_ && hooks_->on_exit)
    hooks_->on_exit(x);
  else if (x.reason) // who ends in good order takes nobody along
    quit(x.reason);
}

// -- ending

actor::handlers& actor::hooks() {
  if (!hooks_)
    hooks_ = std::make_unique<handlers>();
  return *hooks_;
}

void actor::quit(caf::error reason) {
  quits_ = true;
  reason_ = std::move(reason);
}

void actor::fail(std::exception_ptr why) {
  try {
    quit(hooks_ && hooks_->on_exception ? hooks_->on_exception(why) : failure_of(why));
  } catch (...) {
    quit(failure_of(std::current_exception()));
  }
}

void actor::kill() {
  if (has_ended())
    return;
  quit(caf::make_error(caf::exit_reason::kill));
  finish();
}

void actor::finish() {
  if (has_ended())
    return;
  const turn_of provenance_turn(source());
  const stopping its_copies;
  on_exit();
  cleanup(std::move(reason_), context());
  mailbox_.clear();
}

void actor::on_exit() {
  destroy_state(); // its last words are still taken
  behavior_.clear();
  hooks_.reset();
  ended_ = true;
}

} // namespace rubicon::scheduler
