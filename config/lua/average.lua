-- Samples every second and sends the mean of each `samples` counts to the gateway, rounded.
local sum, number = 0, 0

function transducersRead(counts)
  sum, number = sum + counts[1], number + 1
  if number < settings.samples then
    return
  end
  local mean = math.floor(sum / number + 0.5)
  sum, number = 0, 0
  layer.send(OWN_ISLAND, GATEWAY, string.pack(">i2", mean), 1)
end

every(1, function() layer.read_transducers{"temperature"} end)
