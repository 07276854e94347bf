// The live page: shows a run of an ecology that `rubicon run FILE --view PORT` serves.
// What it and the server say to each other is described in docs/view.md.
//
// All names, keys, values and texts come from outside: they reach the page by textContent only.
"use strict";

// ------------------------------------------------------------------------------------------ helpers

const byId = (id) => document.getElementById(id);
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);

/** An element with attributes and children; texts become text nodes. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter((x) => x !== null && x !== undefined));
  return element;
}

/** A text without controls and marks that turn its neighbours round, at most `most` characters. */
function plain(text, most = 200) {
  const all = String(text ?? "");
  const cut = all.length > most ? all.slice(0, most - 1) + "…" : all;
  return cut.replace(/[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g, "\ufffd");
}

/** 754.5 -> "12:34.5"; the page's way to write ecology time. */
function timeText(seconds, decimals = 1) {
  if (!isNumber(seconds)) return "–";
  const scale = 10 ** decimals;
  const whole = Math.round(Math.abs(seconds) * scale) / scale;
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  const rest = (whole % 60).toFixed(decimals).padStart(decimals ? 3 + decimals : 2, "0");
  return (seconds < 0 ? "-" : "") + (hours ? `${hours}:${String(minutes).padStart(2, "0")}` : minutes) + ":" + rest;
}

/** The reverse: "90", "1:30", "1:02:03.5"; null if it is no time. */
function timeOf(text) {
  const parts = text.trim().split(":");
  if (parts.length > 3 || !parts.every((x) => /^\d+(\.\d+)?$/.test(x))) return null;
  return parts.reduce((sum, x) => sum * 60 + Number(x), 0);
}

const countText = (n) => (isNumber(n) ? Math.round(n).toLocaleString("en") : "–");
const shareText = (x) => (isNumber(x) ? (100 * x).toFixed(x === 1 ? 0 : 1) + "%" : "–");
const etxText = (x) => (isNumber(x) ? x.toFixed(2) : "–");

function hoursText(hours) {
  if (!isNumber(hours)) return "–";
  if (hours < 1) return Math.round(hours * 60) + " min";
  if (hours < 72) return hours.toFixed(hours < 10 ? 1 : 0) + " h";
  return countText(hours / 24) + " d";
}

const chargeText = (mah) => (isNumber(mah) ? mah.toPrecision(3).replace(/e.*/, "") + " mAh" : "–");

/** Runs one at a time; of what is wanted meanwhile, only the newest follows. */
function latest(run) {
  let busy = false;
  let again = false;
  return async function go() {
    again = true;
    if (busy) return;
    busy = true;
    try {
      while (again) {
        again = false;
        await run();
      }
    } finally {
      busy = false;
    }
  };
}

/** Calls at most once in `ms`, the last time after all calls. */
function throttled(ms, run) {
  let timer = 0;
  let last = -Infinity;
  return function call() {
    if (timer) return;
    timer = setTimeout(() => {
      timer = 0;
      last = performance.now();
      run();
    }, Math.max(0, last + ms - performance.now()));
  };
}

/** Index of the first of ascending `times` that is after `t`. */
function firstAfter(count, timeAt, t) {
  let low = 0;
  let high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeAt(middle) > t) high = middle;
    else low = middle + 1;
  }
  return low;
}

// ------------------------------------------------------------------------------------------- colours

const STATES = [ // in the order of their codes
  { name: "absent", label: "not yet there", colour: "soft" },
  { name: "joined", label: "joined", colour: "good" },
  { name: "asleep", label: "asleep", colour: "asleep" },
  { name: "lost", label: "lost, no route", colour: "poor" },
  { name: "off", label: "off", colour: "bad" },
  { name: "flat", label: "battery flat", colour: "flat" },
];
const LINKS = [ // classes of lines to parents
  { colour: "good", width: 2.6, dash: [] },
  { colour: "fair", width: 1.9, dash: [] },
  { colour: "poor", width: 1.6, dash: [8, 3] },
  { colour: "bad", width: 1.4, dash: [3, 3] },
  { colour: "soft", width: 0.8, dash: [] },
];
const SERIES_COLOURS = ["c1", "c0", "c4", "c2", "c3", "c5"];
const ENERGY_COLOURS = { listening: "c5", receiving: "c0", sending: "c1", off: "line", processor: "c2" };
const EVENT_SIGNS = { fault: "▲", violation: "◆", expectation: "○", event: "·" };

const colour = {};

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["bg", "fg", "soft", "line", "panel", "hover", "good", "fair", "poor", "bad", "asleep", "flat", "sink",
    "c0", "c1", "c2", "c3", "c4", "c5"])
    colour[name] = style.getPropertyValue("--" + name).trim();
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  readColours();
  sprites.clear();
  drawLegend();
  timeLine.base = null;
  redraw("scene", "time");
  refreshTab();
}

function firstTheme() {
  let kept = null;
  try { kept = localStorage.getItem("rubicon-theme"); } catch { /* no storage: as the computer is */ }
  return kept || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
}

function otherTheme() {
  const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  try { localStorage.setItem("rubicon-theme", theme); } catch { /* not kept then */ }
  setTheme(theme);
}

// ----------------------------------------------------------------------------------- what is known

/** The ecology as the server describes it, in arrays by the index of a mote. */
const model = {
  ecology: null, count: 0, names: [], ids: null, island: null, // island: index of each mote's island
  x: null, y: null, islands: [], peers: [], links: [], byAddress: new Map(), byName: new Map(),
};
/** How far the run is. */
const run = { now: 0, end: 0, running: false, events: 0, speed: 0, samples: 0, ended: false };
/** What the page shows. */
const shown = {
  at: 0, follow: true, playing: false, speed: 1, moment: null, counts: new Array(STATES.length).fill(0),
  chosen: null, tab: "events", explained: "", firstPicture_ms: 0,
};
const events = []; // {t, who, what, kind}, by time
let series = { times: [], lost: {}, used_mah: [] };

const mayControl = () => Boolean(model.ecology?.control);
const hasMessages = () => Boolean(model.ecology?.messages);
const runLength = () => Math.max(model.ecology?.length_s || 0, run.now, run.end || 0, 1e-3);

function takeEcology(x) {
  const same = model.ecology && model.ecology.name === x.name && model.ecology.command === x.command;
  model.ecology = x;
  takeMotes(x);
  takePeers(x);
  events.length = 0;
  frames.clear();
  curves.clear();
  energyOf.clear();
  layOut();
  if (!same) forgetView();
  showEcology();
  setFollowOnServer();
  askSeries();
  if (!shown.follow) wantMoment();
}

function takeMotes(x) {
  const islands = x.islands || [];
  model.count = islands.reduce((sum, each) => sum + each.motes.length, 0);
  model.names = new Array(model.count);
  for (const name of ["ids", "island", "parent"]) model[name] = new Int32Array(model.count);
  for (const name of ["x", "y", "wx", "wy"]) model[name] = new Float64Array(model.count);
  model.types = new Array(model.count);
  model.byAddress.clear();
  model.byName.clear();
  let index = 0;
  model.islands = islands.map((each, at) => {
    const island = { id: each.id, name: each.name, air: each.air ?? at, sink: each.sink || null, gateways: each.gateways || [],
      first: index, count: each.motes.length, byId: new Map(), folded: false, counts: new Array(STATES.length).fill(0) };
    for (const [id, name, mx, my, type] of each.motes) {
      model.ids[index] = id;
      model.island[index] = at;
      model.x[index] = mx;
      model.y[index] = my;
      model.names[index] = name.startsWith(each.name + "/") ? name.slice(each.name.length + 1) : name;
      model.types[index] = type || "";
      island.byId.set(id, index);
      model.byAddress.set(each.id + "/" + id, index);
      model.byName.set(fullName(index, island), index);
      index += 1;
    }
    return island;
  });
  model.carried = Object.entries(x.paths || {}).map(([key, path]) => ({ index: Number(key), path }))
    .filter((each) => each.index < model.count && each.path.length > 0);
  model.parent.fill(NO_PARENT);
}

function takePeers(x) {
  const names = new Map();
  model.peers = (x.peers || []).map((each, at) => {
    names.set(each.name, at);
    return { name: each.name, id: each.id, gateway: each.kind === "gateway", host: each.host || "", links: [], islands: [] };
  });
  model.links = [];
  for (const [a, b] of x.peis_links || []) {
    if (!names.has(a) || !names.has(b)) continue;
    model.links.push([names.get(a), names.get(b)]);
    model.peers[names.get(a)].links.push(names.get(b));
    model.peers[names.get(b)].links.push(names.get(a));
  }
  model.islands.forEach((island, at) => {
    for (const name of island.gateways)
      if (names.has(name)) model.peers[names.get(name)].islands.push(at);
  });
  model.peerOrder = peerOrder();
}

/** Peers so that those that are linked stand near each other: depth first from the first. */
function peerOrder() {
  const order = [];
  const seen = new Set();
  for (let start = 0; start < model.peers.length; ++start) {
    const stack = [start];
    while (stack.length) {
      const at = stack.pop();
      if (seen.has(at)) continue;
      seen.add(at);
      order.push(at);
      for (const next of [...model.peers[at].links].sort((a, b) => model.peers[b].links.length - model.peers[a].links.length))
        if (!seen.has(next)) stack.push(next);
    }
  }
  return order;
}

const islandOf = (index) => model.islands[model.island[index]];
const fullName = (index, island = islandOf(index)) => island.name + "/" + model.names[index];
const addressOf = (index) => islandOf(index).id + "/" + model.ids[index];

const NO_PARENT = -1;
const SINK = -2;

/** Takes a moment, asked for or pushed. */
function takeMoment(x) {
  const pushed = x.id === undefined;
  if (pushed && !shown.follow) return;
  if (pushed || shown.follow) shown.at = x.at_s;
  const motes = x.motes || {};
  for (const name of ["state", "parent", "hops", "etx", "signal", "used_mah", "hours", "delivery", "queue"])
    motes[name] ??= [];
  shown.moment = { sample_s: x.sample_s, motes, lost: x.lost || {} };
  shown.counts.fill(0);
  for (const island of model.islands) countStates(island, motes.state);
  for (let i = 0; i < model.count; ++i) model.parent[i] = parentOf(i, motes.parent[i]);
  redraw("scene", "time");
  showLegendCounts();
  refreshTab();
}

function countStates(island, state) {
  island.counts.fill(0);
  for (let i = island.first; i < island.first + island.count; ++i) {
    const code = STATES[state[i]] ? state[i] : 0;
    island.counts[code] += 1;
    shown.counts[code] += 1;
  }
}

function parentOf(index, id) {
  if (!id) return NO_PARENT;
  const island = islandOf(index);
  return island.sink && island.sink.id === id ? SINK : island.byId.get(id) ?? NO_PARENT;
}

function takeState(x) {
  const before = run.samples;
  Object.assign(run, { now: x.now_s ?? run.now, end: x.end_s ?? run.end, running: Boolean(x.running), events: x.events ?? run.events,
    speed: x.speed ?? 0, samples: x.samples ?? run.samples, ended: !x.running });
  for (const [t, who, what, kind] of x.new_events || []) events.push({ t, who, what, kind: kind || "event" });
  if (x.new_events?.length) {
    events.sort((a, b) => a.t - b.t);
    timeLine.base = null;
    if (shown.tab === "events") refreshTab();
  }
  if (shown.follow) shown.at = run.now;
  if (run.samples !== before) askSeriesSoon();
  showStatus();
  redraw("time");
}

const askSeries = latest(async () => {
  const answer = await ask({ ask: "series" }, "series");
  if (!answer) return;
  series = { times: answer.times || [], lost: answer.lost || {}, used_mah: answer.used_mah || [] };
  timeLine.base = null;
  showCauses();
  redraw("time");
});
const askSeriesSoon = throttled(1500, askSeries);

const wantMoment = latest(async () => {
  const answer = await ask({ ask: "moment", at_s: shown.at }, "moment");
  if (answer && !shown.follow) takeMoment(answer);
});

// --------------------------------------------------------------------------------------- connection

const connection = { socket: null, open: false, was: false, wait_s: 0.5, again_at: 0, next: 1, waiting: new Map() };

function connect() {
  const url = new URL("live", location.href);
  url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  url.search = url.hash = "";
  const socket = new WebSocket(url);
  connection.socket = socket;
  socket.addEventListener("open", () => {
    Object.assign(connection, { open: true, was: true, wait_s: 0.5 });
    showStatus();
  });
  socket.addEventListener("message", (event) => take(event.data));
  socket.addEventListener("close", lostConnection);
}

function lostConnection() {
  connection.open = false;
  for (const resolve of connection.waiting.values()) resolve(null);
  connection.waiting.clear();
  connection.again_at = performance.now() + connection.wait_s * 1000;
  setTimeout(connect, connection.wait_s * 1000);
  connection.wait_s = Math.min(connection.wait_s * 2, 8);
  showStatus();
}

function take(text) {
  let x;
  try { x = JSON.parse(text); } catch { return; }
  if (x.id !== undefined && connection.waiting.has(x.id)) {
    const resolve = connection.waiting.get(x.id);
    connection.waiting.delete(x.id);
    resolve(x);
  } else if (x.kind === "ecology") takeEcology(x);
  else if (x.kind === "state") takeState(x);
  else if (x.kind === "moment" && x.id === undefined) takeMoment(x);
}

function say(question) {
  if (connection.open) connection.socket.send(JSON.stringify(question));
}

/** @returns the answer if it is of this kind; null if it was refused or the connection is lost. */
async function ask(question, kind) {
  const answer = await askAny(question);
  return answer && answer.kind === kind ? answer : null;
}

function askAny(question) {
  if (!connection.open) return Promise.resolve(null);
  const id = connection.next++;
  return new Promise((resolve) => {
    connection.waiting.set(id, resolve);
    say({ ...question, id });
  });
}

/** Questions for what is in view only: few at a time, and the newest first. */
const lazy = { waiting: new Map(), flying: 0, most: 4, kept: 80 };

function askLazily(name, question, kind, then) {
  lazy.waiting.delete(name);
  lazy.waiting.set(name, { question, kind, then });
  if (lazy.waiting.size > lazy.kept) lazy.waiting.delete(lazy.waiting.keys().next().value);
  pumpLazy();
}

async function pumpLazy() {
  while (lazy.flying < lazy.most && lazy.waiting.size) {
    const [name, job] = [...lazy.waiting].pop();
    lazy.waiting.delete(name);
    lazy.flying += 1;
    ask(job.question, job.kind).then((answer) => {
      lazy.flying -= 1;
      job.then(answer);
      pumpLazy();
    });
  }
}

function setFollowOnServer() {
  say({ ask: "follow", on: shown.follow });
}

// ------------------------------------------------------------------------------------ moment shown

/** Shows the moment `t`; all parts of the page follow. */
function showAt(t, keepPlaying = false) {
  shown.at = clamp(t, 0, Math.max(run.now, 0));
  if (!keepPlaying) setPlaying(false);
  setFollow(false);
  moved();
  wantMoment();
}

