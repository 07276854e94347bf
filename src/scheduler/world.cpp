#include "scheduler/world.hpp"

#include "io/loop.hpp"

namespace rubicon::scheduler {

world::world(world_options options)
    : own_loop_(options.loop == nullptr ? std::make_unique<io::loop>() : nullptr),
      loop_(options.loop == nullptr ? own_loop_.get() : options.loop),
      config_(std::make_unique<coordinator_config>(coordinator_options{
          options.mode, options.speed, loop_, options.threads, options.in_order})) {
  if (options.configure)
    options.configure(*config_);
  system_ = std::make_unique<caf::actor_system>(*config_);
  // Its destructor would wait for actors that only this thread could end.
  system_->await_actors_before_shutdown(false);
  coordinator_ = coordinator::of(*system_);
  if (options.trace) {
    trace_.start(coordinator_->clock());
    coordinator_->trace(&trace_);
  }
}

world::~world() {
  shutdown();
}

void world::shutdown() {
  if (!system_)
    return;
  trace_.stop();
  last_stats_ = coordinator_->stats();
  coordinator_->close_clock();
  coordinator_->kill_all();
  loop_->poll(); // what the dying states have closed in the loop
  coordinator_->kill_all();
  coordinator_->detach_io();
  own_loop_.reset(); // callbacks left in it may own handles, so it goes before the actor system
  coordinator_ = nullptr;
  system_.reset();
}

statistics world::stats() const {
  return coordinator_ != nullptr ? coordinator_->stats() : last_stats_;
}

} // namespace rubicon::scheduler
