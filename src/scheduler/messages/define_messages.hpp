// Included by the files that define types of messages, and by no other: what is folded, printed and
// copied of each follows from its fields (core/describe/content.hpp).
//
//   template void rubicon::scheduler::define_messages<air_interface>();
//
// defines all messages that an interface takes. A type that several interfaces take is defined by
// each of them, and is the same.
#pragma once

#include "core/describe/content.hpp"
#include "scheduler/messages/envelope.hpp"
#include "scheduler/messages/ref.hpp"

namespace rubicon::scheduler {

template <class Message>
const message_type type_of<Message>::value{
    struct_name<Message>,
    [](const envelope& x, fold64& into) {
      fold_content(into, static_cast<const carrier<Message>&>(x).content);
    },
    [](const envelope& x, std::string& out) {
      print_content(out, static_cast<const carrier<Message>&>(x).content);
    },
    [](const envelope& x) { return content_size(static_cast<const carrier<Message>&>(x).content); },
    [](const envelope& x) {
      return make_envelope(static_cast<const carrier<Message>&>(x).content);
    },
    [](envelope* x) noexcept { delete static_cast<carrier<Message>*>(x); }};

template <class... Messages>
void define_all(message_list<Messages...>) {
  (static_cast<void>(type_of<Messages>::value.index()), ...);
}

template <class Interface>
void define_messages() {
  define_all(typename Interface::messages{});
}

} // namespace rubicon::scheduler