/** The cursor is elsewhere: what depends on it without asking. */
function moved() {
  placeCarried();
  redraw("time", "map");
  showTime();
}

function setFollow(on) {
  if (shown.follow === on) return;
  shown.follow = on;
  setFollowOnServer();
  showTime();
}

function goLive() {
  setPlaying(false);
  shown.at = run.now;
  moved();
  if (shown.follow) return;
  wantMoment().then(() => setFollow(true));
}

function setPlaying(on) {
  if (on && shown.at >= run.now && !run.running) shown.at = 0;
  shown.playing = on;
  play.last = 0;
  if (on) setFollow(false);
  frames.clear();
  showTime();
  redraw("map");
}

const play = { last: 0, asked: 0 };

function advance(now_ms) {
  if (!shown.playing) return;
  const passed_s = play.last ? Math.min((now_ms - play.last) / 1000, 0.5) : 0;
  play.last = now_ms;
  shown.at = Math.min(shown.at + passed_s * shown.speed, run.now);
  if (now_ms - play.asked > 120) {
    play.asked = now_ms;
    wantMoment();
  }
  frames.lookAhead();
  moved();
  if (shown.at < run.now) return;
  if (run.running) goLive();
  else setPlaying(false);
}

const eventTime = (i) => events[i].t;

/** To the next event after the cursor, or the one before it. */
async function stepEvent(direction) {
  if (direction > 0) {
    const next = firstAfter(events.length, eventTime, shown.at + 1e-9);
    if (next < events.length) return showAt(events[next].t);
    const answer = await ask({ ask: "next_event", after_s: shown.at }, "next_event");
    if (answer?.event) showAt(answer.event[0]);
    return undefined;
  }
  const before = firstAfter(events.length, eventTime, shown.at - 1e-9) - 1;
  const equal = before >= 0 && events[before].t >= shown.at - 1e-9;
  const at = equal ? firstAfter(events.length, eventTime, events[before].t - 1e-6) - 1 : before;
  return showAt(at >= 0 ? events[at].t : 0);
}

const stepTime = (hundredths) => showAt(shown.at + (runLength() * hundredths) / 100);

const SPEEDS = [0.01, 0.1, 0.5, 1, 5, 10, 50, 100, 1000];

function setSpeed(speed) {
  shown.speed = speed;
  byId("speed").value = String(speed);
  frames.clear();
}

function changeSpeed(by) {
  setSpeed(SPEEDS[clamp(SPEEDS.indexOf(shown.speed) + by, 0, SPEEDS.length - 1)]);
}

/** Frames that are on their way while the page plays slowly. */
const frames = {
  list: [], to: 0, asking: false, round: 0,

  clear() {
    this.list = [];
    this.to = 0;
    this.round += 1;
    this.asking = false;
  },

  wanted() {
    return shown.playing && shown.speed <= 1 && hasMessages();
  },

  /** A frame is too short to be seen: it is drawn for at least this long. */
  least_s: () => 0.35 * shown.speed,

  async lookAhead() {
    const ahead_s = 1.5 * shown.speed;
    if (!this.wanted() || this.asking || this.to > shown.at + ahead_s) return;
    this.asking = true;
    const round = this.round;
    const from_s = Math.max(this.to, shown.at - this.least_s());
    const to_s = from_s + 2 * ahead_s;
    const answer = await ask({ ask: "frames", from_s, to_s }, "frames");
    if (round !== this.round) return;
    this.asking = false;
    const found = answer?.frames || [];
    this.to = found.length >= 500 ? found[found.length - 1][0] + 1e-6 : to_s;
    this.list = this.list.filter((each) => each[0] + each[1] + this.least_s() > shown.at).concat(found);
  },
};

// ------------------------------------------------------------------------------------ drawing, when

const dirty = new Set();
let framePending = false;
const frameTimes = [];

/** Asks for a picture: "scene" (all of the map), "map" (what lies over it), "time". */
function redraw(...what) {
  for (const each of what) dirty.add(each);
  if (framePending) return;
  framePending = true;
  requestAnimationFrame(drawFrame);
}

function drawFrame(now_ms) {
  framePending = false;
  if (shown.playing) advance(now_ms);
  const wanted = new Set(dirty);
  dirty.clear();
  if (wanted.has("scene")) scene.stale = true;
  if (wanted.has("scene") || wanted.has("map")) drawMap();
  if (wanted.has("time")) drawTimeLine();
  frameTimes.push(now_ms);
  while (frameTimes.length && frameTimes[0] <= now_ms - 1000) frameTimes.shift();
  if (shown.playing) redraw("map");
}

/** A canvas as large as its place, sharp on this screen. @returns its context, in CSS pixels. */
function fitCanvas(canvas, width, height) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const w = Math.max(1, Math.round(width * ratio));
  const h = Math.max(1, Math.round(height * ratio));
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  return ctx;
}

// --------------------------------------------------------------------------------- map: where things are

// World: metres, x to the right, y down, each air's ground beside the others. Screen: CSS pixels of
// the canvas; screen = world * scale + (ox, oy).
const view = { scale: 1, ox: 0, oy: 0, fitScale: 1, width: 0, height: 0, band: 0, placed: false };
const world = { airs: [], width: 1, height: 1 };
const plan = { image: null };

/** Gives each air its ground, and all motes and sinks their places in the world. */
function layOut() {
  const airs = new Map();
  for (const island of model.islands) {
    if (!airs.has(island.air)) airs.set(island.air, { islands: [], box: emptyBox(), first: airs.size === 0 });
    airs.get(island.air).islands.push(island);
  }
  world.airs = [...airs.values()];
  world.airs.forEach(measureAir);
  packAirs();
  for (const air of world.airs) placeIn(air);
  placeCarried();
  loadPlan();
  grid.build();
}

const emptyBox = () => ({ x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity });

function widen(box, x, y) {
  if (!isNumber(x) || !isNumber(y)) return;
  box.x0 = Math.min(box.x0, x);
  box.x1 = Math.max(box.x1, x);
  box.y0 = Math.min(box.y0, y);
  box.y1 = Math.max(box.y1, y);
}

function measureAir(air) {
  const { box } = air;
  for (const island of air.islands) {
    if (island.sink) widen(box, island.sink.x, island.sink.y);
    for (let i = island.first; i < island.first + island.count; ++i) widen(box, model.x[i], model.y[i]);
  }
  for (const { index, path } of model.carried)
    if (air.islands.includes(islandOf(index))) for (const [, x, y] of path) widen(box, x, y);
  if (air.first) { // the plan and the walls are those of the first air
    for (const [x1, y1, x2, y2] of model.ecology.walls || []) {
      widen(box, x1, y1);
      widen(box, x2, y2);
    }
    const p = model.ecology.plan;
    if (p) {
      widen(box, p.x_m, p.y_m);
      widen(box, p.x_m + p.width_m, p.y_m + p.height_m);
    }
  }
  if (box.x0 > box.x1) Object.assign(box, { x0: 0, y0: 0, x1: 1, y1: 1 });
  const margin = Math.max(0.5, 0.06 * Math.max(box.x1 - box.x0, box.y1 - box.y0));
  Object.assign(box, { x0: box.x0 - margin, y0: box.y0 - margin, x1: box.x1 + margin, y1: box.y1 + margin });
  air.width = box.x1 - box.x0;
  air.height = box.y1 - box.y0;
}

/** Airs stand in rows, from left to right, about half as high as wide in all. */
function packAirs() {
  const area = world.airs.reduce((sum, air) => sum + air.width * air.height, 0);
  const widest = Math.max(...world.airs.map((air) => air.width), 1);
  const rowWidth = Math.max(widest, Math.sqrt(area * 1.7) * 1.02);
  const gap = 0.16 * Math.sqrt(area / Math.max(world.airs.length, 1));
  let x = 0;
  let y = 0;
  let rowHeight = 0;
  world.width = 0;
  for (const air of world.airs) {
    if (x > 0 && x + air.width > rowWidth) {
      x = 0;
      y += rowHeight + gap;
      rowHeight = 0;
    }
    air.x = x;
    air.y = y;
    x += air.width + gap;
    rowHeight = Math.max(rowHeight, air.height);
    world.width = Math.max(world.width, x - gap);
  }
  world.height = y + rowHeight;
}

const worldX = (air, x) => air.x + x - air.box.x0;
const worldY = (air, y) => air.y + air.box.y1 - y; // the file's y grows upwards

function placeIn(air) {
  for (const island of air.islands) {
    island.ground = air;
    const box = emptyBox();
    for (let i = island.first; i < island.first + island.count; ++i) {
      model.wx[i] = worldX(air, model.x[i]);
      model.wy[i] = worldY(air, model.y[i]);
      widen(box, model.wx[i], model.wy[i]);
    }
    if (island.sink) {
      island.sx = worldX(air, island.sink.x);
      island.sy = worldY(air, island.sink.y);
      widen(box, island.sx, island.sy);
    }
    if (box.x0 > box.x1) Object.assign(box, { x0: air.x, x1: air.x + air.width, y0: air.y, y1: air.y + air.height });
    island.box = box;
    island.cx = (box.x0 + box.x1) / 2;
    island.cy = (box.y0 + box.y1) / 2;
    if (!island.sink) Object.assign(island, { sx: island.cx, sy: island.cy });
    const w = Math.max(box.x1 - box.x0, 0.1);
    const h = Math.max(box.y1 - box.y0, 0.1);
    island.spacing = Math.sqrt(Math.max(w * h, (w * w + h * h) / 20) / Math.max(island.count, 1));
  }
}

/** Carried motes are where their paths have them at the shown moment. */
function placeCarried() {
  for (const { index, path } of model.carried || []) {
    const [x, y] = pathAt(path, shown.at);
    const air = islandOf(index).ground;
    const wx = worldX(air, x);
    const wy = worldY(air, y);
    if (wx === model.wx[index] && wy === model.wy[index]) continue;
    model.wx[index] = wx;
    model.wy[index] = wy;
    redraw("scene");
  }
}

function pathAt(path, t) {
  const next = firstAfter(path.length, (i) => path[i][0], t);
  if (next === 0) return [path[0][1], path[0][2]];
  const [t1, x1, y1] = path[next - 1];
  if (next === path.length) return [x1, y1];
  const [t2, x2, y2] = path[next];
  const part = (t - t1) / (t2 - t1);
  return [x1 + part * (x2 - x1), y1 + part * (y2 - y1)];
}

function loadPlan() {
  if (!model.ecology.plan || plan.image) return;
  plan.image = new Image();
  plan.image.addEventListener("load", () => redraw("scene"));
  plan.image.src = "plan";
}

/** Finds motes near a place: cells of the world, each with its motes, in two flat arrays. */
const grid = {
  cell: 1, columns: 1, rows: 1, start: new Int32Array(2), items: new Int32Array(0),

  build() {
    const n = Math.max(model.count, 1);
    this.cell = Math.max(Math.sqrt((world.width * world.height) / n), 1e-6);
    this.columns = Math.floor(world.width / this.cell) + 1;
    this.rows = Math.floor(world.height / this.cell) + 1;
    this.start = new Int32Array(this.columns * this.rows + 1);
    this.items = new Int32Array(model.count);
    for (let i = 0; i < model.count; ++i) this.start[this.cellOf(i) + 1] += 1;
    for (let c = 0; c < this.columns * this.rows; ++c) this.start[c + 1] += this.start[c];
    const next = this.start.slice();
    for (let i = 0; i < model.count; ++i) this.items[next[this.cellOf(i)]++] = i;
  },

  cellOf(i) {
    return this.row(model.wy[i]) * this.columns + this.column(model.wx[i]);
  },
  column(x) { return clamp(Math.floor(x / this.cell), 0, this.columns - 1); },
  row(y) { return clamp(Math.floor(y / this.cell), 0, this.rows - 1); },

  /** Calls `visit` with each mote that may be within `r` of a place. Those carried are always asked. */
  near(x, y, r, visit) {
    for (const each of model.carried) visit(each.index);
    const last = this.column(x + r);
    for (let row = this.row(y - r); row <= this.row(y + r); ++row)
      for (let column = this.column(x - r); column <= last; ++column) {
        const c = row * this.columns + column;
        for (let k = this.start[c]; k < this.start[c + 1]; ++k) visit(this.items[k]);
      }
  },
};

// -------------------------------------------------------------------------------------- map: the view

const screenX = (x) => x * view.scale + view.ox;
const screenY = (y) => y * view.scale + view.oy;
const mapWidth = () => Math.max(view.width - view.band, 50);

function forgetView() {
  view.placed = false;
  shown.chosen = null;
}

function resizeMap() {
  const place = byId("map-area").getBoundingClientRect();
  const wasFit = view.placed && Math.abs(view.scale / view.fitScale - 1) < 1e-6;
  view.width = place.width;
  view.height = place.height;
  const wide = place.width > 560 ? 176 : 112;
  view.band = model.peers.length && byId("band-toggle").getAttribute("aria-pressed") === "true" ? wide : 0;
  if (!view.placed || wasFit) fitView();
  redraw("scene");
}

function fitView() {
  if (!view.width || !model.ecology) return;
  const narrow = mapWidth() < 420;
  const [left, top, bottom] = narrow ? [14, 54, 60] : [24, 48, 44];
  const w = Math.max(mapWidth() - 2 * left, 20);
  const h = Math.max(view.height - top - bottom, 20);
  view.fitScale = Math.min(w / world.width, h / world.height);
  view.scale = view.fitScale;
  view.ox = left + (w - world.width * view.scale) / 2;
  view.oy = top + (h - world.height * view.scale) / 2;
  view.placed = true;
  redraw("scene");
}

/** Zooms by a factor; what is at (x, y) on the screen stays there. */
function zoom(factor, x = mapWidth() / 2, y = view.height / 2) {
  const most = Math.max(view.fitScale * 40, ...model.islands.map((island) => 120 / island.spacing));
  const scale = clamp(view.scale * factor, view.fitScale * 0.4, most);
  const real = scale / view.scale;
  view.ox = x - (x - view.ox) * real;
  view.oy = y - (y - view.oy) * real;
  view.scale = scale;
  viewMoved();
}

function pan(dx, dy) {
  view.ox += dx;
  view.oy += dy;
  viewMoved();
}

/** The old picture is moved under the pointer until there is time for a new one. */
function viewMoved() {
  hideTip();
  if (scene.cost_ms < 3) return redraw("scene");
  clearTimeout(scene.timer);
  scene.timer = setTimeout(() => redraw("scene"), 140);
  return redraw("map");
}

function zoomToIsland(island) {
  const box = island.box;
  const w = Math.max(box.x1 - box.x0, 1e-3);
  const h = Math.max(box.y1 - box.y0, 1e-3);
  const fit = 0.8 * Math.min(mapWidth() / w, (view.height - 80) / h);
  view.scale = Math.max(fit, (FOLD_PX * 1.1) / island.spacing);
  view.ox = mapWidth() / 2 - island.cx * view.scale;
  view.oy = view.height / 2 - island.cy * view.scale;
  redraw("scene");
}

