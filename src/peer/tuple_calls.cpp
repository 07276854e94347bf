#include "peer/tuple_calls.hpp"

#include <utility>

#include "peer/standalone.hpp"

namespace rubicon::peer {

peis::cause tuple_calls::set(std::string_view key, peis::tuple_content content) {
  return peer_.call([&](auto& kernel, auto request, auto time) {
    return kernel.tuples().set(key, std::move(content), time, request);
  });
}

peis::cause tuple_calls::remove(std::string_view key) {
  return peer_.call([&](auto& kernel, auto request, auto time) {
    return kernel.tuples().remove(key, time, request);
  });
}

peis::cause tuple_calls::insert(peis::tuple draft, outcome_callback then) {
  return peer_.call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.tuples().insert(std::move(draft), time, request);
      },
      std::move(then));
}

peis::cause tuple_calls::append(const peis::prototype& wanted, payload added,
                                outcome_callback then) {
  return peer_.call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.tuples().append(wanted, std::move(added), time, request);
      },
      std::move(then));
}

peis::cause tuple_calls::set_remote(peer_id owner, std::string_view key,
                                    peis::tuple_content content, outcome_callback then) {
  return peer_.call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.tuples().set_remote(owner, key, std::move(content), request, time);
      },
      std::move(then));
}

peis::cause tuple_calls::remove_remote(peer_id owner, std::string_view key, outcome_callback then) {
  return peer_.call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.tuples().remove_remote(owner, key, request, time);
      },
      std::move(then));
}

watch_result tuple_calls::watch(const watch_command& command, tuple_callback changed,
                                tuple_callback deleted) {
  const auto id = callbacks_.add_watcher(std::move(changed), std::move(deleted));
  const auto why =
      peer_.call([&](auto&, auto request, auto time) { return command(id, request, time); });
  if (why == peis::cause::none)
    return id;
  callbacks_.remove_watcher(id);
  return why;
}

watch_result tuple_calls::subscribe(peer_id owner, std::string_view pattern, tuple_callback changed,
                                    tuple_callback deleted) {
  return watch(
      [&](auto id, auto request, auto time) {
        return kernel_.subscriptions().subscribe(owner, pattern, id, time, request);
      },
      std::move(changed), std::move(deleted));
}

watch_result tuple_calls::subscribe(const peis::prototype& wanted, tuple_callback changed,
                                    tuple_callback deleted) {
  return watch(
      [&](auto id, auto request, auto time) {
        return kernel_.subscriptions().subscribe(wanted, id, time, request);
      },
      std::move(changed), std::move(deleted));
}

watch_result tuple_calls::register_callback(const peis::prototype& wanted, tuple_callback changed,
                                            tuple_callback deleted) {
  return watch(
      [&](auto id, auto request, auto time) {
        return kernel_.subscriptions().register_callback(wanted, id, time, request);
      },
      std::move(changed), std::move(deleted));
}

void tuple_calls::unsubscribe(peis::subscription_id id) {
  callbacks_.remove_watcher(id);
  peer_.call([&](auto& kernel, auto request, auto time) {
    return kernel.subscriptions().unsubscribe(id, time, request);
  });
}

peis::reading tuple_calls::get(peer_id owner, std::string_view key, peis::read_mode mode) {
  return kernel_.reader().get(owner, key, mode, peer_.now());
}

peis::reading tuple_calls::get(const peis::prototype& wanted, peis::read_mode mode) {
  return kernel_.reader().get(wanted, mode, peer_.now());
}

peis::reading tuple_calls::get(peer_id owner, std::string_view key, peis::read_mode mode,
                               duration timeout) {
  auto found = get(owner, key, mode);
  peer_.run_until(
      [&] {
        if (!found && found.why == peis::cause::none)
          found = get(owner, key, mode);
        return found || found.why != peis::cause::none;
      },
      timeout);
  return found;
}

void tuple_calls::get_all(const peis::prototype& wanted, peis::result_set& into,
                          peis::read_mode mode) {
  kernel_.reader().get_all(wanted, into, peer_.now(), mode);
}

} // namespace rubicon::peer
