#include "proxy/classes/layout.hpp"

#include <algorithm>
#include <cmath>

#include "core/codec.hpp"
#include "core/text/decimal.hpp"

namespace rubicon::proxy {

namespace {

std::int64_t read_count(byte_reader& in, encoding layout) {
  switch (layout) {
  case encoding::u8:
    return in.big<std::uint8_t>();
  case encoding::i8:
    return in.big<std::int8_t>();
  case encoding::u16:
    return in.big<std::uint16_t>();
  case encoding::i16:
    return in.big<std::int16_t>();
  case encoding::u32:
  case encoding::stamp:
    return in.big<std::uint32_t>();
  case encoding::i32:
    return in.big<std::int32_t>();
  }
  return 0;
}

std::optional<std::int64_t> count_in(const field& what, byte_view payload) {
  byte_reader in(payload);
  in.skip(what.offset);
  const auto count = read_count(in, what.layout);
  return in.ok() ? std::optional(count) : std::nullopt;
}

std::string text_of(const field& what, std::int64_t count) {
  if (what.words.empty())
    return decimal_text(static_cast<double>(count) * what.scale + what.add, what.decimals);
  const auto word = std::find_if(what.words.begin(), what.words.end(),
                                 [&](const auto& x) { return x.first == count; });
  return word == what.words.end() ? std::to_string(count) : word->second;
}

bytes octets_for(encoding layout, std::int64_t count) {
  byte_writer out;
  switch (octets_of(layout)) {
  case 1:
    out.big(static_cast<std::uint8_t>(count));
    break;
  case 2:
    out.big(static_cast<std::uint16_t>(count));
    break;
  default:
    out.big(static_cast<std::uint32_t>(count));
  }
  return out.finish();
}

} // namespace

std::pair<std::int64_t, std::int64_t> range_of(encoding x) {
  switch (x) {
  case encoding::u8:
    return {0, 255};
  case encoding::i8:
    return {-128, 127};
  case encoding::u16:
    return {0, 65535};
  case encoding::i16:
    return {-32768, 32767};
  case encoding::u32:
  case encoding::stamp:
    return {0, 4294967295};
  case encoding::i32:
    return {-2147483648, 2147483647};
  }
  return {};
}

std::size_t octets_of(encoding x) {
  switch (x) {
  case encoding::u8:
  case encoding::i8:
    return 1;
  case encoding::u16:
  case encoding::i16:
    return 2;
  case encoding::u32:
  case encoding::i32:
  case encoding::stamp:
    return 4;
  }
  return 0;
}

bool reads(const proxy_class& what, reading_source from) {
  return std::any_of(what.fields.begin(), what.fields.end(),
                     [&](const auto& x) { return x.source() == from; });
}

bool reads_times(const proxy_class& what) {
  return !what.stamped_channels.empty() || std::ranges::any_of(what.fields, [](const field& x) {
    return x.layout == encoding::stamp || x.stream.has_value();
  });
}

std::vector<stream_input> streams_of(const proxy_class& what) {
  std::vector<stream_input> all;
  for (const auto& field : what.fields)
    if (field.stream &&
        std::ranges::find(all, field.stream->number, &stream_input::number) == all.end())
      all.push_back(*field.stream);
  return all;
}

result<field_counts> counts_in(const proxy_class& what, std::uint16_t channel, byte_view payload) {
  field_counts counts;
  for (const auto& field : what.fields) {
    if (field.source() != channel)
      continue;
    const auto count = count_in(field, payload);
    if (!count)
      return errc::truncated;
    counts.emplace_back(&field, *count);
  }
  return counts;
}

std::optional<std::uint32_t> stamp_in(const proxy_class& what, std::uint16_t channel,
                                      byte_view payload) {
  if (std::ranges::find(what.stamped_channels, channel) == what.stamped_channels.end())
    return std::nullopt;
  std::size_t needed = octets_of(encoding::stamp);
  for (const auto& x : what.fields)
    if (!x.stream && x.channel == channel && x.layout != encoding::stamp)
      needed = std::max(needed, x.offset + octets_of(x.layout) + octets_of(encoding::stamp));
  if (payload.size() < needed)
    return std::nullopt;
  byte_reader in(payload.last(octets_of(encoding::stamp)));
  return in.big<std::uint32_t>();
}

reading reading_of(const field& what, std::int64_t count) {
  return {what.name, text_of(what, count), what.unit};
}

result<std::vector<reading>> decode(const proxy_class& what, std::uint16_t channel,
                                    byte_view payload) {
  const auto counts = counts_in(what, channel, payload);
  if (!counts)
    return errc::truncated;
  std::vector<reading> readings;
  for (const auto& [field, count] : *counts)
    readings.push_back(reading_of(*field, count));
  return readings;
}

result<bytes> encode(const input& what, std::string_view word) {
  const auto found = std::find_if(what.words.begin(), what.words.end(),
                                  [&](const auto& x) { return x.first == word; });
  if (found != what.words.end())
    return found->second;
  const auto number = what.numbers ? number_in(word) : std::nullopt;
  if (!number || *number < what.numbers->min || *number > what.numbers->max)
    return errc::bad_value;
  const auto& form = *what.numbers;
  const auto [least, most] = range_of(form.layout);
  const auto count = std::floor((*number - form.add) / form.scale + 0.5);
  return octets_for(form.layout,
                    static_cast<std::int64_t>(
                        std::clamp(count, static_cast<double>(least), static_cast<double>(most))));
}

} // namespace rubicon::proxy