/** Brings a mote into the view, so near that its island is not folded. */
function showMote(index) {
  const island = islandOf(index);
  if (island.spacing * view.scale < FOLD_PX * 3) view.scale = (FOLD_PX * 4) / island.spacing;
  view.ox = mapWidth() / 2 - model.wx[index] * view.scale;
  view.oy = view.height / 2 - model.wy[index] * view.scale;
  redraw("scene");
}

// --------------------------------------------------------------------------------- map: the picture

// The scene is drawn larger than the screen, once, and shifted while somebody drags it; on it lie
// the things that change with the pointer or in time.
const MARGIN_PX = 160;
const FOLD_PX = 5.5; // motes nearer to each other than this are folded into their island,
const FOLD_LARGE_PX = 3; // or than this if the island is large,
const LARGE_PX = 250; // as this
const LABEL_PX = 26; // motes farther from each other than this have names
const scene = { canvas: document.createElement("canvas"), stale: true, cost_ms: 0, timer: 0, scale: 1, ox: 0, oy: 0 };
const sprites = new Map();

function drawMap() {
  if (!model.ecology || !view.placed) return;
  if (scene.stale || sceneExposed()) drawScene();
  const ctx = fitCanvas(byId("map"), view.width, view.height);
  const factor = view.scale / scene.scale;
  ctx.drawImage(scene.canvas, view.ox - scene.ox * factor - MARGIN_PX * factor, view.oy - scene.oy * factor - MARGIN_PX * factor,
    scene.width * factor, scene.height * factor);
  drawScaleBar(ctx);
  drawBand(ctx);
  drawNeighbours(ctx);
  drawChosen(ctx);
  drawFrames(ctx);
  if (!shown.firstPicture_ms) shown.firstPicture_ms = Math.round(performance.now());
}

function sceneExposed() {
  const factor = view.scale / scene.scale;
  const left = view.ox - (scene.ox + MARGIN_PX) * factor;
  const top = view.oy - (scene.oy + MARGIN_PX) * factor;
  return left > 0 || top > 0 || left + scene.width * factor < view.width || top + scene.height * factor < view.height
    || factor > 1.6;
}

function drawScene() {
  const started = performance.now();
  clearTimeout(scene.timer);
  Object.assign(scene, { scale: view.scale, ox: view.ox, oy: view.oy, width: view.width + 2 * MARGIN_PX,
    height: view.height + 2 * MARGIN_PX, stale: false });
  const ctx = fitCanvas(scene.canvas, scene.width, scene.height);
  ctx.translate(MARGIN_PX, MARGIN_PX);
  const inView = world.airs.filter((air) => boxInView(air.x, air.y, air.x + air.width, air.y + air.height));
  for (const air of inView) drawGround(ctx, air);
  const islands = inView.flatMap((air) => air.islands);
  for (const island of islands) island.folded = isTooSmall(island);
  labels.clear();
  const open = islands.filter((island) => !island.folded && boxInView(island.box.x0, island.box.y0, island.box.x1, island.box.y1));
  drawLinks(ctx, open);
  for (const island of open) drawMotes(ctx, island);
  const folded = islands.filter((island) => island.folded);
  for (const island of folded) drawRing(ctx, island);
  for (const island of folded) nameRing(ctx, island);
  for (const island of open) drawSink(ctx, island);
  for (const island of open) drawNames(ctx, island);
  scene.cost_ms = performance.now() - started;
}

function isTooSmall(island) {
  const large = Math.min(island.box.x1 - island.box.x0, island.box.y1 - island.box.y0) * view.scale > LARGE_PX;
  return island.count > 2 && island.spacing * view.scale < (large ? FOLD_LARGE_PX : FOLD_PX);
}

function boxInView(x0, y0, x1, y1) {
  return screenX(x1) > -MARGIN_PX && screenX(x0) < view.width + MARGIN_PX
    && screenY(y1) > -MARGIN_PX && screenY(y0) < view.height + MARGIN_PX;
}

function drawGround(ctx, air) {
  const x = screenX(air.x);
  const y = screenY(air.y);
  ctx.fillStyle = colour.panel;
  ctx.strokeStyle = colour.line;
  ctx.lineWidth = 1;
  ctx.beginPath();
  ctx.rect(x, y, air.width * view.scale, air.height * view.scale);
  ctx.fill();
  ctx.stroke();
  if (air.first) drawPlan(ctx, air);
}

function drawPlan(ctx, air) {
  const p = model.ecology.plan;
  if (p && plan.image?.complete && plan.image.naturalWidth) {
    ctx.globalAlpha = 0.6;
    ctx.drawImage(plan.image, screenX(worldX(air, p.x_m)), screenY(worldY(air, p.y_m + p.height_m)),
      p.width_m * view.scale, p.height_m * view.scale);
    ctx.globalAlpha = 1;
  }
  ctx.strokeStyle = colour.soft;
  ctx.lineWidth = 2.5;
  ctx.beginPath();
  for (const [x1, y1, x2, y2] of model.ecology.walls || []) {
    ctx.moveTo(screenX(worldX(air, x1)), screenY(worldY(air, y1)));
    ctx.lineTo(screenX(worldX(air, x2)), screenY(worldY(air, y2)));
  }
  ctx.stroke();
}

/** Lines to parents, a path for each class. */
function drawLinks(ctx, islands) {
  const by = byId("link-by").value;
  if (by === "none" || !shown.moment) return;
  const { motes } = shown.moment;
  const thin = islands.some((island) => island.spacing * view.scale < 14);
  for (let kind = LINKS.length - 1; kind >= 0; --kind) {
    ctx.strokeStyle = colour[LINKS[kind].colour];
    ctx.lineWidth = thin ? 0.7 : LINKS[kind].width;
    ctx.setLineDash(thin ? [] : LINKS[kind].dash);
    ctx.beginPath();
    for (const island of islands)
      for (let i = island.first; i < island.first + island.count; ++i)
        if (model.parent[i] !== NO_PARENT && hasPower(motes.state[i]) && linkClass(motes, i, by) === kind) lineToParent(ctx, island, i);
    ctx.stroke();
  }
  ctx.setLineDash([]);
}

const hasPower = (state) => state > 0 && state < 4;

function lineToParent(ctx, island, i) {
  const parent = model.parent[i];
  const x1 = screenX(model.wx[i]);
  const y1 = screenY(model.wy[i]);
  const x2 = screenX(parent === SINK ? island.sx : model.wx[parent]);
  const y2 = screenY(parent === SINK ? island.sy : model.wy[parent]);
  if (Math.max(x1, x2) < -MARGIN_PX || Math.min(x1, x2) > view.width + MARGIN_PX) return;
  if (Math.max(y1, y2) < -MARGIN_PX || Math.min(y1, y2) > view.height + MARGIN_PX) return;
  ctx.moveTo(x1, y1);
  ctx.lineTo(x2, y2);
}

/** Which of LINKS: as the report's map for what arrived. */
function linkClass(motes, i, by) {
  if (by === "signal") return above(motes.signal[i], [-70, -80, -88]);
  if (by === "etx") return above(isNumber(motes.etx[i]) ? -motes.etx[i] : null, [-1.2, -1.6, -3]);
  return above(motes.delivery[i], [0.99, 0.95, 0.8]);
}

function above(x, limits) {
  if (!isNumber(x)) return 4;
  const found = limits.findIndex((limit) => x >= limit);
  return found < 0 ? 3 : found;
}

const radiusOf = (island) => Math.round(clamp(island.spacing * view.scale * 0.26, 1.2, 7) * 2) / 2;

function drawMotes(ctx, island) {
  const radius = radiusOf(island);
  const state = shown.moment?.motes.state || [];
  const pictures = STATES.map((_, code) => sprite(code, radius));
  const half = pictures[0].half;
  for (let i = island.first; i < island.first + island.count; ++i) {
    const x = screenX(model.wx[i]);
    const y = screenY(model.wy[i]);
    if (x < -MARGIN_PX || y < -MARGIN_PX || x > view.width + MARGIN_PX || y > view.height + MARGIN_PX) continue;
    ctx.drawImage(pictures[state[i] || 0]?.canvas || pictures[0].canvas, x - half, y - half, 2 * half, 2 * half);
    if (radius > 2.5) labels.occupy(x - radius, y - radius, x + radius, y + radius);
  }
}

/** The sign of a state, drawn once for each size. */
function sprite(code, radius) {
  const name = code + ":" + radius;
  if (!sprites.has(name)) {
    const canvas = document.createElement("canvas");
    const half = Math.ceil(radius * 1.3) + 1;
    const ctx = fitCanvas(canvas, 2 * half, 2 * half);
    drawSign(ctx, code, half, half, radius);
    sprites.set(name, { canvas, half });
  }
  return sprites.get(name);
}

/** Each state has a shape of its own, so that colours are not needed to tell them apart. */
function drawSign(ctx, code, x, y, r) {
  const hue = colour[STATES[code].colour];
  const thick = Math.max(1, r * 0.3);
  ctx.strokeStyle = ctx.fillStyle = hue;
  ctx.lineWidth = thick;
  ctx.beginPath();
  if (code === 0) { // a dotted ring
    ctx.setLineDash([r * 0.5, r * 0.4]);
    ctx.arc(x, y, r * 0.85, 0, 7);
    ctx.stroke();
    ctx.setLineDash([]);
  } else if (code === 1) { // a disc
    ctx.arc(x, y, r, 0, 7);
    ctx.fill();
  } else if (code === 2) { // half a disc in a ring
    ctx.arc(x, y, r * 0.85, 0, 7);
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(x, y, r * 0.85, Math.PI / 2, 1.5 * Math.PI);
    ctx.fill();
  } else if (code === 3) { // a triangle
    ctx.moveTo(x, y - 1.2 * r);
    ctx.lineTo(x + 1.15 * r, y + 0.9 * r);
    ctx.lineTo(x - 1.15 * r, y + 0.9 * r);
    ctx.fill();
  } else if (code === 4) { // a cross
    ctx.lineWidth = thick * 1.4;
    ctx.moveTo(x - r, y - r);
    ctx.lineTo(x + r, y + r);
    ctx.moveTo(x + r, y - r);
    ctx.lineTo(x - r, y + r);
    ctx.stroke();
  } else { // an empty battery
    ctx.rect(x - r, y - 0.6 * r, 1.8 * r, 1.2 * r);
    ctx.stroke();
    ctx.fillRect(x + 0.85 * r, y - 0.3 * r, 0.4 * r, 0.6 * r);
  }
}

function drawSink(ctx, island) {
  if (!island.sink) return;
  const x = screenX(island.sx);
  const y = screenY(island.sy);
  const r = Math.max(radiusOf(island) * 1.15, 4.5);
  ctx.fillStyle = colour.sink;
  ctx.strokeStyle = colour.bg;
  ctx.lineWidth = 1.5;
  ctx.fillRect(x - r, y - r, 2 * r, 2 * r);
  ctx.strokeRect(x - r, y - r, 2 * r, 2 * r);
  labels.occupy(x - r, y - r, x + r, y + r);
  label(ctx, x, y, r, island.name, true);
}

function drawNames(ctx, island) {
  if (island.spacing * view.scale < LABEL_PX) return;
  const r = radiusOf(island);
  for (let i = island.first; i < island.first + island.count; ++i) {
    const x = screenX(model.wx[i]);
    const y = screenY(model.wy[i]);
    if (x > -40 && y > -20 && x < view.width + 40 && y < view.height + 20) label(ctx, x, y, r, model.names[i], false);
  }
}

/** An island too small for its motes: a ring of its states, and how many have joined. */
function drawRing(ctx, island) {
  const x = screenX(island.cx);
  const y = screenY(island.cy);
  const box_px = Math.min(island.box.x1 - island.box.x0, island.box.y1 - island.box.y0) * view.scale;
  const r = clamp(6 + 2.2 * Math.log2(island.count), 7, Math.max(7, box_px * 0.34));
  island.foldedRadius = r;
  ctx.beginPath();
  ctx.arc(x, y, r, 0, 7);
  ctx.fillStyle = colour.bg;
  ctx.fill();
  ctx.lineWidth = Math.max(3, r * 0.32);
  let angle = -Math.PI / 2;
  for (const code of [1, 2, 3, 4, 5, 0]) {
    const part = (island.counts[code] / island.count) * 2 * Math.PI;
    if (!part) continue;
    ctx.strokeStyle = colour[STATES[code].colour];
    ctx.beginPath();
    ctx.arc(x, y, r, angle, angle + part);
    ctx.stroke();
    angle += part;
  }
  labels.occupy(x - r - 3, y - r - 3, x + r + 3, y + r + 2);
  if (r < 11) return;
  ctx.fillStyle = colour.fg;
  ctx.font = "11px system-ui, sans-serif";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.fillText(joinedOf(island), x, y + 0.5);
}

const joinedOf = (island) => island.counts[1] + island.counts[2];

/** Joined of all too, where there is room. */
function nameRing(ctx, island) {
  const [x, y, r] = [screenX(island.cx), screenY(island.cy), island.foldedRadius * 1.16 + 3];
  const name = plain(island.name, 16);
  if (!label(ctx, x, y, r, `${name} ${joinedOf(island)}/${island.count}`, true, [2, 0])) label(ctx, x, y, r, name, true, [2]);
}

function drawScaleBar(ctx) {
  const metres = 10 ** Math.floor(Math.log10(110 / view.scale));
  const fitting = [5, 2, 1].find((n) => n * metres * view.scale <= 110) * metres;
  const x = mapWidth() - fitting * view.scale - 14;
  ctx.strokeStyle = colour.fg;
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  ctx.moveTo(x, 26);
  ctx.lineTo(x + fitting * view.scale, 26);
  ctx.stroke();
  ctx.fillStyle = colour.soft;
  ctx.font = "12px system-ui, sans-serif";
  ctx.textAlign = "right";
  ctx.textBaseline = "alphabetic";
  ctx.fillText(`${fitting >= 1 ? fitting : fitting.toPrecision(1)} m`, mapWidth() - 14, 20);
}

/** Where the map has room for names: a coarse picture of what is taken. */
const labels = {
  cell: 4, columns: 0, rows: 0, taken: new Uint8Array(0),

  clear() {
    this.columns = Math.ceil((view.width + 2 * MARGIN_PX) / this.cell);
    this.rows = Math.ceil((view.height + 2 * MARGIN_PX) / this.cell);
    this.taken = new Uint8Array(this.columns * this.rows);
  },

  /** Calls for each cell of a box on the screen until the call says false. */
  each(x0, y0, x1, y1, visit) {
    const c0 = Math.max(0, Math.floor((x0 + MARGIN_PX) / this.cell));
    const c1 = Math.min(this.columns - 1, Math.floor((x1 + MARGIN_PX) / this.cell));
    const r0 = Math.max(0, Math.floor((y0 + MARGIN_PX) / this.cell));
    const r1 = Math.min(this.rows - 1, Math.floor((y1 + MARGIN_PX) / this.cell));
    for (let r = r0; r <= r1; ++r)
      for (let c = c0; c <= c1; ++c) if (!visit(r * this.columns + c)) return false;
    return true;
  },

  occupy(x0, y0, x1, y1) {
    this.each(x0, y0, x1, y1, (i) => { this.taken[i] = 1; return true; });
  },

  isFree(x0, y0, x1, y1) {
    return x1 < mapWidth() + MARGIN_PX && this.each(x0, y0, x1, y1, (i) => !this.taken[i]);
  },
};

