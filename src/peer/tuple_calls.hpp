// How a program uses tuples of a peer that it drives by itself.
#pragma once

#include <functional>
#include <string_view>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peer/callback_table.hpp"
#include "peer/callbacks.hpp"
#include "peis/kernel/kernel.hpp"

namespace rubicon::peer {

class standalone;

/// Names in brackets are those of D1.1 3.1.3; the causes are described in
/// peis/kernel/tuple_commands.hpp. Who is subscribed to an own tuple, and whether a value still
/// waits for room: standalone::kernel(), peis::tuple_reader.
class tuple_calls {
public:
  /// All outlive this.
  tuple_calls(standalone& peer, peis::kernel& kernel, callback_table& callbacks)
      : peer_(peer), kernel_(kernel), callbacks_(callbacks) {}

  /// [setTuple] Sets one of our own. Never waits: the next value takes the place of one that waits.
  [[nodiscard]] peis::cause set(std::string_view key, peis::tuple_content content);
  [[nodiscard]] peis::cause remove(std::string_view key);

  /// [insertTuple] Sets a tuple with all its fields. `then` is called once with how it ended; what
  /// is known at once is returned as well.
  peis::cause insert(peis::tuple draft, outcome_callback then = {});

  /// [appendTupleByAbstract] Adds to what matches.
  peis::cause append(const peis::prototype& wanted, payload added, outcome_callback then = {});

  /// [setRemoteTuple] Asks its owner.
  peis::cause set_remote(peer_id owner, std::string_view key, peis::tuple_content content,
                         outcome_callback then = {});
  peis::cause remove_remote(peer_id owner, std::string_view key, outcome_callback then = {});

  /// [subscribe, subscribeByAbstract] `changed` is called for each set, `deleted` for each end.
  [[nodiscard]] watch_result subscribe(peer_id owner, std::string_view pattern,
                                       tuple_callback changed = {}, tuple_callback deleted = {});
  [[nodiscard]] watch_result subscribe(const peis::prototype& wanted, tuple_callback changed = {},
                                       tuple_callback deleted = {});
  /// [registerTupleCallback, ...ByAbstract] The same for what others have subscribed to.
  [[nodiscard]] watch_result register_callback(const peis::prototype& wanted,
                                               tuple_callback changed, tuple_callback deleted = {});
  void unsubscribe(peis::subscription_id id);

  /// [getTuple, getTupleByAbstract] What is held here.
  [[nodiscard]] peis::reading get(peer_id owner, std::string_view key,
                                  peis::read_mode mode = peis::read_mode::keep_old);
  [[nodiscard]] peis::reading get(const peis::prototype& wanted,
                                  peis::read_mode mode = peis::read_mode::keep_old);
  /// [getTuple, blocking] Waits until it is here. Needs a subscription, except for own tuples.
  [[nodiscard]] peis::reading get(peer_id owner, std::string_view key, peis::read_mode mode,
                                  duration timeout);
  /// [getTuples, getTuplesByAbstract] Appends what is held here.
  void get_all(const peis::prototype& wanted, peis::result_set& into,
               peis::read_mode mode = peis::read_mode::keep_old);

private:
  using watch_command =
      std::function<peis::outputs(peis::subscription_id, peis::request_id, instant)>;
  [[nodiscard]] watch_result watch(const watch_command& command, tuple_callback changed,
                                   tuple_callback deleted);

  standalone& peer_;
  peis::kernel& kernel_;
  callback_table& callbacks_;
};

} // namespace rubicon::peer
