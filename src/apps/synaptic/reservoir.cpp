#include "apps/synaptic/reservoir.hpp"

#include <algorithm>
#include <cmath>

#include "core/numbers/math.hpp"
#include "stream/sensor_record.hpp"

namespace rubicon::apps {

namespace {

constexpr duration sense_pause =
    10s; ///< before transducers that could not be opened are tried again

double tanh(double x) {
  return 1 - 2 / (math::exp(2 * x) + 1);
}

} // namespace

reservoir::reservoir(reservoir_config config, random_stream rng)
    : synaptic_application(config.from, config.to), config_(std::move(config)),
      senses_(config_.transducers.size()), states_(config_.units) {
  std::size_t remote = 0;
  for (const auto& x : config_.from)
    remote += x.size;
  for (std::size_t i = 0; i < config_.units; ++i) {
    auto& row = weights_.emplace_back();
    for (std::size_t k = 0; k < senses_.size() + states_.size() + remote; ++k)
      row.push_back(2 * rng.unit() - 1);
    double sum = 0; // of a row of the units' own weights: its greatest bounds the spectral radius
    for (std::size_t k = 0; k < states_.size(); ++k)
      sum += std::abs(row[senses_.size() + k]);
    for (std::size_t k = 0; k < states_.size(); ++k)
      row[senses_.size() + k] *= config_.radius / sum;
  }
}

void reservoir::joined(communication::island_octet island, std::uint16_t mote,
                       communication::status success) {
  synaptic_application::joined(island, mote, success);
  if (success == communication::SUCCESS)
    open_senses();
}

/// Those that are not.
void reservoir::open_senses() {
  senses_due_.reset();
  for (std::size_t i = 0; i < senses_.size(); ++i) {
    auto& x = senses_[i];
    if (x.stream > 0)
      continue;
    x.stream = layer().open_sensor(static_cast<std::uint8_t>(config_.transducers[i]), 0,
                                   stream::sampling::on_demand);
    if (x.stream < 0)
      lose(x);
  }
}

void reservoir::lose(sense& x) {
  ++senses_refused_;
  x.stream = -1;
  senses_due_ = layer().now() + sense_pause;
}

void reservoir::clock_tick(std::uint32_t) {
  if (all_open())
    count_tick();
  if (senses_due_ && *senses_due_ <= layer().now())
    open_senses();
  awaited_ = 0;
  for (const auto& x : senses_) {
    if (x.stream > 0 &&
        layer().read(x.stream, stream::sensor_record::size) == communication::SUCCESS)
      ++awaited_;
  }
  if (awaited_ == 0)
    compute();
}

void reservoir::readDone(int stream, byte_view record, communication::status success) {
  const auto x = std::ranges::find(senses_, stream, &sense::stream);
  if (x == senses_.end() || awaited_ == 0)
    return;
  const auto read = stream::decode_sensor_record(record);
  if (success == communication::SUCCESS && read) {
    const double value = read->value;
    x->least = x->is_known ? std::min(x->least, value) : value;
    x->most = x->is_known ? std::max(x->most, value) : value;
    x->is_known = true;
    const auto range = x->most - x->least;
    x->value = range > 0 ? 2 * (value - x->least) / range - 1 : 0;
  } else if (success ==
             communication::FAIL) { // in an actor of its own it learns only now that it is refused
    layer().close(stream);
    lose(*x);
  }
  if (--awaited_ == 0)
    compute();
}

void reservoir::compute() {
  std::vector<double> inputs;
  for (const auto& x : senses_)
    inputs.push_back(x.value);
  inputs.insert(inputs.end(), states_.begin(), states_.end());
  for (const auto& x : ends()) {
    for (std::uint8_t i = 0; !x.is_out && i < x.what.size; ++i) {
      const auto value = x.is_open ? layer().read_input(x.channel, i) : 0.0F;
      inputs.push_back(std::isnan(value) ? 0 : value);
    }
  }
  for (std::size_t i = 0; i < states_.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < inputs.size(); ++k)
      sum += weights_[i][k] * inputs[k];
    states_[i] += config_.leak * (tanh(sum) - states_[i]);
  }
  std::vector<double> outputs;
  if (!senses_.empty())
    outputs.push_back(senses_.front().value);
  outputs.insert(outputs.end(), states_.begin(), states_.end());
  for (const auto& x : ends()) {
    for (std::uint8_t i = 0; x.is_out && x.is_open && i < x.what.size; ++i)
      layer().write_output(x.channel, i,
                           i < outputs.size() ? static_cast<float>(outputs[i]) : 0.0F);
  }
}

std::vector<figure> reservoir::figures() const {
  auto all = synaptic_application::figures();
  all.push_back({"transducer opens failed", static_cast<double>(senses_refused_)});
  return all;
}

} // namespace rubicon::apps