const widths = new Map(); // of texts, in pixels

/** Writes a name beside a sign: right, left, below or above, as `order` says. @returns whether there was room. */
function label(ctx, x, y, r, text, strong, order = [0, 1, 2, 3]) {
  const words = plain(text, 24);
  ctx.font = (strong ? "600 " : "") + "12px system-ui, sans-serif";
  const key = (strong ? "*" : "") + words;
  if (!widths.has(key)) {
    if (widths.size > 20000) widths.clear();
    widths.set(key, ctx.measureText(words).width);
  }
  const w = widths.get(key);
  const places = [[x + r + 3, y - 7], [x - r - 3 - w, y - 7], [x - w / 2, y + r + 2], [x - w / 2, y - r - 16]];
  for (const [left, top] of order.map((i) => places[i])) {
    const cut = (x > 0 && left < 2) || (x < mapWidth() && left + w > mapWidth() - 2);
    if (cut || !labels.isFree(left, top + 1, left + w, top + 13)) continue;
    labels.occupy(left, top + 1, left + w, top + 13);
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    ctx.lineWidth = 3;
    ctx.lineJoin = "round";
    ctx.strokeStyle = colour.panel;
    ctx.strokeText(words, left, top + 7);
    ctx.fillStyle = strong ? colour.fg : colour.soft;
    ctx.fillText(words, left, top + 7);
    return true;
  }
  return false;
}

// ------------------------------------------------------------------------ map: what lies over the scene

function drawNeighbours(ctx) {
  const index = pointer.over?.kind === "mote" ? pointer.over.index : shown.chosen?.kind === "mote" ? shown.chosen.index : -1;
  if (index < 0 || index >= model.count || islandOf(index).folded) return;
  const x = screenX(model.wx[index]);
  const y = screenY(model.wy[index]);
  ctx.strokeStyle = colour.c2;
  ctx.fillStyle = colour.fg;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([2, 3]);
  ctx.beginPath();
  for (const place of neighbourPlaces(index)) {
    ctx.moveTo(x, y);
    ctx.lineTo(place.x, place.y);
  }
  ctx.stroke();
  ctx.setLineDash([]);
  const parent = model.parent[index];
  if (parent === NO_PARENT) return;
  ctx.lineWidth = 3.5;
  ctx.strokeStyle = colour.fg;
  ctx.beginPath();
  lineToParent(ctx, islandOf(index), index);
  ctx.stroke();
}

function neighbourPlaces(index) {
  const known = neighboursOf.get(index) || [];
  return known.map(([name]) => placeOf(name, islandOf(index))).filter(Boolean);
}

/** Where on the screen somebody is, by the name or address that the server uses. */
function placeOf(name, island = null) {
  const sinkOf = model.islands.find((x) => name === x.name + "/sink" || (x.sink && name === x.id + "/" + x.sink.id))
    || (name === "sink" ? island : null);
  if (sinkOf) return { x: screenX(sinkOf.sx), y: screenY(sinkOf.sy), island: sinkOf };
  const index = model.byName.get(name) ?? model.byAddress.get(name) ?? (island ? model.byName.get(island.name + "/" + name) : undefined);
  if (index === undefined) return null;
  return { x: screenX(model.wx[index]), y: screenY(model.wy[index]), island: islandOf(index), index };
}

function drawChosen(ctx) {
  for (const [target, width] of [[pointer.over, 1.5], [shown.chosen, 2.5]]) {
    if (!target || target.kind === "peer") continue;
    const island = target.kind === "mote" ? islandOf(target.index) : model.islands[target.index];
    if (!island) continue;
    const atMote = target.kind === "mote" && !island.folded;
    const x = screenX(atMote ? model.wx[target.index] : island.folded ? island.cx : island.sx);
    const y = screenY(atMote ? model.wy[target.index] : island.folded ? island.cy : island.sy);
    ctx.strokeStyle = colour.fg;
    ctx.lineWidth = width;
    ctx.beginPath();
    ctx.arc(x, y, (island.folded ? island.foldedRadius : radiusOf(island)) + 5, 0, 7);
    ctx.stroke();
  }
}

/** Frames on their way: a dot from sender to receiver; a growing ring is for all who hear it. */
function drawFrames(ctx) {
  if (!frames.wanted()) return;
  for (const [start, length, from, to, heard] of frames.list) {
    const lasts = Math.max(length, frames.least_s());
    const part = (shown.at - start) / lasts;
    if (part < 0 || part > 1) continue;
    const a = placeOf(from);
    const b = to ? placeOf(to) : null;
    if (!a || a.island.folded) continue;
    ctx.strokeStyle = ctx.fillStyle = heard ? colour.c2 : colour.bad;
    ctx.beginPath();
    if (b) {
      ctx.arc(a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), 4, 0, 7);
      ctx.fill();
      if (!heard && part > 0.8) drawSign(ctx, 4, b.x, b.y, 6);
    } else {
      ctx.globalAlpha = 1 - part;
      ctx.lineWidth = 2;
      ctx.arc(a.x, a.y, 4 + 36 * part, 0, 7);
      ctx.stroke();
      ctx.globalAlpha = 1;
    }
  }
}

// ------------------------------------------------------------------------------------ map: PEIS band

const band = { step: 0, top: 0 };

const peerX = () => mapWidth() + (view.band > 120 ? 44 : 30);
const peerY = (row) => band.top + (row + 0.5) * band.step;

function drawBand(ctx) {
  if (!view.band) return;
  const n = model.peerOrder.length;
  band.step = Math.min(34, (view.height - 50) / n);
  band.top = 36 + Math.max(0, (view.height - 50 - band.step * n) / 2) * 0.3;
  const rows = new Map(model.peerOrder.map((peer, row) => [peer, row]));
  ctx.fillStyle = colour.bg;
  ctx.fillRect(mapWidth(), 0, view.band, view.height);
  ctx.strokeStyle = colour.line;
  ctx.lineWidth = 1;
  ctx.strokeRect(mapWidth() + 0.5, -1, view.band, view.height + 2);
  ctx.fillStyle = colour.soft;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.font = "12px system-ui, sans-serif";
  ctx.fillText(`PEIS, ${n} peers`, mapWidth() + 10, 18);
  drawCables(ctx, rows);
  for (const pair of model.links) drawPeerLink(ctx, rows, pair);
  for (const [peer, row] of rows) drawPeer(ctx, peer, row);
}

const isMarked = (peer) => [pointer.over, shown.chosen].some((x) => x?.kind === "peer" && x.index === peer);
const islandMarked = (island) => [pointer.over, shown.chosen].some((x) => x && x.kind !== "peer"
  && (x.kind === "island" ? x.index : model.island[x.index]) === island);

/** Cables from sinks to their gateways; of many only those of what is pointed at. */
function drawCables(ctx, rows) {
  const many = model.peers.filter((x) => x.gateway).length > 12;
  ctx.strokeStyle = colour.sink;
  for (const [peer, row] of rows)
    for (const at of model.peers[peer].islands) {
      const marked = isMarked(peer) || islandMarked(at);
      if (many && !marked) continue;
      const island = model.islands[at];
      ctx.lineWidth = marked ? 2.5 : 1.3;
      ctx.globalAlpha = marked ? 1 : 0.65;
      ctx.setLineDash([6, 3]);
      ctx.beginPath();
      ctx.moveTo(peerX() - 7, peerY(row));
      const x = screenX(island.folded ? island.cx : island.sx);
      const y = screenY(island.folded ? island.cy : island.sy);
      ctx.bezierCurveTo(mapWidth() - 30, peerY(row), Math.max(x + 40, mapWidth() - 90), y, x + (island.folded ? island.foldedRadius : 6), y);
      ctx.stroke();
    }
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}

function drawPeerLink(ctx, rows, [a, b]) {
  const y1 = peerY(rows.get(a));
  const y2 = peerY(rows.get(b));
  const marked = isMarked(a) || isMarked(b);
  const next = Math.abs(rows.get(a) - rows.get(b)) === 1;
  const bulge = next ? 0 : Math.min(peerX() - mapWidth() - 6, 6 + Math.abs(y2 - y1) * 0.22);
  ctx.strokeStyle = marked ? colour.fg : colour.soft;
  ctx.lineWidth = marked ? 2.2 : 1.2;
  ctx.beginPath();
  ctx.moveTo(peerX(), y1);
  ctx.bezierCurveTo(peerX() - bulge * 1.3, y1, peerX() - bulge * 1.3, y2, peerX(), y2);
  ctx.stroke();
}

function drawPeer(ctx, peer, row) {
  const x = peerX();
  const y = peerY(row);
  const r = clamp(band.step * 0.3, 1.5, 7);
  ctx.beginPath();
  if (model.peers[peer].gateway) for (let k = 0; k < 6; ++k) ctx.lineTo(x + r * Math.cos((k * Math.PI) / 3), y + r * Math.sin((k * Math.PI) / 3));
  else ctx.arc(x, y, r * 0.85, 0, 7);
  ctx.closePath();
  ctx.fillStyle = model.peers[peer].gateway ? colour.sink : colour.bg;
  ctx.fill();
  ctx.strokeStyle = isMarked(peer) ? colour.fg : model.peers[peer].gateway ? colour.sink : colour.good;
  ctx.lineWidth = isMarked(peer) ? 3 : 2;
  ctx.stroke();
  const every = Math.ceil(14 / band.step);
  if (row % every !== 0 && !isMarked(peer)) return;
  ctx.fillStyle = isMarked(peer) ? colour.fg : colour.soft;
  ctx.fillText(shortened(ctx, model.peers[peer].name, view.width - x - 16), x + 12, y);
}

function shortened(ctx, text, width) {
  let words = plain(text, 40);
  while (words.length > 2 && ctx.measureText(words).width > width) words = words.slice(0, -2) + "…";
  return words;
}

// ------------------------------------------------------------------------------------- map: pointer

const pointer = { over: null, down: new Map(), moved: 0, spread: 0, timer: 0 };
const neighboursOf = new Map(); // of motes that were pointed at, by index: [[name, etx], ...]

/** What is at a place of the canvas: {kind, index}, or null. */
function targetAt(x, y) {
  if (view.band && x > mapWidth()) {
    const row = Math.floor((y - band.top) / band.step);
    return row >= 0 && row < model.peerOrder.length ? { kind: "peer", index: model.peerOrder[row] } : null;
  }
  return moteAt(x, y) || islandAt(x, y);
}

function moteAt(x, y) {
  let best = 13; // pixels
  let found = -1;
  const wx = (x - view.ox) / view.scale;
  const wy = (y - view.oy) / view.scale;
  if (best / view.scale / grid.cell > 40) return null; // so far away that all is folded
  grid.near(wx, wy, best / view.scale, (i) => {
    if (islandOf(i).folded) return;
    const away = Math.hypot(screenX(model.wx[i]) - x, screenY(model.wy[i]) - y);
    if (away < best) {
      best = away;
      found = i;
    }
  });
  if (found < 0) return null;
  const island = islandOf(found);
  const toSink = Math.hypot(screenX(island.sx) - x, screenY(island.sy) - y);
  return island.sink && toSink < best ? { kind: "island", index: model.island[found] } : { kind: "mote", index: found };
}

function islandAt(x, y) {
  const index = model.islands.findIndex((island) => {
    const cx = screenX(island.folded ? island.cx : island.sx);
    const cy = screenY(island.folded ? island.cy : island.sy);
    return Math.hypot(cx - x, cy - y) < (island.folded ? island.foldedRadius + 4 : 10);
  });
  return index < 0 ? null : { kind: "island", index };
}

const sameTarget = (a, b) => a === b || (a && b && a.kind === b.kind && a.index === b.index);

function pointAt(x, y) {
  const over = model.ecology ? targetAt(x, y) : null;
  if (!sameTarget(over, pointer.over)) {
    pointer.over = over;
    byId("map").classList.toggle("over", Boolean(over));
    redraw("map");
    clearTimeout(pointer.timer);
    if (over?.kind === "mote") pointer.timer = setTimeout(() => askNeighbours(over.index), 120);
  }
  if (over) showTip(x, y, tipLines(over));
  else hideTip();
}

async function askNeighbours(index) {
  const answer = await ask({ ask: "mote", address: addressOf(index), at_s: shown.at }, "mote");
  if (!answer) return;
  neighboursOf.clear();
  neighboursOf.set(index, answer.neighbours || []);
  redraw("map");
}

function tipLines(target) {
  if (target.kind === "peer") {
    const peer = model.peers[target.index];
    return [peer.name, `${peer.gateway ? "gateway" : "peer"} ${peer.id}, ${peer.links.length} links`];
  }
  if (target.kind === "island") {
    const island = model.islands[target.index];
    return [island.name, `${joinedOf(island)} of ${island.count} joined`, island.folded ? "click: nearer" : "sink"];
  }
  const i = target.index;
  const motes = shown.moment?.motes;
  const lines = [fullName(i), STATES[motes?.state[i]]?.label || STATES[0].label];
  if (!motes) return lines;
  if (model.parent[i] !== NO_PARENT)
    lines.push(`by ${model.parent[i] === SINK ? "the sink" : model.names[model.parent[i]]}, hops ${motes.hops[i] ?? "–"}`,
      `ETX ${etxText(motes.etx[i])}, ${isNumber(motes.signal[i]) ? motes.signal[i] + " dBm" : "no signal"}`);
  lines.push(`arrived ${shareText(motes.delivery[i])}`);
  return lines;
}

function showTip(x, y, lines) {
  const tip = byId("tip");
  tip.replaceChildren(...lines.map((line) => make("div", {}, plain(line, 120))));
  tip.hidden = false;
  const place = tip.getBoundingClientRect();
  tip.style.left = clamp(x + 14, 4, view.width - place.width - 4) + "px";
  tip.style.top = clamp(y + 14, 4, view.height - place.height - 4) + "px";
}

function hideTip() {
  byId("tip").hidden = true;
}

function placeInMap(event) {
  const place = byId("map").getBoundingClientRect();
  return [event.clientX - place.left, event.clientY - place.top];
}

