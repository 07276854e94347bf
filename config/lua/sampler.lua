-- Sends the temperature, with the time of sampling, to the gateway every `every` seconds.
local timer

local function sample()
  layer.read_transducers{"temperature"}
end

local function begin()
  sample()
  timer = every(settings.every, sample)
end

function joined(island, mote, success)
  if timer then
    cancel(timer)
    timer = nil
  end
  if success then -- at a random phase: motes that join together do not send together
    timer = after(0.001 + math.random() * settings.every, begin)
  end
end

function transducersRead(counts, time_ms)
  layer.send(OWN_ISLAND, GATEWAY, string.pack(">i2I4", counts[1], time_ms), 1)
end
