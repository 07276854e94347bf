// A script and its node: commands, events, timers, reports, and how it ends.
#include <array>
#include <string>

#include "support/catch.hpp"
#include "unit/script/node.hpp"

using namespace rubicon;
using communication::SUCCESS;
using script::scripted;
using script::texts;

TEST_CASE("a script gives the commands of the Mockup interface", "[script][MCK-01]") {
  scripted x("print(layer.send(OWN_ISLAND, GATEWAY, '\\1\\2', 9, true), layer.send(4, 3, '', 8))\n"
             "print(layer.provide(7), layer.set_actuator('fan', 1))\n"
             "layer.hold(7) layer.release(7)\n"
             "print(layer.read_transducers{'temperature', 'signal', 9})\n"
             "print(layer.create_syn_channel_out(OWN_ISLAND, 3, 4), "
             "layer.create_syn_channel_in(6, 3, 4, 2))\n"
             "print(layer.start_syn_channel(3), layer.write_output(3, 1, 0.5), "
             "layer.read_input(3, 2), layer.stop_syn_channel(3), layer.dispose_syn_channel(3))\n"
             "print(layer.open_remote(6, 3, 20, 1000), layer.open_write_end(6, GATEWAY, 21), "
             "layer.open_sensor('light', 500), layer.open_local())\n"
             "print(layer.read(3, 4), layer.write(3, 'abc'), layer.has_ended(3), "
             "layer.latency_bound(3), layer.close(3))\n"
             "print(layer.now(), layer.network_time(), layer.address())");
  x.node.time = instant(1500ms);
  CHECK(x.start() == texts{"7 7", "true true", "true", "3 3", "true true 2.5 true true", "3 3 3 3",
                           "true true false 0.25 true", "1.5 nil 5 2"});
  CHECK(x.node.commands == texts{"send 255/65533 type 9 reliable 1 2",
                                 "send 4/3 type 8",
                                 "provide 7",
                                 "set_actuator fan 1",
                                 "hold 7",
                                 "release 7",
                                 "read_transducers 0 8 9",
                                 "create_syn_channel out 255/3 4 1",
                                 "create_syn_channel in 6/3 4 2",
                                 "start 3",
                                 "write_output 3 1 0.500000",
                                 "stop 3",
                                 "dispose 3",
                                 "open read 6/3 20 1000",
                                 "open write 6/65533 21 0",
                                 "open_sensor 2 500",
                                 "open_local",
                                 "read 3 4",
                                 "write 3 3",
                                 "close 3"});
}

TEST_CASE("commands that fail give nil or false", "[script]") {
  scripted x("print(layer.send(1, 2, '', 9), layer.provide(7), layer.open_local(), "
             "layer.write(3, ''))");
  x.node.accepts = false;
  CHECK(x.start() == texts{"nil false nil false"});
}

TEST_CASE("wrong arguments are errors of the script", "[script]") {
  for (const std::string text :
       {"layer.send(1, 2, 'x', 256)", "layer.send(-1, 2, 'x', 1)", "layer.send(1, 70000, 'x', 1)",
        "layer.send(1, 2, {}, 1)", "layer.provide()", "layer.read_transducers{'warmth'}",
        "layer.read_transducers{32}", "layer.read_transducers{}", "layer.set_actuator('fan', 1.5)",
        "every(0, print)", "every(1, 1)", "after(0/0, print)", "figure('', 1)",
        "figure('events', 1)", "figure('x', 1/0)", "figure('x\\n', 1)"}) {
    INFO(text);
    scripted x(text);
    CHECK(x.failure_of_start().find("test.lua:1: ") == 0);
    CHECK(x.node.commands.empty());
  }
}