function listenToMap() {
  const map = byId("map");
  map.addEventListener("pointerdown", (event) => {
    pointer.down.set(event.pointerId, placeInMap(event));
    pointer.moved = 0;
    pointer.spread = 0;
    map.setPointerCapture?.(event.pointerId);
  });
  map.addEventListener("pointermove", (event) => {
    const at = placeInMap(event);
    if (pointer.down.has(event.pointerId)) drag(event.pointerId, at);
    else pointAt(...at);
  });
  const up = (event) => {
    const wasDown = pointer.down.delete(event.pointerId);
    map.classList.remove("dragged");
    if (event.type === "pointerup" && wasDown && pointer.moved < 5 && pointer.down.size === 0) clickMap(...placeInMap(event));
  };
  map.addEventListener("pointerup", up);
  map.addEventListener("pointercancel", up);
  map.addEventListener("pointerleave", () => pointAt(-1e6, -1e6));
  map.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...placeInMap(event));
  }, { passive: false });
  map.addEventListener("dblclick", (event) => zoom(2, ...placeInMap(event)));
}

/** One pointer shifts the map, two zoom it. */
function drag(id, at) {
  const before = pointer.down.get(id);
  pointer.down.set(id, at);
  pointer.moved += Math.hypot(at[0] - before[0], at[1] - before[1]);
  if (pointer.moved < 5) return;
  byId("map").classList.add("dragged");
  if (pointer.down.size === 1) return pan(at[0] - before[0], at[1] - before[1]);
  const [a, b] = [...pointer.down.values()];
  const spread = Math.hypot(a[0] - b[0], a[1] - b[1]);
  if (pointer.spread) zoom(spread / pointer.spread, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
  pointer.spread = spread;
  return undefined;
}

function clickMap(x, y) {
  const target = model.ecology ? targetAt(x, y) : null;
  if (target?.kind === "island" && model.islands[target.index].folded) zoomToIsland(model.islands[target.index]);
  choose(target);
}

// ------------------------------------------------------------------------------------------ legend

function drawLegend() {
  const legend = STATES.map((state, code) => make("span", { class: "key", "data-state": code }, signPicture(code),
    make("span", {}, state.label), make("b", { class: "number" }, "0")));
  byId("legend").replaceChildren(...legend);
  showLegendCounts();
  byId("help-signs").replaceChildren(...STATES.map((state, code) => make("span", { class: "key" }, signPicture(code), state.label)),
    make("span", { class: "key" }, swatch("sink"), "sink; as a hexagon: its gateway"));
  byId("energy-legend").replaceChildren(...Object.entries(ENERGY_COLOURS).map(([name, hue]) =>
    make("span", { class: "key" }, swatch(hue), name === "off" ? "radio off" : name)));
}

function signPicture(code) {
  const canvas = make("canvas", { "aria-hidden": "true" });
  drawSign(fitCanvas(canvas, 16, 16), code, 8, 8, 5.5);
  canvas.style.width = canvas.style.height = "16px";
  return canvas;
}

function swatch(hue) {
  const square = make("span", { class: "swatch", "aria-hidden": "true" });
  square.style.background = colour[hue] || hue;
  return square;
}

function showLegendCounts() {
  for (const key of byId("legend").children) {
    const count = shown.counts[Number(key.dataset.state)];
    key.lastChild.textContent = countText(count);
    key.hidden = count === 0;
  }
}

// ---------------------------------------------------------------------------------------- time line

const TIME_HEIGHT = 118;
const lanes = { faults: 12, events: 30, top: 42, bottom: 98 };
const timeLine = { base: null, width: 0, hover: null, hidden: new Set(["radio/filtered", "radio/duplicate", "radio/off"]), causes: [] };

const timeLeft = () => (timeLine.width > 500 ? 54 : 10);
const timeX = (t) => timeLeft() + (t / runLength()) * (timeLine.width - timeLeft() - 12);
const timeAtX = (x) => clamp(((x - timeLeft()) / (timeLine.width - timeLeft() - 12)) * runLength(), 0, runLength());

/** The causes that lost most, the others together. */
function showCauses() {
  const total = (cause) => (series.lost[cause].length ? series.lost[cause][series.lost[cause].length - 1] : 0);
  const all = Object.keys(series.lost).filter((cause) => total(cause) > 0);
  all.sort((a, b) => timeLine.hidden.has(a) - timeLine.hidden.has(b) || total(b) - total(a));
  timeLine.causes = all.slice(0, SERIES_COLOURS.length);
  byId("causes").replaceChildren(...timeLine.causes.map((cause, k) => make("button", {
    type: "button", "aria-pressed": String(!timeLine.hidden.has(cause)), title: `${plain(cause)}: ${countText(total(cause))} lost so far`,
    onclick: () => toggleCause(cause),
  }, swatch(SERIES_COLOURS[k]), plain(cause, 30))));
}

function toggleCause(cause) {
  if (!timeLine.hidden.delete(cause)) timeLine.hidden.add(cause);
  timeLine.base = null;
  showCauses();
  redraw("time");
}

function drawTimeLine() {
  const canvas = byId("time-line");
  const width = canvas.clientWidth;
  if (!width) return;
  if (timeLine.width !== width || !timeLine.base || timeLine.length !== runLength()) {
    timeLine.width = width;
    timeLine.length = runLength();
    drawTimeBase();
  }
  const ctx = fitCanvas(canvas, width, TIME_HEIGHT);
  ctx.drawImage(timeLine.base, 0, 0, width, TIME_HEIGHT);
  drawNotYet(ctx);
  if (timeLine.hover !== null) drawTimeHover(ctx);
  drawCursor(ctx);
  showTime();
}

/** All that does not move with the cursor. */
function drawTimeBase() {
  timeLine.base = document.createElement("canvas");
  const ctx = fitCanvas(timeLine.base, timeLine.width, TIME_HEIGHT);
  ctx.fillStyle = colour.panel;
  ctx.fillRect(timeLeft(), 0, timeX(runLength()) - timeLeft(), lanes.bottom);
  drawTimeAxis(ctx);
  drawLosses(ctx);
  drawEventMarks(ctx);
  if (timeLeft() < 50) return;
  ctx.fillStyle = colour.soft;
  ctx.font = "12px system-ui, sans-serif";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText("faults", 2, lanes.faults);
  ctx.fillText("events", 2, lanes.events);
  ctx.fillText("losses", 2, (lanes.top + lanes.bottom) / 2);
}

const TIME_STEPS = [0.01, 0.05, 0.1, 0.5, 1, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600, 43200, 86400, 604800];

function drawTimeAxis(ctx) {
  const wanted = (runLength() * 85) / timeLine.width;
  const step = TIME_STEPS.find((x) => x >= wanted) || runLength();
  ctx.strokeStyle = colour.line;
  ctx.fillStyle = colour.soft;
  ctx.lineWidth = 1;
  ctx.font = "12px system-ui, sans-serif";
  ctx.textBaseline = "top";
  for (let k = 0; k * step <= runLength() * 1.0001; ++k) {
    const x = Math.round(timeX(k * step)) + 0.5;
    ctx.beginPath();
    ctx.moveTo(x, 0);
    ctx.lineTo(x, lanes.bottom + 3);
    ctx.stroke();
    ctx.textAlign = k === 0 ? "left" : x > timeLine.width - 30 ? "right" : "center";
    ctx.fillText(timeText(k * step, step < 1 ? 1 : 0), ctx.textAlign === "right" ? timeLine.width - 2 : x, lanes.bottom + 5);
  }
}

/** Losses in each sample, stacked by cause. */
function drawLosses(ctx) {
  const causes = timeLine.causes.filter((cause) => !timeLine.hidden.has(cause));
  const n = series.times.length;
  const sum = new Float64Array(n);
  const lost = causes.map((cause) => series.lost[cause].map((x, i, all) => Math.max(0, x - (i ? all[i - 1] : 0))));
  for (const each of lost) for (let i = 0; i < n; ++i) sum[i] += each[i] || 0;
  const most = sum.reduce((a, b) => Math.max(a, b), 1);
  const unit = (lanes.bottom - lanes.top) / most;
  const base = new Float64Array(n);
  lost.forEach((each, k) => {
    ctx.fillStyle = colour[SERIES_COLOURS[timeLine.causes.indexOf(causes[k])]];
    ctx.beginPath();
    for (let i = 0; i < n; ++i) {
      if (!each[i]) continue;
      const x = timeX(i ? series.times[i - 1] : 0);
      ctx.rect(x, lanes.bottom - (base[i] + each[i]) * unit, Math.max(timeX(series.times[i]) - x, 1), each[i] * unit);
      base[i] += each[i];
    }
    ctx.fill();
  });
}

/** A mark for each event, at most one of a class for each pixel. */
function drawEventMarks(ctx) {
  const seen = new Set();
  const draw = { fault: drawFaultMark, violation: drawViolationMark, expectation: drawExpectationMark, event: drawEventMark };
  for (const kind of ["event", "expectation", "fault", "violation"])
    for (const each of events) {
      if (each.kind !== kind) continue;
      const x = Math.round(timeX(each.t));
      if (seen.has(kind + x)) continue;
      seen.add(kind + x);
      draw[kind](ctx, x);
    }
}

function drawEventMark(ctx, x) {
  ctx.fillStyle = colour.soft;
  ctx.fillRect(x - 0.75, lanes.events - 6, 1.5, 12);
}

function drawExpectationMark(ctx, x) {
  ctx.strokeStyle = colour.c2;
  ctx.lineWidth = 2;
  ctx.beginPath();
  ctx.arc(x, lanes.faults, 4, 0, 7);
  ctx.stroke();
}

function drawFaultMark(ctx, x) {
  ctx.fillStyle = colour.poor;
  ctx.beginPath();
  ctx.moveTo(x, lanes.faults - 6);
  ctx.lineTo(x + 6, lanes.faults + 5);
  ctx.lineTo(x - 6, lanes.faults + 5);
  ctx.fill();
}

function drawViolationMark(ctx, x) {
  ctx.fillStyle = colour.bad;
  ctx.beginPath();
  for (const [dx, dy] of [[0, -7], [6, 0], [0, 7], [-6, 0]]) ctx.lineTo(x + dx, lanes.faults + dy);
  ctx.fill();
  ctx.fillRect(x - 0.75, lanes.faults, 1.5, lanes.bottom - lanes.faults);
}

function drawNotYet(ctx) {
  if (run.now >= runLength()) return;
  ctx.fillStyle = colour.bg;
  ctx.globalAlpha = 0.7;
  ctx.fillRect(timeX(run.now), 0, timeX(runLength()) - timeX(run.now), lanes.bottom);
  ctx.globalAlpha = 1;
}

function drawCursor(ctx) {
  const x = timeX(shown.at);
  ctx.fillStyle = colour.fg;
  ctx.fillRect(x - 1, 0, 2, lanes.bottom + 2);
  ctx.beginPath();
  ctx.moveTo(x - 6, lanes.bottom + 9);
  ctx.lineTo(x + 6, lanes.bottom + 9);
  ctx.lineTo(x, lanes.bottom);
  ctx.fill();
}

/** The time under the pointer, and the event that is nearest to it. */
function drawTimeHover(ctx) {
  const t = timeAtX(timeLine.hover);
  const near = nearestEvent(t);
  const text = timeText(t) + (near ? `   ${EVENT_SIGNS[near.kind] || "·"} ${plain(near.who, 40)} ${plain(near.what, 60)}` : "");
  ctx.font = "12px system-ui, sans-serif";
  const w = ctx.measureText(text).width + 12;
  const x = clamp(timeLine.hover - w / 2, 0, timeLine.width - w);
  ctx.fillStyle = colour.soft;
  ctx.fillRect(timeLine.hover - 0.5, 0, 1, lanes.bottom);
  ctx.fillStyle = colour.bg;
  ctx.strokeStyle = colour.line;
  ctx.lineWidth = 1;
  ctx.fillRect(x, lanes.top + 4, w, 20);
  ctx.strokeRect(x + 0.5, lanes.top + 4.5, w, 20);
  ctx.fillStyle = colour.fg;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText(text, x + 6, lanes.top + 15);
}

/** Within a few pixels of a time. */
function nearestEvent(t) {
  const after = firstAfter(events.length, eventTime, t);
  const near = [events[after - 1], events[after]].filter((x) => x && Math.abs(timeX(x.t) - timeX(t)) < 5);
  return near.sort((a, b) => Math.abs(a.t - t) - Math.abs(b.t - t))[0] || null;
}

function listenToTimeLine() {
  const canvas = byId("time-line");
  const at = (event) => event.clientX - canvas.getBoundingClientRect().left;
  let held = false;
  canvas.addEventListener("pointerdown", (event) => {
    held = true;
    canvas.setPointerCapture?.(event.pointerId);
    showAt(timeAtX(at(event)));
  });
  canvas.addEventListener("pointermove", (event) => {
    timeLine.hover = held ? null : at(event);
    if (held) showAt(timeAtX(at(event)));
    else redraw("time");
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = false; });
  canvas.addEventListener("pointerleave", () => {
    timeLine.hover = null;
    redraw("time");
  });
}

function showTime() {
  const field = byId("at");
  if (document.activeElement !== field) field.value = timeText(shown.at, shown.speed < 0.1 && shown.playing ? 3 : 1);
  const line = byId("time-line");
  line.setAttribute("aria-valuemax", runLength().toFixed(1));
  line.setAttribute("aria-valuenow", shown.at.toFixed(1));
  line.setAttribute("aria-valuetext", timeText(shown.at));
  const button = byId("play");
  button.textContent = shown.playing ? "❚❚" : "▶";
  button.setAttribute("aria-label", shown.playing ? "Pause" : "Play");
  byId("live").setAttribute("aria-pressed", String(shown.follow));
  if (shown.tab === "events") showCurrentEvent();
}

// ------------------------------------------------------------------------------------------- header

function showEcology() {
  const x = model.ecology;
  document.title = plain(x.name, 60) + " – Rubicon";
  byId("name").textContent = plain(x.name, 120);
  byId("name").title = plain(x.name, 1000);
  byId("command").textContent = x.command || "";
  byId("tab-control").hidden = !x.control;
  if (!x.control && shown.tab === "control") showTab("events");
  fillControl();
  resizeMap();
  showStatus();
}

function showStatus() {
  const [text, kind] = statusText();
  const badge = byId("status");
  if (badge.textContent !== text) badge.textContent = text;
  badge.className = "badge " + kind;
  byId("length").textContent = "of " + timeText(runLength(), 0);
  if (!model.ecology) return;
  const facts = [`seed ${model.ecology.seed}`, model.ecology.mode, `now ${timeText(run.now)}`, `${countText(run.events)} events`];
  if (run.running && run.speed) facts.push(`${run.speed < 10 ? run.speed.toFixed(1) : countText(run.speed)}x`);
  byId("run-facts").textContent = facts.join(" · ");
}

function statusText() {
  if (connection.open) return run.running ? ["running", "running"] : run.ended ? ["run ended", ""] : ["connected", ""];
  if (!connection.was) return ["connecting", ""];
  const wait_s = Math.max(0, Math.ceil((connection.again_at - performance.now()) / 1000));
  return [`${run.ended ? "run ended, " : ""}connection lost, again in ${wait_s} s`, "lost"];
}

// ----------------------------------------------------------------------------------------- long lists

/** A list of which only the rows in view exist. `fill(item, index)` gives a row's children and, with
 * `mark`, its attributes; `chosen(item, index)` is called for a click. */
class List {
  constructor(element, rowHeight, { fill, mark = () => ({}), choose: chosen }) {
    Object.assign(this, { element, rowHeight, fill, mark, chosen, items: [], rows: new Map() });
    this.inner = make("div", { class: "fill" });
    element.append(this.inner);
    element.addEventListener("scroll", () => this.show());
    element.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.show()).observe(element);
  }

  set(items) {
    this.items = items;
    this.inner.style.height = items.length * this.rowHeight + "px";
    this.refresh();
  }

  /** Fills all rows in view anew. */
  refresh() {
    this.show(true);
  }

  show(anew = false) {
    const first = Math.max(0, Math.floor(this.element.scrollTop / this.rowHeight) - 4);
    const last = Math.min(this.items.length, first + Math.ceil(this.element.clientHeight / this.rowHeight) + 9);
    const spare = [];
    for (const [index, row] of this.rows)
      if (index < first || index >= last) {
        this.rows.delete(index);
        spare.push(row);
      }
    for (let i = first; i < last; ++i) {
      const old = this.rows.get(i);
      const row = old || spare.pop() || this.newRow();
      if (old && !anew) continue;
      this.rows.set(i, row);
      this.fillRow(row, i);
    }
    for (const row of spare) row.remove();
  }

  newRow() {
    const row = make("button", { type: "button", onclick: () => this.chosen(this.items[row.index], row.index) });
    row.style.height = this.rowHeight + "px";
    this.inner.append(row);
    return row;
  }

  fillRow(row, i) {
    row.index = i;
    row.className = "item";
    row.style.top = i * this.rowHeight + "px";
    row.replaceChildren(...this.fill(this.items[i], i));
    for (const [name, value] of Object.entries(this.mark(this.items[i], i))) {
      if (name === "class") row.className = "item " + value;
      else if (value === null) row.removeAttribute(name);
      else row.setAttribute(name, value);
    }
  }

  /** Brings a row into view unless somebody is at work in the list. */
  reveal(index, force = false) {
    if (!force && (this.element.matches(":hover") || this.element.contains(document.activeElement))) return;
    const top = index * this.rowHeight;
    const { scrollTop, clientHeight } = this.element;
    if (top < scrollTop || top + this.rowHeight > scrollTop + clientHeight)
      this.element.scrollTop = top - clientHeight / 2;
  }

  onKey(event) {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
    if (!step || document.activeElement.index === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const index = clamp(document.activeElement.index + step, 0, this.items.length - 1);
    this.reveal(index, true);
    this.show();
    this.rows.get(index)?.focus();
  }
}

const textSpan = (kind, text, title = null) => make("span", { class: "text " + kind, title: title && plain(title, 1000) }, plain(text));

// ----------------------------------------------------------------------------------------------- tabs

const tabs = {}; // name -> {refresh, list}

function showTab(name) {
  shown.tab = name;
  for (const button of byId("tabs").children) {
    const here = button.id === "tab-" + name;
    button.setAttribute("aria-selected", String(here));
    button.tabIndex = here ? 0 : -1;
    byId(button.getAttribute("aria-controls")).hidden = !here;
    if (here) button.scrollIntoView?.({ block: "nearest", inline: "nearest" });
  }
  refreshTab();
}

const refreshTab = throttled(250, () => tabs[shown.tab]?.refresh());

function listenToTabs() {
  for (const button of byId("tabs").children) button.addEventListener("click", () => showTab(button.id.slice(4)));
  byId("tabs").addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const all = [...byId("tabs").children].filter((x) => !x.hidden);
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
  });
}

