#include "apps/application.hpp"

#include "apps/average.hpp"
#include "apps/recorder.hpp"
#include "apps/streams/stream_reader.hpp"
#include "apps/streams/stream_switch.hpp"
#include "apps/streams/stream_writer.hpp"
#include "apps/synaptic/readout.hpp"
#include "apps/synaptic/reservoir.hpp"

namespace rubicon::apps {

namespace {

struct maker {
  random_stream rng;

  std::unique_ptr<application> operator()(const stream_writer_config& x) const {
    return std::make_unique<stream_writer>(x, rng);
  }
  std::unique_ptr<application> operator()(const stream_reader_config& x) const {
    return std::make_unique<stream_reader>(x);
  }
  std::unique_ptr<application> operator()(const reservoir_config& x) const {
    return std::make_unique<reservoir>(x, rng);
  }
  std::unique_ptr<application> operator()(const readout_config& x) const {
    return std::make_unique<readout>(x);
  }
  std::unique_ptr<application> operator()(const average_config& x) const {
    return std::make_unique<average>(x);
  }
  std::unique_ptr<application> operator()(const stream_switch_config& x) const {
    return std::make_unique<stream_switch>(x);
  }
  std::unique_ptr<application> operator()(const recorder_config& x) const {
    return std::make_unique<recorder>(x);
  }
  std::unique_ptr<application> operator()(const custom_config& x) const {
    return x.kind->make(x.values, rng);
  }
};

} // namespace

std::unique_ptr<application> make_application(const app_config& config, random_stream rng) {
  return std::visit(maker{rng}, config);
}

} // namespace rubicon::apps
