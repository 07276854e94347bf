#include "control/octets.hpp"

#include <array>
#include <cassert>
#include <cstddef>
#include <utility>
#include <variant>

#include "core/describe/field_codec.hpp"

namespace rubicon::control {

namespace {

/// Of what a question or an answer takes in memory: small things take more there than in transit.
constexpr std::size_t memory_per_octet = 4;
constexpr std::size_t memory_beside = std::size_t{64} << 20;

std::size_t memory_max_of(byte_view octets) {
  return memory_per_octet * octets.size() + memory_beside;
}

template <class Message>
bytes message_octets(const Message& x) {
  return std::visit([](const auto& each) { return encode_value(each); }, x);
}

template <class Message, std::size_t number>
result<Message> alternative_of(byte_view octets) {
  auto found =
      decode_value<std::variant_alternative_t<number, Message>>(octets, memory_max_of(octets));
  if (!found)
    return found.error();
  return Message(std::in_place_index<number>, *std::move(found));
}

template <class Message, std::size_t... number>
result<Message> message_of(std::size_t kind, byte_view octets,
                           std::index_sequence<number...> /*all*/) {
  constexpr std::array all{&alternative_of<Message, number>...};
  return kind < all.size() ? all.at(kind)(octets) : errc::bad_value;
}

template <class Message>
result<Message> message_of(std::size_t kind, byte_view octets) {
  return message_of<Message>(kind, octets,
                             std::make_index_sequence<std::variant_size_v<Message>>());
}

template <class T, class... Each>
constexpr std::uint8_t index_in(const std::variant<Each...>* /*of*/) {
  std::uint8_t index = 0;
  static_cast<void>(((std::is_same_v<T, Each> || (++index, false)) || ...));
  return index;
}

template <class... Question>
constexpr std::array<std::uint8_t, sizeof...(Question)>
answers_of(const std::variant<Question...>* /*of*/) {
  return {index_in<typename Question::answer>(static_cast<const deploy::answer*>(nullptr))...};
}

constexpr auto answer_kinds = answers_of(static_cast<const deploy::question*>(nullptr));

} // namespace

bytes octets_of(const report::part_report& x) {
  return encode_value(x);
}

bytes octets_of(const deploy::bundle& x) {
  return encode_value(x);
}

result<report::part_report> part_report_of(byte_view octets) {
  return decode_value<report::part_report>(octets);
}

result<deploy::bundle> bundle_of(byte_view octets) {
  return decode_value<deploy::bundle>(octets);
}

bytes octets_of(const deploy::question& x) {
  return message_octets(x);
}

bytes octets_of(const deploy::answer& x) {
  return message_octets(x);
}

result<deploy::question> question_of(std::uint8_t kind, byte_view octets) {
  return message_of<deploy::question>(kind, octets);
}

result<deploy::answer> answer_of(std::uint8_t kind, byte_view octets) {
  return message_of<deploy::answer>(kind, octets);
}

std::uint8_t answer_kind(std::uint8_t question_kind) {
  assert(question_kind < answer_kinds.size());
  return answer_kinds[question_kind];
}

} // namespace rubicon::control