const matches = (needle, ...texts) => texts.some((text) => String(text ?? "").toLowerCase().includes(needle));
const needleOf = (id) => byId(id).value.trim().toLowerCase();

// --------------------------------------------------------------------------------------- tab: events

function startEvents() {
  const list = new List(byId("event-list"), 26, {
    fill: (x) => [textSpan("when", timeText(x.t)), make("span", { class: "sign " + x.kind, "aria-hidden": "true" }, EVENT_SIGNS[x.kind] || "·"),
      textSpan("who", x.who, x.who), textSpan("what " + (x.kind === "event" ? "" : x.kind), x.what, x.what)],
    mark: (x, i) => ({ class: i === tabs.events.current ? "chosen" : x.t > shown.at ? "later" : "" }),
    choose: (x) => {
      showAt(x.t);
      chooseByName(x.who);
    },
  });
  tabs.events = { list, current: -1, refresh: refreshEvents };
  byId("event-filter").addEventListener("input", refreshEvents);
  byId("event-class").addEventListener("change", refreshEvents);
}

function refreshEvents() {
  const needle = needleOf("event-filter");
  const kind = byId("event-class").value;
  const found = events.filter((x) => (!kind || x.kind === kind) && (!needle || matches(needle, x.who, x.what)));
  byId("event-count").textContent = found.length === events.length ? `${countText(events.length)} events`
    : `${countText(found.length)} of ${countText(events.length)} events`;
  tabs.events.list.set(found);
  showCurrentEvent();
}

/** Marks the newest event that has happened at the shown moment. */
function showCurrentEvent() {
  const { list, current } = tabs.events;
  const now = firstAfter(list.items.length, (i) => list.items[i].t, shown.at + 1e-9) - 1;
  if (now === current) return;
  tabs.events.current = now;
  list.refresh();
  if (now >= 0) list.reveal(now);
}

/** Chooses who an event is about, if it is a mote, an island or a peer; stays on this tab. */
function chooseByName(who) {
  const name = String(who);
  const mote = model.byName.get(name) ?? model.byName.get(name.split("/").slice(0, 2).join("/"));
  const peer = model.peers.findIndex((x) => x.name === name.split("/")[0]);
  if (mote !== undefined) setChosen({ kind: "mote", index: mote });
  else if (peer >= 0) setChosen({ kind: "peer", index: peer });
}

// --------------------------------------------------------------------------------------- tab: tuples

const tuples = { list: [], leftOut: 0, folded: new Set(), open: true, chosen: null, rows: [] };
const curves = new Map(); // owner and key -> {points, asked_ms}

const tupleName = (owner, key) => owner + "\n" + key;

const askTuples = latest(async () => {
  const answer = await ask({ ask: "tuples", at_s: shown.at }, "tuples");
  if (!answer) return;
  tuples.list = answer.tuples || [];
  tuples.leftOut = answer.left_out || 0;
  if (shown.tab === "tuples") showTuples();
  else if (shown.tab === "proxies") showProxies();
});

function startTuples() {
  const list = new List(byId("tuple-list"), 24, { fill: tupleRow, mark: tupleMark, choose: clickTuple });
  list.element.addEventListener("keydown", (event) => {
    const row = list.items[document.activeElement.index];
    if (!row?.branches || (event.key !== "ArrowRight" && event.key !== "ArrowLeft")) return;
    event.stopPropagation();
    if ((event.key === "ArrowRight") !== row.open) foldTuples(row);
  });
  tabs.tuples = { list, refresh: askTuples };
  byId("tuple-filter").addEventListener("input", showTuples);
  byId("tuple-fold").addEventListener("click", () => {
    tuples.open = !tuples.open;
    tuples.folded.clear();
    showTuples();
  });
}

/** The tree of owners and parts of keys. */
function tupleTree(list) {
  const root = { children: new Map() };
  for (const [owner, key, value, changed] of list) {
    let node = branch(root, owner, owner);
    const parts = key.split(".");
    parts.forEach((part, k) => { node = branch(node, part, tupleName(owner, parts.slice(0, k + 1).join("."))); });
    node.tuple = { owner, key, value, changed };
  }
  return root;
}

function branch(node, label, path) {
  if (!node.children.has(label)) node.children.set(label, { label, path, children: new Map(), tuple: null });
  return node.children.get(label);
}

function flatten(node, depth, rows, allOpen) {
  for (const each of node.children.values()) {
    const branches = each.children.size > 0;
    const open = branches && (allOpen || tuples.folded.has(each.path) !== tuples.open);
    rows.push({ ...each, depth, branches, open });
    if (open) flatten(each, depth + 1, rows, allOpen);
  }
}

function showTuples() {
  const needle = needleOf("tuple-filter");
  const found = needle ? tuples.list.filter(([owner, key, value]) => matches(needle, owner, key, value)) : tuples.list;
  tuples.rows = [];
  flatten(tupleTree(found), 0, tuples.rows, Boolean(needle));
  const more = tuples.leftOut ? `, ${countText(tuples.leftOut)} more are left out` : "";
  byId("tuple-count").textContent = `${countText(found.length)} tuples at ${timeText(shown.at)}${more}`;
  tabs.tuples.list.set(tuples.rows);
  showTupleDetail();
}

function tupleRow(row) {
  const twist = make("span", { class: "twist", "aria-hidden": "true" }, row.branches ? (row.open ? "▾" : "▸") : "");
  twist.style.marginLeft = row.depth * 12 + "px";
  const cells = [twist,
    textSpan("tree-name" + (row.depth ? "" : " tree-owner"), row.label, row.label)];
  if (!row.tuple) return cells;
  cells.push(textSpan("tree-value", row.tuple.value, row.tuple.value));
  const spark = make("canvas", { class: "spark", "aria-hidden": "true" });
  cells.push(spark);
  withCurve(row.tuple, (points) => drawCurve(spark, points, 70, 18));
  return cells;
}

function tupleMark(row) {
  const chosen = tuples.chosen && row.tuple && row.path === tuples.chosen.path;
  return { class: chosen ? "chosen" : "", role: "treeitem", "aria-level": row.depth + 1,
    "aria-expanded": row.branches ? String(row.open) : null };
}

function foldTuples(row) {
  if (!tuples.folded.delete(row.path)) tuples.folded.add(row.path);
  showTuples();
}

function clickTuple(row) {
  if (!row.tuple) return foldTuples(row);
  const again = tuples.chosen?.path === row.path;
  if (again && row.branches) foldTuples(row);
  tuples.chosen = { path: row.path, owner: row.tuple.owner, key: row.tuple.key };
  buildTupleDetail();
  return showTuples();
}

/** Calls with the points of a tuple's curve, now or when they are there. */
function withCurve({ owner, key }, then) {
  const name = tupleName(owner, key);
  const known = curves.get(name);
  if (known) then(known.points);
  if (known && (!run.running || performance.now() - known.asked_ms < 4000)) return;
  askLazily("curve\n" + name, { ask: "curve", owner, key }, "curve", (answer) => {
    const points = (answer?.points || []).map(([t, v]) => [t, typeof v === "string" && v.trim() ? Number(v) : v])
      .filter(([t, v]) => isNumber(t) && isNumber(v));
    curves.set(name, { points, asked_ms: performance.now() });
    then(points);
  });
}

/** A small curve of steps; a line stands at the shown moment. */
function drawCurve(canvas, points, width, height, withNumbers = false) {
  const ctx = fitCanvas(canvas, width, height);
  if (points.length < 2) return;
  const values = points.map((p) => p[1]);
  const low = values.reduce((a, b) => Math.min(a, b));
  const high = values.reduce((a, b) => Math.max(a, b));
  const left = withNumbers ? 52 : 1;
  const x = (t) => left + (t / runLength()) * (width - left - 2);
  const y = (v) => height - 3 - (high > low ? (v - low) / (high - low) : 0.5) * (height - 6);
  ctx.strokeStyle = colour.c0;
  ctx.lineWidth = 1.3;
  ctx.beginPath();
  points.forEach(([t, v], i) => {
    if (i) ctx.lineTo(x(t), y(points[i - 1][1]));
    ctx.lineTo(x(t), y(v));
  });
  ctx.stroke();
  ctx.fillStyle = colour.fg;
  ctx.globalAlpha = 0.5;
  ctx.fillRect(x(shown.at), 0, 1, height);
  ctx.globalAlpha = 1;
  if (!withNumbers) return;
  ctx.fillStyle = colour.soft;
  ctx.font = "11px system-ui, sans-serif";
  ctx.textAlign = "right";
  ctx.fillText(shortNumber(high), left - 5, 12);
  if (high > low) ctx.fillText(shortNumber(low), left - 5, height - 4);
}

const shortNumber = (x) => (Math.abs(x) >= 1e6 || (x && Math.abs(x) < 1e-3) ? x.toExponential(1) : String(Number(x.toPrecision(4))));

function buildTupleDetail() {
  const { owner, key } = tuples.chosen;
  const parts = [make("h2", {}, plain(key)), make("p", { class: "soft small" }, "of " + plain(owner), make("span", { id: "tuple-changed" })),
    make("pre", { id: "tuple-value", class: "value", tabindex: 0 }), make("canvas", { id: "tuple-curve", class: "curve" })];
  const row = make("div", { class: "row" });
  row.append(make("button", { id: "tuple-explain", type: "button", disabled: hasMessages() ? null : "",
    title: hasMessages() ? "Where this value came from" : "needs a record: --record FILE",
    onclick: () => explain({ ask: "explain_tuple", owner, key, at_s: shown.at }, key) }, "explain"));
  if (mayControl()) {
    const value = make("input", { id: "tuple-new", type: "text", "aria-label": "New value", placeholder: "new value" });
    row.append(value, make("button", { id: "tuple-set", type: "button", onclick: () => setTuple(owner, key, value.value) }, "set"));
  }
  byId("tuple-detail").replaceChildren(...parts, row);
  byId("tuple-detail").hidden = false;
}

function showTupleDetail() {
  if (!tuples.chosen) return;
  const { owner, key } = tuples.chosen;
  const found = tuples.list.find((x) => x[0] === owner && x[1] === key);
  byId("tuple-value").textContent = found ? found[2] : "(not set at this moment)";
  byId("tuple-changed").textContent = found && isNumber(found[3]) ? `, set at ${timeText(found[3], 3)}` : "";
  const canvas = byId("tuple-curve");
  withCurve({ owner, key }, (points) => {
    canvas.hidden = points.length < 2;
    if (points.length > 1) drawCurve(canvas, points, canvas.clientWidth, 84, true);
  });
}

// -------------------------------------------------------------------------------------- tab: proxies

const PROXY_FACTS = new Set(["class", "id", "island", "status", "description"]);
const INPUT_PARTS = new Set(["words", "deadline", "outcome", "latency"]);
const CARDS_MOST = 300;
const cards = new Map(); // owner and prefix -> {element, told}

function startProxies() {
  tabs.proxies = { refresh: askTuples };
  byId("proxy-filter").addEventListener("input", showProxies);
}