TEST_CASE("events call the functions of their names", "[script][MCK-02]") {
  scripted x("for _, name in ipairs{'createSynChannelOutDone', 'createSynChannelInDone', "
             "'syn_input_update', 'clock_tick', 'synChannelFailed', 'openRemoteDone', 'readDone', "
             "'ack', 'ackOf', 'receive', 'actuatorChanged', 'initCommunicationsDone', 'joined', "
             "'moteJoined'} do _G[name] = function(...) print(name, ...) end end\n"
             "function transducersRead(c, t) print(#c, c[1], c[2], t) end\n"
             "function outputsWanted(all) print(#all, all[1].channel, all[1].period_ms) end");
  REQUIRE(x.start().empty());
  auto& p = x.program;
  const bytes octets{'a', 0};
  p.createSynChannelOutDone(1, SUCCESS);
  p.createSynChannelInDone(2, communication::FAIL);
  p.syn_input_update(2, 3, synaptic::input_status::missed);
  p.clock_tick(4'000'000'000);
  p.synChannelFailed(1);
  p.openRemoteDone(1, 20, SUCCESS);
  p.readDone(1, bytes{'a'}, SUCCESS);
  p.ack(SUCCESS);
  p.ackOf(7, SUCCESS);
  p.receiveFrom({island_id{1000}, mote_id{2}}, bytes{'b'}, 9);
  p.receive(0, 0, {}, 9, communication::FAIL);
  p.actuatorChanged("fan", 1, true);
  p.joined(5, 2, SUCCESS);
  p.moteJoined(3, bytes{'c'});
  p.transducersRead(std::array<std::int16_t, 2>{-5, 300}, 12);
  p.outputsWanted(std::array{communication::output_wanted{1, 500ms}});
  CHECK(p.take_notices() ==
        texts{"createSynChannelOutDone 1 true", "createSynChannelInDone 2 false",
              "syn_input_update 2 3 false", "clock_tick 4000000000", "synChannelFailed 1",
              "openRemoteDone 1 20 true", "readDone 1 a true", "ack true", "ackOf 7 true",
              "receive 1000 2 b 9 true", "receive 0 0  9 false", "actuatorChanged fan 1 true",
              "joined 5 2 true", "moteJoined 3 c", "2 -5 300 12", "1 1 500"});
  CHECK(p.figures().at(0) == apps::figure{"events", 17});
  CHECK(p.wants_ticks());
  CHECK_FALSE(scripted("function joined() end").program.wants_ticks());
}

TEST_CASE("timers expire in the order of their times", "[script]") {
  scripted x("every(2, function() print('every', layer.now()) end)\n"
             "local a = after(3, function() print('after', layer.now()) end)\n"
             "local b = after(4, function() print('never') end)\n"
             "after(2, function() print(cancel(b), cancel(b)) end)");
  CHECK(x.start().empty());
  CHECK(x.run_for(6s) == texts{"every 2.0", "true false", "after 3.0", "every 4.0", "every 6.0"});
  CHECK(x.program.deadline() == instant(8s));
}

TEST_CASE("timers of a node's later life begin with its start", "[script]") {
  scripted x("after(2, function() print(layer.now()) end)");
  x.node.time = instant(60s);
  x.start();
  CHECK(x.program.deadline() == instant(62s));
  CHECK(x.run_for(2s) == texts{"62.0"});
}

TEST_CASE("a timer that comes late expires once", "[script]") {
  scripted x("every(1, function() print(layer.now()) end)");
  x.start();
  x.node.time = instant(3500ms);
  x.program.on_time(x.node.time);
  CHECK(x.program.take_notices() == texts{"3.5"});
  CHECK(x.program.deadline() == instant(4s));
}

TEST_CASE("timers, notices and figures have limits", "[script]") {
  CHECK(scripted("for i = 1, 16 do after(1, print) end").failure_of_start().empty());
  CHECK_FALSE(scripted("for i = 1, 17 do after(1, print) end").failure_of_start().empty());
  CHECK(scripted("for i = 1, 16 do print(i) end").failure_of_start().empty());
  CHECK_FALSE(scripted("for i = 1, 17 do print(i) end").failure_of_start().empty());
  CHECK(scripted("for i = 1, 40 do figure('f' .. i % 16, i) end").failure_of_start().empty());
  CHECK_FALSE(scripted("for i = 1, 17 do figure('f' .. i, i) end").failure_of_start().empty());
  CHECK(scripted("print(('x'):rep(1000))").start().at(0).size() < 300);
}

TEST_CASE("a script has what its file sets, warns and reports", "[script]") {
  scripted x("warn('hot', settings.limit)\nfigure('fans', 2)\nprint(settings.other)", 1, {},
             {{"limit", 25.5}});
  CHECK(x.start() == texts{"nil"});
  CHECK(x.program.take_warnings() == texts{"event=script text=\"hot 25.5\""});
  CHECK(x.program.figures().back() == apps::figure{"fans", 2, false});
}

TEST_CASE("a script that has failed does nothing any more", "[script]") {
  scripted x("every(1, function() print('runs') end)\n"
             "function joined() local x = nil + 1 end");
  x.start();
  const auto text = scripted::failure_of([&] { x.program.joined(5, 2, SUCCESS); });
  CHECK(text.find("test.lua:2: attempt to perform arithmetic on a nil value") == 0);
  CHECK_FALSE(x.program.deadline());
  x.program.on_time(instant(5s));
  x.program.joined(5, 2, SUCCESS);
  CHECK(x.program.take_notices().empty());
}

TEST_CASE("a failure of an event inside a command ends the script after it", "[script]") {
  scripted x("function ack() error('inside') end\n"
             "pcall(layer.provide, 7) print('goes on')");
  x.node.at_command = [&] { x.program.ack(SUCCESS); };
  const auto text = x.failure_of_start();
  CHECK(text.find("test.lua:1: inside") == 0);
  CHECK(x.program.take_notices().empty());
}
