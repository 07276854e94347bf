// What actors send each other: one kind of envelope, whatever the message inside, and what is known
// of each type of message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/account/provenance.hpp"
#include "core/hash.hpp"
#include "scheduler/messages/envelope_pool.hpp"

namespace rubicon::scheduler {

class envelope;

struct envelope_deleter {
  void operator()(envelope* x) const noexcept;
};

using envelope_ptr = std::unique_ptr<envelope, envelope_deleter>;

/// What the scheduler, the trace and logs need to know of a type of message.
class message_type {
public:
  using folder = void (*)(const envelope&, fold64&);
  using printer = void (*)(const envelope&, std::string&);
  using measurer = std::size_t (*)(const envelope&);
  using copier = envelope_ptr (*)(const envelope&);
  using destroyer = void (*)(envelope*) noexcept;

  message_type(std::string_view name, folder folds, printer prints, measurer measures,
               copier copies, destroyer destroys)
      : fold(folds), print(prints), measure(measures), copy(copies), destroy(destroys), name_(name),
        name_hash_(fold64().add(name).value()), index_(types_so_far_++) {}
  message_type(const message_type&) = delete;
  message_type& operator=(const message_type&) = delete;

  /// `radio_send`
  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] std::uint64_t name_hash() const { return name_hash_; }

  /// Dense, from 0; another number in each program.
  [[nodiscard]] std::size_t index() const { return index_; }

  /// @pre all types are known: main() has begun
  [[nodiscard]] static std::size_t count() { return types_so_far_; }

  const folder fold;       ///< adds the content to a hash
  const printer print;     ///< appends it as text
  const measurer measure;  ///< octets that the content would take
  const copier copy;       ///< nullptr: it cannot be copied
  const destroyer destroy; ///< ends the envelope and gives back its memory

private:
  static inline std::size_t types_so_far_ = 0;

  std::string_view name_;
  std::uint64_t name_hash_;
  std::size_t index_;
};

/// The one object that stands for the type `Message`. It is defined by the file that includes
/// scheduler/messages/define_messages.hpp for it, so that all others compile without its
/// description.
template <class Message>
struct type_of {
  static const message_type value;
};

/// Owned by whom it is for, once it is sent. What it holds is behind it, in a `carrier`.
class envelope {
public:
  envelope(const envelope&) = delete;
  envelope& operator=(const envelope&) = delete;

  [[nodiscard]] const message_type& type() const { return *type_; }

  /// The message, if it is a `Message`; nullptr: it is not.
  template <class Message>
  [[nodiscard]] const Message* as() const;

  /// `name(field=value, ...)`
  [[nodiscard]] std::string text() const {
    std::string out;
    type_->print(*this, out);
    return out;
  }

  std::uint64_t sender = 0; ///< CAF's number of the actor; 0: nobody
  std::uint64_t number = 0; ///< of its delivery, if that is observed (delivery::number)
  account_ref account; ///< of the message that it is a copy of (core/account/message_ledger.hpp)
  envelope* next = nullptr; ///< in a mailbox

protected:
  explicit envelope(const message_type& type) : type_(&type) {}
  ~envelope() = default;

private:
  const message_type* type_;
};

inline void envelope_deleter::operator()(envelope* x) const noexcept {
  x->type().destroy(x);
}

template <class Message>
class carrier final : public envelope {
public:
  template <class... Args>
  explicit carrier(Args&&... args)
      : envelope(type_of<Message>::value), content{std::forward<Args>(args)...} {}
  ~carrier() = default;

  static void* operator new(std::size_t size) { return envelope_pool::take(size); }
  static void operator delete(void* x, std::size_t size) { envelope_pool::give(x, size); }

  Message content;
};

template <class Message>
const Message* envelope::as() const {
  return type_ == &type_of<Message>::value ? &static_cast<const carrier<Message>*>(this)->content
                                           : nullptr;
}

template <class Message>
[[nodiscard]] envelope_ptr make_envelope(Message&& x) {
  return envelope_ptr(new carrier<std::remove_cvref_t<Message>>(std::forward<Message>(x)));
}

} // namespace rubicon::scheduler