/** Proxies are told by their tuples: PREFIX.class and PREFIX.status, readings, inputs with words. */
function proxiesOf(list) {
  const found = new Map();
  for (const [owner, key] of list)
    if (key.endsWith(".class")) found.set(tupleName(owner, key.slice(0, -6)), { owner, prefix: key.slice(0, -6), facts: {}, fields: new Map(), inputs: new Map() });
  for (const [owner, key, value] of list) {
    const parts = key.split(".");
    for (let n = 1; n < parts.length; ++n) {
      const proxy = found.get(tupleName(owner, parts.slice(0, -n).join(".")));
      if (proxy) addToProxy(proxy, parts.slice(-n), value);
    }
  }
  for (const proxy of found.values()) for (const name of proxy.inputs.keys()) proxy.fields.delete(name);
  return [...found.values()].filter((x) => "status" in x.facts).sort((a, b) => (a.prefix < b.prefix ? -1 : 1));
}

function addToProxy(proxy, [name, part, ...rest], value) {
  if (rest.length) return;
  if (part === undefined) {
    if (PROXY_FACTS.has(name)) proxy.facts[name] = value;
    else entry(proxy.fields, name).value = value;
  } else if (name === "status") proxy.facts["status." + part] = value;
  else if (part === "unit") entry(proxy.fields, name).unit = value;
  else if (INPUT_PARTS.has(part)) entry(proxy.inputs, name)[part] = value;
}

function entry(map, name) {
  if (!map.has(name)) map.set(name, {});
  return map.get(name);
}

function showProxies() {
  const needle = needleOf("proxy-filter");
  const all = proxiesOf(tuples.list);
  const found = needle ? all.filter((x) => matches(needle, x.prefix, x.facts.class, x.facts.status)) : all;
  const more = found.length > CARDS_MOST ? `; the first ${CARDS_MOST} are shown, filter for others` : "";
  byId("proxy-count").textContent = `${countText(found.length)} proxies at ${timeText(shown.at)}${more}`;
  const here = new Set();
  for (const proxy of found.slice(0, CARDS_MOST)) {
    const name = tupleName(proxy.owner, proxy.prefix);
    here.add(name);
    showCard(name, proxy);
  }
  for (const [name, card] of cards)
    if (!here.has(name)) {
      card.element.remove();
      cards.delete(name);
    }
}

/** Makes or changes a card; one in which somebody types is left alone. */
function showCard(name, proxy) {
  const told = JSON.stringify([proxy.facts, [...proxy.fields], [...proxy.inputs], mayControl()]);
  let card = cards.get(name);
  if (!card) {
    card = { element: make("article", { class: "card" }), told: "" };
    cards.set(name, card);
    byId("proxy-cards").append(card.element);
  }
  if (card.told === told || card.element.contains(document.activeElement)) return;
  card.told = told;
  card.element.replaceChildren(...cardParts(proxy));
}

function cardParts(proxy) {
  const { facts } = proxy;
  const good = facts.status === "active";
  const cause = !good && facts["status.cause"] && facts["status.cause"] !== "none" ? ` (${facts["status.cause"]})` : "";
  const fields = [...proxy.fields].flatMap(([name, x]) => [make("dt", {}, plain(name)),
    make("dd", {}, plain(x.value ?? "–", 300) + (x.unit ? " " + plain(x.unit, 20) : ""))]);
  return [make("h3", { title: plain(proxy.prefix) }, plain(proxy.prefix)),
    make("div", { class: "state" }, make("span", { class: good ? "active" : "inactive" }, (good ? "● " : "○ ") + plain(facts.status) + plain(cause)),
      make("span", { class: "soft" }, " " + plain(facts.class, 40))),
    make("dl", {}, ...fields), ...[...proxy.inputs].map(([name, x]) => inputParts(proxy, name, x))];
}

function inputParts(proxy, name, input) {
  const key = proxy.prefix + "." + name;
  const row = make("div", { class: "acts" }, make("span", { class: "soft" }, plain(name)));
  if (mayControl()) row.append(...inputControls(proxy.owner, key, input));
  row.append(make("span", { class: "soft small" }, input.outcome ? plain(input.outcome, 80) : ""));
  return row;
}

function inputControls(owner, key, input) {
  if (input.words)
    return input.words.split(" ").filter(Boolean).slice(0, 20).map((word) =>
      make("button", { type: "button", "data-key": plain(key), onclick: () => setTuple(owner, key, word) }, plain(word, 30)));
  const value = make("input", { type: "text", "aria-label": "Value for " + plain(key) });
  return [value, make("button", { type: "button", onclick: () => setTuple(owner, key, value.value) }, "set")];
}

// --------------------------------------------------------------------------------------- tab: energy

const energyOf = new Map(); // by mote: {energy, at}

function startEnergy() {
  const list = new List(byId("energy-list"), 26, {
    fill: energyRow, mark: () => ({ class: "energy-row" }), choose: (index) => choose({ kind: "mote", index }),
  });
  tabs.energy = { list, refresh: refreshEnergy };
}

function refreshEnergy() {
  const motes = shown.moment?.motes;
  if (!motes) return;
  const hours = (i) => (isNumber(motes.hours[i]) ? motes.hours[i] : Infinity);
  const order = Array.from({ length: model.count }, (_, i) => i)
    .sort((a, b) => (hours(a) === hours(b) ? (motes.used_mah[b] || 0) - (motes.used_mah[a] || 0) : hours(a) - hours(b)));
  const used = motes.used_mah.reduce((a, b) => a + (b || 0), 0);
  byId("energy-sum").textContent = `${chargeText(used)} used by ${countText(model.count)} motes at ${timeText(shown.at)}; hungriest first`;
  tabs.energy.list.set(order);
}

function energyRow(index) {
  const motes = shown.moment.motes;
  const why = make("span", { class: "text" });
  const known = energyOf.get(index);
  if (known) why.append(...energyBar(known.energy));
  const sample = shown.moment.sample_s;
  if (known?.sample !== sample)
    askLazily("energy" + index, { ask: "mote", address: addressOf(index), at_s: shown.at }, "mote", (answer) => {
      if (!answer) return;
      energyOf.set(index, { energy: answer.energy || {}, sample });
      why.replaceChildren(...energyBar(answer.energy || {}));
    });
  return [textSpan("", fullName(index), fullName(index)), make("span", {}, hoursText(motes.hours[index])),
    make("span", {}, chargeText(motes.used_mah[index])), why];
}

function energyShares(energy) {
  const shares = (energy.radio || []).map(([name, mah]) => [name, mah || 0]);
  shares.push(["processor", energy.processor || 0]);
  const sum = shares.reduce((a, [, mah]) => a + mah, 0);
  return { shares, sum };
}

function energyBar(energy) {
  const { shares, sum } = energyShares(energy);
  if (!sum) return [];
  const forwarded = isNumber(energy.forwarded_share) ? `; forwarded for others: ${shareText(energy.forwarded_share)}` : "";
  const title = shares.map(([name, mah]) => `${plain(name, 30)} ${shareText(mah / sum)}`).join(", ") + forwarded;
  return [make("span", { class: "bar", title, role: "img", "aria-label": title }, ...shares.map(([name, mah]) => {
    const part = make("i");
    part.style.width = (100 * mah) / sum + "%";
    part.style.background = colour[ENERGY_COLOURS[name] || "soft"];
    return part;
  }))];
}

// ------------------------------------------------------------------------------------- tab: messages

const messages = { list: [], total: 0, why: "", ready: false };
const MESSAGE_SIGNS = { lost: "✕", open: "…", arrived: "✓" };
const MESSAGE_ORDER = { lost: 0, open: 1, arrived: 2 };

function startMessages() {
  const list = new List(byId("message-list"), 42, { fill: messageRow, choose: explainMessage });
  tabs.messages = { list, refresh: refreshMessages };
  byId("message-which").addEventListener("change", askMessages);
  byId("message-again").addEventListener("click", askMessages);
  byId("message-filter").addEventListener("input", showMessages);
}

function refreshMessages() {
  if (run.running || !messages.ready) askMessages();
}

const NO_RECORD = "No record is kept of this run, so what became of messages is not known. "
  + "Start it with --record FILE to see them here, to have values explained, and to see frames on their way.";

const askMessages = latest(async () => {
  if (!hasMessages()) {
    messages.why = NO_RECORD;
    return showMessages();
  }
  const answer = await ask({ ask: "messages", lost: byId("message-which").value === "lost", limit: 1000 }, "messages");
  if (!answer) return undefined;
  Object.assign(messages, { ready: Boolean(answer.ready), why: answer.why || "", total: answer.total || 0, list: lostFirst(answer.messages || []) });
  return showMessages();
});

const lostFirst = (list) => [...list].sort((a, b) => (MESSAGE_ORDER[a.class] ?? 3) - (MESSAGE_ORDER[b.class] ?? 3) || b.sent_s - a.sent_s);

function showMessages() {
  const needle = needleOf("message-filter");
  const found = messages.list.filter((x) => !needle || matches(needle, x.name, x.from, x.to, x.outcome));
  byId("message-count").textContent = messages.ready ? `${countText(found.length)} shown of ${countText(messages.total)}` : plain(messages.why, 500);
  tabs.messages.list.set(found);
}

function messageRow(x) {
  const sign = make("span", { class: "sign " + (x.class === "lost" ? "lost-text" : ""), "aria-label": x.class }, MESSAGE_SIGNS[x.class] || "·");
  const lines = make("span", { class: "text what" }, make("span", { class: "text" }, plain(x.name, 60)), ` → ${plain(x.to, 60)}`, make("br"),
    make("span", { class: x.class === "lost" ? "lost-text" : "soft" }, plain(x.outcome)));
  lines.title = plain(x.outcome, 500);
  return [textSpan("when", timeText(x.sent_s)), sign, lines];
}

const explainMessage = (x) => explain({ ask: "explain", message: x.name }, x.name);

async function explain(question, title) {
  const answer = await askAny(question);
  if (!answer) return;
  shown.explained = String(title);
  byId("explain-title").textContent = plain(title);
  byId("explain-text").textContent = answer.text || "";
  byId("explain").hidden = false;
}

function closeExplain() {
  byId("explain").hidden = true;
  shown.explained = "";
}

// --------------------------------------------------------------------------------- tab: what is chosen

function setChosen(target) {
  shown.chosen = target;
  if (target?.kind === "mote") askNeighbours(target.index);
  redraw("map");
}

/** Chooses and shows its tab; nothing: nothing is chosen. */
function choose(target) {
  setChosen(target);
  if (target) showTab("details");
  else refreshTab();
}

function nameOf(target) {
  if (!target) return "";
  if (target.kind === "mote") return fullName(target.index);
  return target.kind === "peer" ? model.peers[target.index].name : model.islands[target.index].name;
}

const refreshDetails = latest(async () => {
  const target = shown.chosen;
  const parts = await detailParts(target);
  if (!sameTarget(target, shown.chosen)) return;
  const box = byId("details");
  const scrolled = box.scrollTop;
  box.replaceChildren(...parts);
  box.scrollTop = scrolled;
  for (const canvas of box.querySelectorAll("canvas.curve")) drawCurve(canvas, canvas.points, canvas.clientWidth, 84, true);
});

function startDetails() {
  tabs.details = { refresh: refreshDetails };
}

function detailParts(target) {
  if (!target) return [make("p", { class: "soft" }, "Click a mote, a sink, a gateway or a peer on the map.")];
  if (target.kind === "mote") return moteParts(target.index);
  return target.kind === "peer" ? peerParts(model.peers[target.index]) : islandParts(model.islands[target.index]);
}

const factList = (facts) => make("dl", { class: "facts" },
  ...facts.flatMap(([name, value]) => [make("dt", {}, plain(name)), make("dd", {}, plain(value, 2000))]));

async function moteParts(index) {
  const address = addressOf(index);
  const [answer, sent] = await Promise.all([ask({ ask: "mote", address, at_s: shown.at }, "mote"), messagesOf(address)]);
  const parts = [make("h2", {}, plain(fullName(index))),
    make("p", { class: "soft small" }, `mote ${address}, ${STATES[shown.moment?.motes.state[index]]?.label || STATES[0].label} at ${timeText(shown.at)}`)];
  if (mayControl()) parts.push(make("button", { id: "fault-this", type: "button", onclick: () => proposeFault("crash mote", { mote: fullName(index) }) }, "let it crash …"));
  if (!answer) return parts;
  parts.push(factList([...momentFacts(index), ...(answer.facts || [])]), ...energyParts(answer), ...neighbourParts(answer.neighbours || [], index));
  return parts.concat(sent);
}

function momentFacts(index) {
  const motes = shown.moment?.motes;
  if (!motes) return [];
  return [["arrived of its messages", shareText(motes.delivery[index])], ["hours left", hoursText(motes.hours[index])],
    ["waiting to be sent", motes.queue[index] ?? "–"]];
}

function energyParts(answer) {
  const { shares, sum } = energyShares(answer.energy || {});
  const parts = [make("h3", {}, "Energy")];
  if (sum) parts.push(...energyBar(answer.energy), factList(shares.map(([name, mah]) => [name === "off" ? "radio off" : name, chargeText(mah)])));
  if (isNumber(answer.energy?.forwarded_share)) parts.push(make("p", { class: "small" }, `${shareText(answer.energy.forwarded_share)} of what it sent was for others`));
  if (answer.used?.length > 1) {
    const canvas = make("canvas", { class: "curve", role: "img", "aria-label": "Charge used over time, mAh" });
    canvas.points = answer.used;
    parts.push(make("p", { class: "soft small" }, "used, mAh"), canvas);
  }
  return parts;
}

function neighbourParts(neighbours, index) {
  if (!neighbours.length) return [];
  const rows = neighbours.map(([name, etx]) => make("tr", {}, make("td", {}, targetButton(name, placeOf(String(name), islandOf(index)))),
    make("td", { class: "number" }, etxText(etx))));
  return [make("h3", {}, `Neighbours (${neighbours.length})`),
    make("table", {}, make("thead", {}, make("tr", {}, make("th", {}, "who"), make("th", {}, "ETX"))), make("tbody", {}, ...rows))];
}

/** A name that chooses whom it names. */
function targetButton(name, place) {
  if (!place) return make("span", {}, plain(name));
  const target = place.index === undefined ? { kind: "island", index: model.islands.indexOf(place.island) } : { kind: "mote", index: place.index };
  return make("button", { type: "button", class: "plain link", onclick: () => choose(target) }, plain(name));
}

async function messagesOf(address) {
  if (!hasMessages()) return [make("h3", {}, "Messages"), make("p", { class: "soft small" }, NO_RECORD)];
  const [lost, all] = await Promise.all([true, false].map((only) => ask({ ask: "messages", lost: only, of: address, limit: 40 }, "messages")));
  const byTheirNames = new Map([...(lost?.messages || []), ...(all?.messages || [])].map((x) => [x.name, x]));
  const found = lostFirst([...byTheirNames.values()]).slice(0, 40);
  const why = lost && !lost.ready ? lost.why : found.length ? "" : "none";
  return [make("h3", {}, "Messages, lost ones first"), make("p", { class: "soft small" }, plain(why, 500)),
    make("div", {}, ...found.map((x) => make("button", { type: "button", class: "item row message", onclick: () => explainMessage(x) }, ...messageRow(x))))];
}

