// Figures as people read them. No locale is asked: equal figures give equal text everywhere.
#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"

namespace rubicon::report {

/// Decimal with a comma every three digits: `1,234,567`.
[[nodiscard]] std::string with_thousands(std::uint64_t x);

/// Fixed point with `decimals` digits after the point, a comma every three before it: `1,020.042`.
/// Not finite: `–`.
[[nodiscard]] std::string fixed(double x, int decimals);

/// The share in percent, one decimal: `99.8%`. Never rounded up to `100.0%` nor down to `0.0%`
/// when it is not: `>99.9%`, `<0.1%`. `whole` 0: `–`.
[[nodiscard]] std::string percent(double part, double whole);

/// How many times faster than real time: `714 ×`, `1.0 ×`, `12,345 ×`. `wall_s` 0: `–`.
[[nodiscard]] std::string speed_factor(duration simulated, double wall_s);

/// A length of real time: `1.2 ms`, `0.84 s`, `2 min 05 s`, `3 h 10 min`.
[[nodiscard]] std::string real_time(double wall_s);

/// A length of the run and when it began: `8 h 24 min from 1:51:13`.
[[nodiscard]] std::string span_text(duration length, instant from);

/// A time of a run in whole seconds: `0:05`, `12:30`, from an hour on `1:02:03`.
[[nodiscard]] std::string clock_text(duration x);

/// The same to the millisecond, as whatever people read shows a time of a run: `12:30.004`,
/// `1:02:03.004`.
[[nodiscard]] std::string run_time(instant x);

/// A life time given in hours: `7.5 h`, `31 d`, `1.4 y`. Not finite or negative: `–`.
[[nodiscard]] std::string life_time(double hours);

/// A size in octets: `812 B`, `12.3 kB`, `4.5 MB` (powers of 1000).
[[nodiscard]] std::string octet_size(std::uint64_t octets);

/// `1 mote`, `2 motes`: `noun` in the singular, its plural with an s.
[[nodiscard]] std::string counted(std::uint64_t count, const std::string& noun);

} // namespace rubicon::report
