// A shared library with one object and no code, as far as a firmware is judged.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/bytes.hpp"
#include "core/codec.hpp"

namespace rubicon::test {

#if defined(__aarch64__)
inline constexpr std::uint16_t elf_machine = 183;
#elif defined(__riscv)
inline constexpr std::uint16_t elf_machine = 243;
#else
inline constexpr std::uint16_t elf_machine = 62;
#endif

/// File header, program header, three section headers, two symbols, their names, the object.
/// @param name of the object, whose first 8 octets are version and flags
[[nodiscard]] inline bytes elf_file(std::uint32_t version, std::uint32_t flags = 0,
                                    std::string_view name = "rubicon_mote_firmware") {
  constexpr std::uint64_t segments = 64;
  constexpr std::uint64_t sections = segments + 56;
  constexpr std::uint64_t symbols = sections + 3 * 64;
  constexpr std::uint64_t names = symbols + 2 * 24;
  const auto names_size = 1 + name.size() + 1;
  const auto object = names + names_size;
  constexpr std::uint64_t loaded_to = 0x2000;
  const auto u16 = [](unsigned x) { return static_cast<std::uint16_t>(x); };
  const auto u32 = [](unsigned x) { return static_cast<std::uint32_t>(x); };
  byte_writer out;
  out.append(bytes{0x7f, 'E', 'L', 'F', 2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  out.little(u16(3)).little(elf_machine).little(u32(1)).little(std::uint64_t{0});
  out.little(segments).little(sections).little(u32(0));
  out.little(u16(64)).little(u16(56)).little(u16(1)).little(u16(64)).little(u16(3)).little(u16(0));
  out.little(u32(1)).little(u32(6)).little(object).little(loaded_to).little(loaded_to);
  out.little(std::uint64_t{8}).little(std::uint64_t{8}).little(std::uint64_t{8});
  const auto section = [&](std::uint32_t type, std::uint64_t at, std::uint64_t size,
                           std::uint32_t linked) {
    out.little(u32(0)).little(type).little(std::uint64_t{0}).little(std::uint64_t{0});
    out.little(at).little(size).little(linked).little(u32(0));
    out.little(std::uint64_t{1}).little(std::uint64_t{0});
  };
  section(0, 0, 0, 0);
  section(11, symbols, 2 * 24, 2);
  section(3, names, names_size, 0);
  out.append(bytes(24));
  out.little(u32(1)).octet(0x11).octet(0).little(u16(1)).little(loaded_to).little(std::uint64_t{8});
  out.octet(0).append(to_bytes(name)).octet(0);
  out.little(version).little(flags);
  return out.finish();
}

} // namespace rubicon::test