function peerParts(peer) {
  const own = tuples.list.filter((x) => x[0] === peer.name);
  const about = events.filter((x) => x.t <= shown.at && (x.who === peer.name || String(x.who).startsWith(peer.name + "/"))).slice(-12).reverse();
  const parts = [make("h2", {}, plain(peer.name)), make("p", { class: "soft small" }, `${peer.gateway ? "gateway" : "PEIS peer"} ${peer.id}`)];
  if (mayControl()) parts.push(make("button", { id: "fault-this", type: "button", onclick: () => proposeFault("kill peer", { peer: peer.name }) }, "kill it …"));
  parts.push(factList([["links", peer.links.length], ...(peer.host ? [["host", peer.host]] : [])]),
    make("div", { class: "chips" }, ...peer.links.map((x) => chip(model.peers[x].name, { kind: "peer", index: x }))));
  if (peer.islands.length)
    parts.push(make("h3", {}, "Cable to the sink of"), make("div", { class: "chips" }, ...peer.islands.map((x) => chip(model.islands[x].name, { kind: "island", index: x }))));
  parts.push(make("h3", {}, "Newest events"), eventTable(about), make("button", { id: "peer-tuples", type: "button", onclick: () => {
    byId("tuple-filter").value = peer.name;
    showTab("tuples");
  } }, `its tuples${own.length ? ` (${own.length})` : ""}`));
  return parts;
}

function islandParts(island) {
  const peers = model.peers.map((x, i) => [x, i]).filter(([x]) => island.gateways.includes(x.name));
  const states = STATES.map((state, code) => [state.label, countText(island.counts[code])]).filter((_, code) => island.counts[code]);
  const motes = Array.from({ length: Math.min(island.count, 200) }, (_, k) => island.first + k);
  return [make("h2", {}, plain(island.name)), make("p", { class: "soft small" }, `island ${island.id}, ${countText(island.count)} motes, at ${timeText(shown.at)}`),
    factList(states), make("h3", {}, "Gateways"), make("div", { class: "chips" }, ...peers.map(([x, i]) => chip(x.name, { kind: "peer", index: i }))),
    make("h3", {}, island.count > 200 ? "Motes, the first 200" : "Motes"), make("div", { class: "chips" }, ...motes.map((i) => chip(model.names[i], { kind: "mote", index: i })))];
}

const chip = (name, target) => make("button", { type: "button", onclick: () => choose(target) }, plain(name, 60));

function eventTable(list) {
  if (!list.length) return make("p", { class: "soft small" }, "none");
  return make("table", {}, make("tbody", {}, ...list.map((x) => make("tr", {}, make("td", { class: "number soft" }, timeText(x.t)),
    make("td", { class: x.kind }, plain(x.what))))));
}

// -------------------------------------------------------------------------------------- tab: control

// Kinds of faults that may happen at any moment, and what has to be said of them: [key, what it is, proposal].
const FAULTS = [
  ["crash mote", [["mote", "mote"], ["for", "time", "10s"]]],
  ["crash sink", [["sink", "island"], ["for", "time", "10s"]]],
  ["battery_end", [["mote", "mote"]]],
  ["unplug", [["island", "island"], ["for", "time", "30s"]]],
  ["kill peer", [["peer", "peer"], ["for", "time", "20s"]]],
  ["power_off", [["peer", "peer"], ["for", "time", "20s"]]],
  ["pause", [["peer", "peer"], ["for", "time", "10s"]]],
  ["link_loss", [["loss", "share", "50%"], ["for", "time", "30s"]]],
  ["radio_loss", [["loss", "share", "50%"], ["island", "island"], ["for", "time", "30s"]]],
  ["duplicate_id", [["peer", "peer"], ["for", "time", "30s"]]],
  ["clock_step", [["mote", "mote"], ["by", "time", "5s"]]],
];

function startControl() {
  byId("fault-kind").replaceChildren(...FAULTS.map(([name]) => make("option", { value: name }, name.replace("_", " "))));
  byId("fault-kind").addEventListener("change", () => showFaultFields());
  byId("fault-do").addEventListener("click", () => tell({ ask: "fault", sentence: byId("fault-sentence").value.trim() }, byId("fault-sentence").value));
  byId("fault-sentence").addEventListener("keydown", (event) => { if (event.key === "Enter") byId("fault-do").click(); });
  byId("cut-do").addEventListener("click", cutLink);
  byId("set-form").addEventListener("submit", (event) => {
    event.preventDefault();
    setTuple(byId("set-owner").value, byId("set-key").value, byId("set-value").value);
  });
  tabs.control = { refresh: () => {} };
}

function fillControl() {
  if (!mayControl()) return;
  byId("set-owner").replaceChildren(...model.peers.map((x) => make("option", { value: x.name }, plain(x.name, 60))));
  byId("cut-link").replaceChildren(...model.links.map(([a, b], i) => make("option", { value: i }, `${plain(model.peers[a].name, 40)} – ${plain(model.peers[b].name, 40)}`)));
  const motes = make("datalist", { id: "mote-names" }, ...Array.from({ length: Math.min(model.count, 1000) }, (_, i) => make("option", { value: fullName(i) })));
  byId("mote-names")?.remove();
  byId("panel-control").append(motes);
  showFaultFields();
}

function showFaultFields(proposed = {}) {
  const [, keys] = FAULTS.find(([name]) => name === byId("fault-kind").value);
  byId("fault-fields").replaceChildren(...keys.map(([key, what, proposal]) => make("label", {}, key, faultField(key, what, proposed[key] ?? proposal))));
  composeFault();
}

function faultField(key, what, proposal) {
  const id = "fault-" + key;
  const names = { island: model.islands, peer: model.peers }[what];
  const field = names ? make("select", { id }, ...names.map((x) => make("option", { value: x.name }, plain(x.name, 60))))
    : make("input", { id, type: "text", list: what === "mote" ? "mote-names" : null });
  const chosen = shown.chosen?.kind === what ? nameOf(shown.chosen) : null;
  field.value = proposal ?? chosen ?? (what === "mote" && model.count ? fullName(0) : field.value);
  field.addEventListener("input", composeFault);
  return field;
}

/** The sentence of the fields; it may be changed by hand before it is said. */
function composeFault() {
  const [name, keys] = FAULTS.find(([each]) => each === byId("fault-kind").value);
  const kind = name.split(" ")[0];
  const words = keys.map(([key]) => [key, byId("fault-" + key).value.trim()]).filter(([, value]) => value).flat();
  byId("fault-sentence").value = [kind, ...words].join(" ");
}

function proposeFault(kind, proposed) {
  byId("fault-kind").value = kind;
  showFaultFields(proposed);
  showTab("control");
  byId("fault-sentence").focus();
}

function cutLink() {
  const pair = model.links[Number(byId("cut-link").value)];
  if (!pair) return;
  const names = JSON.stringify(pair.map((x) => model.peers[x].name));
  const sentence = `link_loss loss 100% peers ${names} for ${byId("cut-for").value.trim() || "30s"}`;
  tell({ ask: "fault", sentence }, sentence);
}

function setTuple(owner, key, value) {
  tell({ ask: "set", owner, key, value }, `${owner}: ${key} = ${value}`);
}

/** Says something that changes the run; the answer is listed. */
async function tell(question, title) {
  const answer = await askAny(question);
  const good = answer?.kind === "done" && answer.ok;
  const text = answer ? answer.text || (good ? "done" : "refused") : "the connection is lost";
  byId("answers").prepend(make("li", { class: good ? "yes" : "no" }, make("div", { class: "soft" }, `${timeText(run.now)}  ${plain(title, 300)}`),
    (good ? "✓ " : "✕ ") + plain(text, 1000)));
  while (byId("answers").children.length > 50) byId("answers").lastChild.remove();
  refreshTab();
}

// -------------------------------------------------------------------------------------------- search

const search = { found: [], at: 0 };
const FOUND_MOST = 12;

function findTargets(needle) {
  const found = [];
  const add = (kind, index, name, extra) => {
    if (found.length < FOUND_MOST && matches(needle, name, extra)) found.push({ kind, index, name, extra });
  };
  model.peers.forEach((x, i) => add("peer", i, x.name, x.gateway ? "gateway" : "peer"));
  model.islands.forEach((x, i) => add("island", i, x.name, "island"));
  for (let i = 0; i < model.count && found.length < FOUND_MOST; ++i) add("mote", i, fullName(i), addressOf(i));
  return found;
}

function showFound() {
  const needle = needleOf("search");
  search.found = needle ? findTargets(needle) : [];
  search.at = 0;
  const list = byId("found");
  list.hidden = !needle;
  byId("search").setAttribute("aria-expanded", String(Boolean(needle)));
  list.replaceChildren(...search.found.map((x, i) => make("li", { id: "found-" + i, role: "option", onpointerdown: (event) => {
    event.preventDefault();
    goTo(x);
  } }, make("span", { class: "text" }, plain(x.name, 80)), make("span", { class: "space" }), make("span", { class: "soft small" }, plain(x.extra, 20)))));
  if (needle && !search.found.length) list.append(make("li", { class: "soft" }, "nothing found"));
  markFound();
}

function markFound() {
  [...byId("found").children].forEach((each, i) => each.setAttribute("aria-selected", String(i === search.at)));
  byId("search").setAttribute("aria-activedescendant", search.found.length ? "found-" + search.at : "");
}

function goTo(target) {
  byId("search").value = "";
  showFound();
  byId("search").blur();
  if (target.kind === "mote") showMote(target.index);
  else if (target.kind === "island") zoomToIsland(model.islands[target.index]);
  choose({ kind: target.kind, index: target.index });
}

function listenToSearch() {
  const field = byId("search");
  field.addEventListener("input", showFound);
  field.addEventListener("blur", () => { byId("found").hidden = true; });
  field.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step && search.found.length) {
      event.preventDefault();
      search.at = (search.at + step + search.found.length) % search.found.length;
      markFound();
    } else if (event.key === "Enter" && search.found[search.at]) goTo(search.found[search.at]);
  });
}

// ------------------------------------------------------------------------------------------ keyboard

const KEYS = {
  " ": () => setPlaying(!shown.playing),
  ArrowLeft: (event) => (event.shiftKey ? stepTime(-1) : stepEvent(-1)),
  ArrowRight: (event) => (event.shiftKey ? stepTime(1) : stepEvent(1)),
  ArrowUp: () => changeSpeed(1),
  ArrowDown: () => changeSpeed(-1),
  Home: () => showAt(0),
  End: goLive,
  "+": () => zoom(1.4),
  "=": () => zoom(1.4),
  "-": () => zoom(1 / 1.4),
  "0": fitView,
  "?": () => byId("help").showModal(),
  "/": () => byId("search").focus(),
};
const MAP_KEYS = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("help").open) return;
  if (event.key === "Escape") return escape(event);
  const inField = event.target.matches?.("input, select, textarea");
  const onButton = event.key === " " && event.target.matches?.("button");
  if (inField || onButton) return;
  const shift = event.target.id === "map" && !event.shiftKey ? MAP_KEYS[event.key] : null;
  if (!shift && !KEYS[event.key]) return;
  event.preventDefault();
  if (shift) pan(...shift);
  else KEYS[event.key](event);
}

/** Closes what is open, one thing at a time. */
function escape(event) {
  if (event.target.matches?.("input")) {
    if (event.target.id === "search") event.target.value = "";
    showFound();
    event.target.blur();
  } else if (!byId("explain").hidden) closeExplain();
  else if (shown.tab === "tuples" && tuples.chosen) {
    tuples.chosen = null;
    byId("tuple-detail").hidden = true;
    tabs.tuples.list.refresh();
  } else choose(null);
}

// --------------------------------------------------------------------------------------------- start

function listenToTools() {
  const clicks = {
    "zoom-in": () => zoom(1.4), "zoom-out": () => zoom(1 / 1.4), "zoom-fit": fitView, theme: otherTheme,
    "help-open": () => byId("help").showModal(), "help-close": () => byId("help").close(), "explain-close": closeExplain,
    "to-start": () => showAt(0), "event-back": () => stepEvent(-1), "event-next": () => stepEvent(1),
    play: () => setPlaying(!shown.playing), live: goLive,
    "band-toggle": () => {
      const button = byId("band-toggle");
      button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
      resizeMap();
    },
  };
  for (const [id, run_] of Object.entries(clicks)) byId(id).addEventListener("click", run_);
  byId("link-by").addEventListener("change", () => redraw("scene"));
  byId("speed").replaceChildren(...SPEEDS.map((x) => make("option", { value: x }, x + "x")));
  byId("speed").addEventListener("change", () => setSpeed(Number(byId("speed").value)));
  byId("at").addEventListener("change", () => {
    const t = timeOf(byId("at").value);
    if (t !== null) showAt(t);
    byId("at").blur();
  });
  document.addEventListener("keydown", onKey);
}

/** For tests of this page: what it shows, to read only. */
window.rubicon = Object.freeze({
  shown: () => ({
    at_s: shown.at, sample_s: shown.moment?.sample_s ?? null, follow: shown.follow, playing: shown.playing, speed: shown.speed,
    counts: Object.fromEntries(STATES.map((state, code) => [state.name, shown.counts[code]])), motes: model.count,
    islands: model.islands.length, folded: model.islands.filter((x) => x.folded).length, peers: model.peers.length,
    selected: shown.chosen ? { kind: shown.chosen.kind, name: nameOf(shown.chosen) } : null, tab: shown.tab,
    explained: shown.explained, events: events.length, tuples: tuples.list.length, lost: { ...(shown.moment?.lost || {}) },
    used_mah: (shown.moment?.motes.used_mah || []).reduce((a, b) => a + (b || 0), 0), samples: series.times.length,
    connected: connection.open, running: run.running, now_s: run.now, run_events: run.events, control: mayControl(),
    messages: hasMessages(), zoom: view.scale / view.fitScale, theme: document.documentElement.dataset.theme,
    frames: frames.wanted() ? frames.list.length : 0, fps: frameTimes.length, scene_ms: scene.cost_ms, first_picture_ms: shown.firstPicture_ms,
  }),
  /** Where a mote or a sink is in the window, in CSS pixels; null if there is none of this name. */
  place: (name) => {
    const found = model.ecology ? placeOf(name) : null;
    const map = byId("map").getBoundingClientRect();
    return found && { x: map.left + found.x, y: map.top + found.y };
  },
});

function start() {
  startEvents();
  startTuples();
  startProxies();
  startEnergy();
  startMessages();
  startDetails();
  startControl();
  listenToMap();
  listenToTimeLine();
  listenToTabs();
  listenToSearch();
  listenToTools();
  if (innerWidth < 560) byId("band-toggle").setAttribute("aria-pressed", "false");
  setSpeed(1);
  setTheme(firstTheme());
  showTab("events");
  new ResizeObserver(resizeMap).observe(byId("map-area"));
  new ResizeObserver(() => redraw("time")).observe(byId("time-line"));
  setInterval(showStatus, 1000);
  connect();
}

start();
