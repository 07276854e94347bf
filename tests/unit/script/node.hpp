// A node that writes down which commands a script gives, and one script on it.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "script/program.hpp"

namespace rubicon::script {

class recording_process final : public communication::synaptic_commands,
                                public communication::stream_commands,
                                public communication::message_commands,
                                public communication::node_commands {
public:
  using status = communication::status;

  std::vector<std::string> commands;
  instant time{};
  bool accepts = true;
  communication::process process{*this, *this, *this, *this};
  std::function<void()> at_command; ///< what comes about inside of each

  status refuse() override { return communication::FAIL; }
  int create(bool is_out, mote_address other, std::uint8_t size,
             const synaptic::parameters& x) override {
    return made(std::string("create_syn_channel ") + (is_out ? "out " : "in ") + to_string(other) +
                ' ' + std::to_string(size) + ' ' + std::to_string(x.divisor));
  }
  status dispose(int x) override { return done("dispose " + std::to_string(x)); }
  status start(int x) override { return done("start " + std::to_string(x)); }
  status stop(int x) override { return done("stop " + std::to_string(x)); }
  status write_output(int x, std::uint8_t k, float value) override {
    return done("write_output " + std::to_string(x) + ' ' + std::to_string(k) + ' ' +
                std::to_string(value));
  }
  float read_input(int, std::uint8_t index) override { return 0.5F + index; }
  int open_end(const communication::stream_end& x) override {
    return made(std::string("open ") + (x.writes_to_self ? "write " : "read ") +
                to_string(x.other) + ' ' + std::to_string(x.name) + ' ' +
                std::to_string(x.rate_ms));
  }
  int open_sensor(std::uint8_t transducer, std::uint32_t ms, stream::sampling) override {
    return made("open_sensor " + std::to_string(transducer) + ' ' + std::to_string(ms));
  }
  int open_local() override { return made("open_local"); }
  status close(int x) override { return done("close " + std::to_string(x)); }
  status read(int x, std::size_t n) override {
    return done("read " + std::to_string(x) + ' ' + std::to_string(n));
  }
  status write(int x, byte_view record) override {
    return done("write " + std::to_string(x) + ' ' + std::to_string(record.size()));
  }
  bool has_ended(int) const override { return false; }
  std::optional<duration> latency_bound(int) const override { return 250ms; }
  std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                    std::uint8_t am_type) override {
    std::string text;
    for (const auto x : octets)
      text += ' ' + std::to_string(x);
    if (done("send " + to_string(to) + " type " + std::to_string(am_type) +
             (reliable ? " reliable" : "") + text) == communication::FAIL)
      return std::nullopt;
    return 7;
  }
  status provide(std::uint8_t x) override { return done("provide " + std::to_string(x)); }
  void hold(std::uint8_t x) override { done("hold " + std::to_string(x)); }
  void release(std::uint8_t x) override { done("release " + std::to_string(x)); }
  status read_transducers(std::span<const device::quantity> kinds) override {
    std::string text = "read_transducers";
    for (const auto x : kinds)
      text += ' ' + std::to_string(static_cast<int>(x));
    return done(std::move(text));
  }
  status set_actuator(std::string_view name, std::uint8_t state) override {
    return done("set_actuator " + std::string(name) + ' ' + std::to_string(state));
  }
  status init() override { return communication::SUCCESS; }
  status join(byte_view) override { return communication::SUCCESS; }
  std::optional<mote_address> address() const override {
    return mote_address{island_id{5}, mote_id{2}};
  }
  instant now() const override { return time; }
  std::optional<duration> network_time() const override { return std::nullopt; }
  void leave() override {}

private:
  status done(std::string what) {
    commands.push_back(std::move(what));
    if (at_command)
      at_command();
    return communication::status_of(accepts);
  }
  int made(std::string what) { return done(std::move(what)) == communication::SUCCESS ? 3 : -1; }
};

class scripted {
public:
  explicit scripted(std::string text, std::uint64_t seed = 1, limits most = {},
                    settings values = {})
      : program(std::make_shared<const program_config>(
                    program_config{{"test.lua", std::move(text)}, most, std::move(values)}),
                random_stream(seed)) {}

  /// @returns what it has printed
  std::vector<std::string> start() {
    const auto now = std::exchange(node.time, instant{}); // as of a node that starts
    program.start(communication::interface(node.process), now);
    node.time = now;
    return program.take_notices();
  }
  /// @returns the failure; empty: none
  std::string failure_of_start() {
    return failure_of([this] { start(); });
  }
  template <class F>
  static std::string failure_of(F&& what) {
    try {
      what();
    } catch (const std::runtime_error& x) {
      return x.what();
    }
    return {};
  }
  std::vector<std::string> run_for(duration length) {
    std::vector<std::string> all;
    const auto end = node.time + length;
    for (auto due = program.deadline(); due && *due <= end; due = program.deadline()) {
      node.time = *due;
      program.on_time(node.time);
      for (auto& x : program.take_notices())
        all.push_back(std::move(x));
    }
    node.time = end;
    return all;
  }

  recording_process node;
  script::program program;
};

using texts = std::vector<std::string>;

/// What a script prints that is its main part alone.
inline texts output_of(std::string text, std::uint64_t seed = 1) {
  return scripted(std::move(text), seed).start();
}

} // namespace rubicon::script
