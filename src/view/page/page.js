// The live page: shows a run of an ecology that a `rubicon run FILE --view PORT` serves.
// docs/view.md describes what it and the server say to each other.
// Names, keys, values and texts come from outside: they get into the page as text only.
"use strict";

// ---- helpers

const { abs, ceil, floor, hypot, max, min, PI, round } = Math;
const $ = id => document.getElementById(id);
const put = (id, text) => { if ($(id).textContent !== text) $(id).textContent = text; };
const on = (target, types, run, options) => types.split(" ").forEach(type => target.addEventListener(type, run, options));
const clamp = (x, low, high) => min(max(x, low), high);
const range = n => [...Array(n).keys()];
const isNumber = x => typeof x === "number" && Number.isFinite(x);

/** A text without controls and marks that turn its neighbours round, at most `most` characters. */
function plain(text, most = 1000) {
  const all = String(text ?? "");
  const cut = all.length > most ? all.slice(0, most - 1) + "…" : all;
  return cut.replace(/[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g, "\ufffd");
}

const labelled = (name, label) => (label ? `${name} (${plain(label, 100)})` : name); // what people call it

/** Who an event is about: `flat/hall (Flur) and 2 others`, by the label of the mote, or else of the island or peer. */
function labelledWho(who) {
  const [, mote, island, rest] = /^(([^/ ]+)(?:\/[^/ ]+)?)(.*)$/.exec(who) || [];
  const i = model.byName?.get(mote);
  if (i !== undefined && islandOf(i).labels.has(model.names[i])) return labelled(mote, islandOf(i).labels.get(model.names[i])) + rest;
  const found = [...(model.islands || []), ...(model.peers || [])].find(x => x.name === island && x.label);
  return found ? labelled(island, found.label) + who.slice(island.length) : who;
}

const plainLines = text => String(text ?? "").split("\n").map(line => plain(line, 1e5)).join("\n");

function assign(element, attributes) {
  for (const [name, value] of Object.entries(attributes))
    if (name.startsWith("on")) on(element, name.slice(2), value);
    else if (value === null || value === undefined) element.removeAttribute(name);
    else element.setAttribute(name, value);
}

/** make("p.soft.small", {title: x}, child, …): an element. Attributes may be left out; `onclick` and the like are
 * listeners, nothing is no attribute; children are elements or texts. */
function make(what, ...children) {
  const [tag, ...classes] = what.split(".");
  const element = document.createElement(tag);
  if (classes.length) element.className = classes.join(" ");
  const given = children[0];
  if (given && typeof given === "object" && !(given instanceof Node)) assign(element, children.shift());
  element.append(...children.filter(x => x !== null).map(x => (x instanceof Node ? x : plain(x))));
  return element;
}

const button = (text, run, more = {}) => make("button", { onclick: run, ...more }, text);

/** 754.5 -> "12:34.5", ecology time as the page writes it everywhere; axes leave out the tenths. */
function timeText(seconds, decimals = 1) {
  if (!isNumber(seconds)) return "–";
  const scale = 10 ** decimals;
  const t = round(seconds * scale) / scale;
  const [hours, minutes] = [floor(t / 3600), floor(t / 60) % 60];
  const rest = (t % 60).toFixed(decimals).padStart(decimals ? 3 + decimals : 2, "0");
  return (hours ? `${hours}:${String(minutes).padStart(2, "0")}:` : minutes + ":") + rest;
}

const countText = n => (isNumber(n) ? round(n).toLocaleString("en") : "–");
const shareText = x => (isNumber(x) ? (100 * x).toFixed(x === 1 ? 0 : 1) + "%" : "–");
const etxText = x => (isNumber(x) ? x.toFixed(2) : "–");
const shortNumber = x => (abs(x) >= 1e6 || (x && abs(x) < 1e-3) ? x.toExponential(1) : String(Number(x.toPrecision(4))));
const chargeText = mah => (isNumber(mah) ? shortNumber(Number(mah.toPrecision(3))) + " mAh" : "–");

function hoursText(hours) {
  if (!isNumber(hours)) return "–";
  if (hours < 1) return round(hours * 60) + " min";
  const [x, unit] = hours < 72 ? [hours, " h"] : [hours / 24, " d"];
  return (x < 10 ? x.toFixed(1) : countText(x)) + unit;
}

/** Runs one at a time; of what is wanted meanwhile, only the newest follows. */
function latest(run) {
  let busy = false;
  let again = false;
  return async () => {
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

/** Calls at most once in `ms`, and once more after the last call. */
function throttled(ms, run) {
  let timer = 0;
  let last = -Infinity;
  return () => {
    timer ||= setTimeout(() => {
      timer = 0;
      last = performance.now();
      run();
    }, max(0, last + ms - performance.now()));
  };
}

/** Index of the first of ascending times that is after `t`. */
function firstAfter(list, timeOfItem, t) {
  let low = 0;
  let high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeOfItem(list[middle]) > t) high = middle;
    else low = middle + 1;
  }
  return low;
}

// ---- signs and colours

const STATES = [ // in the order of their codes: name, label, colour
  ["absent", "not yet present", "soft"], ["joined", "joined", "good"], ["asleep", "asleep", "asleep"],
  ["lost", "lost, no route", "poor"], ["off", "off", "bad"], ["flat", "battery flat", "flat"],
];
const [ABSENT, JOINED, ASLEEP, LOST, OFF] = STATES.keys();
const LINKS = [ // classes of lines to parents: colour, width, dashes
  ["good", 2.6, []], ["fair", 1.9, []], ["poor", 1.6, [8, 3]], ["bad", 1.4, [3, 3]], ["soft", 0.8, []],
];
const UNKNOWN_LINK = 4;
const SERIES_COLOURS = ["c1", "c0", "c4", "c2", "c3", "c5"];
const ENERGY_COLOURS = { listening: "c5", receiving: "c0", sending: "c1", off: "line", processor: "c2" };
const EVENT_SIGNS = { fault: "▲", violation: "◆", expectation: "○", event: "·" };

const colour = {}; // those of page.css, for canvases

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  const style = getComputedStyle(document.documentElement);
  for (const name of ["bg", "fg", "soft", "line", "panel", "good", "fair", "poor", "bad", "asleep", "flat", "sink", ...SERIES_COLOURS])
    colour[name] = style.getPropertyValue("--" + name).trim();
  sprites.clear();
  showLegend();
  redraw("scene", "timeBase");
  refreshTab();
}

const isDark = () => document.documentElement.dataset.theme === "dark";

// ---- canvases

let ctx = null; // of the canvas that is drawn on now, in CSS pixels

/** Draws on a canvas, which is made as large as its place, and sharp on this screen. */
function drawOn(canvas, width, height, draw) {
  const before = ctx;
  const ratio = min(devicePixelRatio || 1, 2);
  const [w, h] = [max(1, round(width * ratio)), max(1, round(height * ratio))];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  draw();
  ctx = before;
}

function stroke(hue, width, path, dash = []) {
  ctx.strokeStyle = colour[hue];
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.beginPath();
  path();
  ctx.stroke();
}

function fill(hue, path) {
  ctx.fillStyle = colour[hue];
  ctx.beginPath();
  path();
  ctx.fill();
}

function write(text, x, y, { hue = "soft", align = "left", font = "12px" } = {}) {
  ctx.font = font + " system-ui, sans-serif";
  ctx.fillStyle = colour[hue];
  ctx.textAlign = align;
  ctx.textBaseline = "middle";
  ctx.fillText(text, x, y);
}

const disc = (x, y, r) => () => ctx.arc(x, y, r, 0, 7);
const box = (x, y, w, h) => () => ctx.rect(x, y, w, h);

const lines = (...points) => () => points.forEach(([x, y]) => ctx.lineTo(x, y));

/** The sign of a state. Each has a shape of its own, so that they differ without colours. */
function drawSign(code, x, y, r) {
  const hue = STATES[code][2];
  const thick = max(1, r * 0.3);
  const ring = disc(x, y, r * 0.85);
  if (code === ABSENT) stroke(hue, thick, ring, [r * 0.5, r * 0.4]);
  else if (code === JOINED) fill(hue, disc(x, y, r));
  else if (code === ASLEEP) {
    stroke(hue, thick, ring);
    fill(hue, () => ctx.arc(x, y, r * 0.85, PI / 2, 1.5 * PI));
  } else if (code === LOST) fill(hue, lines([x, y - 1.2 * r], [x + 1.15 * r, y + 0.9 * r], [x - 1.15 * r, y + 0.9 * r]));
  else if (code === OFF) {
    stroke(hue, thick * 1.4, lines([x - r, y - r], [x + r, y + r]));
    stroke(hue, thick * 1.4, lines([x + r, y - r], [x - r, y + r]));
  } else { // an empty battery
    stroke(hue, thick, box(x - r, y - 0.6 * r, 1.8 * r, 1.2 * r));
    fill(hue, box(x + 0.85 * r, y - 0.3 * r, 0.4 * r, 0.6 * r));
  }
}

const dirty = new Set();
let framePending = false;
const frameTimes = []; // of pictures in the last second, ms

/** Asks for a picture: "scene" (all of the map), "map" (what lies over it), "timeBase", "time" (its cursor). */
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
  scene.stale ||= wanted.has("scene");
  timeLine.stale ||= wanted.has("timeBase");
  if (wanted.has("scene") || wanted.has("map")) drawMap();
  if (wanted.has("timeBase") || wanted.has("time")) drawTimeLine();
  frameTimes.push(now_ms);
  while (frameTimes[0] <= now_ms - 1000) frameTimes.shift();
  if (shown.playing) redraw("map");
}

// ---- what is known

/** The ecology as the server describes it; motes in arrays by their index. */
const model = { ecology: null, count: 0, islands: [], peers: [], links: [], carried: [], byAddress: new Map(), byName: new Map(), sinks: new Map() };
/** How far the run is. */
const run = { now: 0, end: 0, running: false, ended: false, events: 0, speed: 0, samples: 0 };
/** What the page shows. */
const shown = { at_s: 0, follow: true, playing: false, speed: 1, sample_s: null, motes: null, lost: {}, counts: STATES.map(() => 0),
  chosen: null, tab: "events", explained: "", first_picture_ms: 0 };
const events = []; // {t, who, what, kind}, by time
let series = { times: [], lost: {} };

const NO_PARENT = -1;
const SINK = -2;

const mayControl = () => Boolean(model.ecology?.control);
const hasMessages = () => Boolean(model.ecology?.messages);
const runLength = () => max(run.end || model.ecology?.length_s || 0, run.now, 1e-3); // the end is known once it runs
const islandOf = mote => model.islands[model.island[mote]];
const fullName = mote => islandOf(mote).name + "/" + model.names[mote];
const addressOf = mote => islandOf(mote).id + "/" + model.ids[mote];
const joinedIn = counts => counts[JOINED] + counts[ASLEEP];
const stateLabel = mote => (STATES[shown.motes?.state[mote]] || STATES[ABSENT])[1];

function eachMote(island, visit) {
  for (let i = island.first; i < island.first + island.count; ++i) visit(i);
}

function takeEcology(x) {
  const same = model.ecology?.name === x.name && model.ecology?.command === x.command;
  model.ecology = x;
  takeMotes(x);
  takePeers(x);
  events.length = 0;
  curves.clear();
  proposal = null;
  energyOf.clear();
  for (const each of chart.curves) each.asked_ms = -Infinity;
  frames.clear();
  layOut();
  if (!same) view.placed = false;
  if (!same) shown.chosen = null;
  showEcology();
  say({ ask: "follow", on: shown.follow });
  askSeries();
  if (!shown.follow) wantMoment();
}

function takeMotes(x) {
  const islands = x.islands || [];
  model.count = islands.reduce((sum, each) => sum + each.motes.length, 0);
  for (const name of ["ids", "island", "parent"]) model[name] = new Int32Array(model.count);
  for (const name of ["x", "y", "wx", "wy"]) model[name] = new Float64Array(model.count);
  Object.assign(model, { names: [], types: [], byAddress: new Map(), byName: new Map(), sinks: new Map(), islands: [] });
  islands.forEach((each, at) => {
    const island = { id: each.id, name: each.name, label: each.label, labels: new Map(Object.entries(each.mote_labels || {})), air: each.air ?? at, sink: each.sink, gateways: each.gateways || [],
      first: model.names.length, count: each.motes.length, byId: new Map(), counts: STATES.map(() => 0) };
    model.islands.push(island);
    for (const name of [each.name + "/sink", `${each.id}/${each.sink?.id}`]) model.sinks.set(name, at);
    for (const [id, name, mx, my, type] of each.motes) {
      const i = model.names.length;
      [model.ids[i], model.island[i], model.x[i], model.y[i], model.parent[i]] = [id, at, mx, my, NO_PARENT];
      model.names.push(name.startsWith(each.name + "/") ? name.slice(each.name.length + 1) : name);
      model.types.push(type);
      island.byId.set(id, i);
      model.byAddress.set(addressOf(i), i);
      model.byName.set(fullName(i), i);
    }
  });
  model.carried = Object.entries(x.paths || {}).map(([key, path]) => ({ mote: Number(key), path }))
    .filter(each => each.mote < model.count && each.path.length > 0);
}

function takePeers(x) {
  const byName = new Map((x.peers || []).map((each, at) => [each.name, at]));
  model.peers = (x.peers || []).map(each => ({ ...each, gateway: each.kind === "gateway", links: [], islands: [] }));
  model.links = (x.peis_links || []).map(pair => pair.map(name => byName.get(name))).filter(([a, b]) => a !== undefined && b !== undefined);
  for (const [a, b] of model.links) {
    model.peers[a].links.push(b);
    model.peers[b].links.push(a);
  }
  model.islands.forEach((island, at) => island.gateways.forEach(name => model.peers[byName.get(name)]?.islands.push(at)));
  orderPeers();
}

/** Peers so that linked ones stand near each other: depth first. */
function orderPeers() {
  const order = new Set();
  for (let start = 0; start < model.peers.length; ++start)
    for (const stack = [start]; stack.length;) {
      const at = stack.pop();
      if (order.has(at)) continue;
      order.add(at);
      stack.push(...[...model.peers[at].links].sort((a, b) => model.peers[b].links.length - model.peers[a].links.length));
    }
  model.peerOrder = [...order];
}

/** A moment, asked for or, without an id, pushed. */
function takeMoment(x) {
  if (x.id === undefined && !shown.follow) return;
  if (shown.follow) shown.at_s = x.at_s;
  const motes = { ...x.motes };
  for (const name of ["state", "parent", "hops", "etx", "signal", "used_mah", "hours", "delivery", "queue"]) motes[name] ??= [];
  Object.assign(shown, { sample_s: x.sample_s, motes, lost: x.lost || {} });
  shown.counts.fill(0);
  for (const island of model.islands) {
    island.counts.fill(0);
    eachMote(island, i => {
      island.counts[STATES[motes.state[i]] ? motes.state[i] : ABSENT] += 1;
      model.parent[i] = parentOf(island, motes.parent[i]);
    });
    island.counts.forEach((n, code) => { shown.counts[code] += n; });
  }
  redraw("scene", "time");
  showLegendCounts();
  refreshTab();
}

function parentOf(island, id) {
  if (!id) return NO_PARENT;
  return island.sink?.id === id ? SINK : island.byId.get(id) ?? NO_PARENT;
}

function takeState(x) {
  if (run.samples !== x.samples) askSeriesSoon();
  Object.assign(run, { now: x.now_s, end: x.end_s, running: x.running, ended: !x.running, events: x.events, speed: x.speed, samples: x.samples });
  if (x.new_events?.length) {
    for (const [t, who, what, kind] of x.new_events) events.push({ t, who: String(who), what, kind: EVENT_SIGNS[kind] ? kind : "event" });
    events.sort((a, b) => a.t - b.t);
    redraw("timeBase");
    if (shown.tab === "events") refreshTab();
  }
  if (shown.follow) shown.at_s = run.now;
  showStatus();
  redraw("time");
}

const askSeries = latest(async () => {
  series = (await ask({ ask: "series" }, "series")) || series;
  showCauses();
});
const askSeriesSoon = throttled(1500, askSeries);

const wantMoment = latest(async () => {
  const answer = await ask({ ask: "moment", at_s: shown.at_s }, "moment");
  if (answer && !shown.follow) takeMoment(answer);
});

// ---- connection

const connection = { socket: null, open: false, was: false, wait_s: 0.5, again_at: 0, next: 1, waiting: new Map() };

function connect() {
  const url = new URL("live", location.href);
  url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  connection.socket = new WebSocket(url);
  on(connection.socket, "open", () => {
    Object.assign(connection, { open: true, was: true, wait_s: 0.5 });
    showStatus();
  });
  on(connection.socket, "message", event => take(event.data));
  on(connection.socket, "close", lostConnection);
}

function lostConnection() {
  connection.open = false;
  for (const resolve of connection.waiting.values()) resolve(null);
  connection.waiting.clear();
  connection.again_at = performance.now() + connection.wait_s * 1000;
  setTimeout(connect, connection.wait_s * 1000);
  connection.wait_s = min(connection.wait_s * 2, 8);
  showStatus();
}

function take(text) {
  let x;
  try { x = JSON.parse(text); } catch { return; }
  const resolve = connection.waiting.get(x.id);
  connection.waiting.delete(x.id);
  if (resolve) resolve(x);
  else if (x.kind === "ecology") takeEcology(x);
  else if (x.kind === "state") takeState(x);
  else if (x.kind === "moment" && x.id === undefined) takeMoment(x);
}

function say(question) {
  if (connection.open) connection.socket.send(JSON.stringify(question));
}

/** @returns the answer; null if the connection is lost, or, with a kind, if it is of another kind, as a refusal. */
async function ask(question, kind = null) {
  if (!connection.open) return null;
  const id = connection.next++;
  const answer = await new Promise(resolve => {
    connection.waiting.set(id, resolve);
    say({ ...question, id });
  });
  return kind && answer?.kind !== kind ? null : answer;
}

/** Questions for what is in view only: few at a time, the newest first, the oldest of too many never. */
const lazy = { waiting: new Map(), flying: 0 };

function askLazily(question, kind, then) {
  const name = JSON.stringify(question);
  lazy.waiting.delete(name);
  lazy.waiting.set(name, async () => then(await ask(question, kind)));
  if (lazy.waiting.size > 80) lazy.waiting.delete(lazy.waiting.keys().next().value);
  askNextLazily();
}

function askNextLazily() {
  if (lazy.flying >= 4 || !lazy.waiting.size) return;
  const [name, job] = [...lazy.waiting].pop();
  lazy.waiting.delete(name);
  lazy.flying += 1;
  job().finally(() => {
    lazy.flying -= 1;
    askNextLazily();
  });
}

// ---- the moment shown

/** Shows the moment `t`; all parts of the page follow. */
function showAt(t) {
  setPlaying(false);
  setFollow(false);
  shown.at_s = clamp(t, 0, run.now);
  moved();
  wantMoment();
}

/** The cursor is elsewhere: what depends on it without asking. */
function moved() {
  placeCarried();
  redraw("time", "map");
}

function setFollow(follow) {
  if (shown.follow === follow) return;
  shown.follow = follow;
  say({ ask: "follow", on: follow });
  showTime();
}

async function goLive() {
  setPlaying(false);
  shown.at_s = run.now;
  moved();
  if (!shown.follow) await wantMoment();
  setFollow(true);
}

function setPlaying(playing) {
  if (playing && shown.at_s >= run.now && !run.running) shown.at_s = 0;
  if (playing) setFollow(false);
  shown.playing = playing;
  play.last_ms = 0;
  frames.clear();
  showTime();
  redraw("map");
}

const play = { last_ms: 0, asked_ms: 0 };

function advance(now_ms) {
  const passed_s = play.last_ms ? min((now_ms - play.last_ms) / 1000, 0.5) : 0;
  play.last_ms = now_ms;
  shown.at_s = min(shown.at_s + passed_s * shown.speed, run.now);
  if (now_ms - play.asked_ms > 120) {
    play.asked_ms = now_ms;
    wantMoment();
  }
  frames.lookAhead();
  moved();
  if (shown.at_s < run.now) return;
  if (run.running) goLive();
  else setPlaying(false);
}

const eventTime = x => x.t;

async function nextEvent() {
  const next = events[firstAfter(events, eventTime, shown.at_s + 1e-6)]?.t;
  const t = next ?? (await ask({ ask: "next_event", after_s: shown.at_s }, "next_event"))?.event?.[0];
  if (t !== undefined) showAt(t);
}

const eventBefore = () => showAt(events[firstAfter(events, eventTime, shown.at_s - 1e-6) - 1]?.t ?? 0);
const stepTime = hundredths => showAt(shown.at_s + (runLength() * hundredths) / 100);

const SPEEDS = [0.01, 0.1, 0.5, 1, 5, 10, 50, 100, 1000];

function setSpeed(speed) {
  shown.speed = speed;
  $("speed").value = String(speed);
  frames.clear();
}

const changeSpeed = by => setSpeed(SPEEDS[clamp(SPEEDS.indexOf(shown.speed) + by, 0, SPEEDS.length - 1)]);

/** Frames in transit while the page plays slowly: [start, length, from, to, received]. */
const frames = {
  list: [], to: 0, asking: false, round: 0, again_ms: 0,

  clear() {
    Object.assign(this, { list: [], to: 0, asking: false, round: this.round + 1, again_ms: 0 });
  },

  wanted: () => shown.playing && shown.speed <= 1 && hasMessages(),
  /** A frame is too short to be seen: it is drawn at least for this long. */
  least_s: () => 0.35 * shown.speed,

  async lookAhead() {
    const ahead_s = 1.5 * shown.speed;
    if (!this.wanted() || this.asking || this.to > shown.at_s + ahead_s || performance.now() < this.again_ms) return;
    this.asking = true;
    const { round } = this;
    const from_s = max(this.to, shown.at_s - this.least_s());
    const to_s = from_s + 2 * ahead_s;
    const answer = await ask({ ask: "frames", from_s, to_s }, "frames");
    if (round !== this.round) return;
    const found = answer?.frames || [];
    const known_s = max(answer?.as_of_s ?? (answer ? to_s : from_s), from_s);
    if (known_s < to_s) this.again_ms = performance.now() + 1000; // those after it are not read yet
    this.asking = false;
    this.to = found.length >= 500 ? found[found.length - 1][0] + 1e-6 : min(known_s, to_s);
    this.list = this.list.filter(([start, length]) => start + length + this.least_s() > shown.at_s).concat(found);
  },
};

// ---- map: where things are

// World: metres, x to the right, y down, each air's ground beside the others.
const world = { airs: [], width: 1, height: 1 };
const plan = { image: null };

/** Gives each air its ground, the islands on the plan theirs together, and all motes and sinks their places in the world. */
function layOut() {
  const airs = new Map();
  for (const island of model.islands) {
    const key = isOnPlan(island) ? "plan" : island.air;
    if (!airs.has(key)) airs.set(key, { islands: [], hasPlan: false });
    airs.get(key).islands.push(island);
  }
  world.airs = [...airs.values()];
  const ofPlan = airs.get("plan") || world.airs[0];
  if (ofPlan) ofPlan.hasPlan = true;
  world.airs.forEach(measureAir);
  packAirs();
  for (const air of world.airs) for (const island of air.islands) placeIsland(air, island);
  placeCarried();
  grid.build();
  if (!model.ecology.plan || plan.image) return;
  plan.image = new Image();
  on(plan.image, "load", () => {
    layOut();
    resizeMap();
  });
  plan.image.src = "plan";
}

/** The picture's shape has it, once it is there. */
function planHeight({ width_m }) {
  const { naturalWidth, naturalHeight } = plan.image || {};
  return naturalWidth ? (width_m * naturalHeight) / naturalWidth : 0;
}

function isOnPlan({ sink }) {
  const p = model.ecology.plan;
  return Boolean(p && sink) && clamp(sink.x - p.x_m, 0, p.width_m) === sink.x - p.x_m && clamp(sink.y - p.y_m, 0, planHeight(p)) === sink.y - p.y_m;
}

const emptyArea = () => ({ x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity });

function widen(area, x, y) {
  if (!isNumber(x) || !isNumber(y)) return;
  area.x0 = min(area.x0, x);
  area.x1 = max(area.x1, x);
  area.y0 = min(area.y0, y);
  area.y1 = max(area.y1, y);
}

function measureAir(air) {
  const area = emptyArea();
  for (const island of air.islands) {
    if (island.sink) widen(area, island.sink.x, island.sink.y);
    eachMote(island, i => widen(area, model.x[i], model.y[i]));
  }
  for (const { mote, path } of model.carried)
    if (air.islands.includes(islandOf(mote))) for (const [, x, y] of path) widen(area, x, y);
  if (air.hasPlan) {
    const p = model.ecology.plan;
    if (p) {
      widen(area, p.x_m, p.y_m);
      widen(area, p.x_m + p.width_m, p.y_m + planHeight(p));
    }
  }
  if (area.x0 > area.x1) Object.assign(area, { x0: 0, y0: 0, x1: 1, y1: 1 });
  const margin = max(0.5, 0.06 * max(area.x1 - area.x0, area.y1 - area.y0));
  Object.assign(air, { left: area.x0 - margin, top: area.y1 + margin,
    width: area.x1 - area.x0 + 2 * margin, height: area.y1 - area.y0 + 2 * margin });
}

/** Airs stand in rows, from left to right, about half as high as wide in all. */
function packAirs() {
  const area = world.airs.reduce((sum, air) => sum + air.width * air.height, 0);
  const rowWidth = max(...world.airs.map(air => air.width), Math.sqrt(area * 2));
  const gap = 0.16 * Math.sqrt(area / max(world.airs.length, 1));
  let [x, y, rowHeight] = [0, 0, 0];
  world.width = 1e-3;
  for (const air of world.airs) {
    if (x > 0 && x + air.width > rowWidth) [x, y, rowHeight] = [0, y + rowHeight + gap, 0];
    Object.assign(air, { x, y });
    x += air.width + gap;
    rowHeight = max(rowHeight, air.height);
    world.width = max(world.width, x - gap);
  }
  world.height = max(y + rowHeight, 1e-3);
}

const worldX = (air, x) => air.x + x - air.left;
const worldY = (air, y) => air.y + air.top - y; // the file's y grows upwards

function placeIsland(air, island) {
  const area = emptyArea();
  eachMote(island, i => {
    model.wx[i] = worldX(air, model.x[i]);
    model.wy[i] = worldY(air, model.y[i]);
    widen(area, model.wx[i], model.wy[i]);
  });
  if (island.sink) widen(area, worldX(air, island.sink.x), worldY(air, island.sink.y));
  if (area.x0 > area.x1) Object.assign(area, { x0: air.x, x1: air.x + air.width, y0: air.y, y1: air.y + air.height });
  const [w, h] = [max(area.x1 - area.x0, 0.1), max(area.y1 - area.y0, 0.1)];
  const [cx, cy] = [(area.x0 + area.x1) / 2, (area.y0 + area.y1) / 2];
  Object.assign(island, { ground: air, area, width: w, height: h, cx, cy, folded: false, ring: 0,
    sx: island.sink ? worldX(air, island.sink.x) : cx, sy: island.sink ? worldY(air, island.sink.y) : cy,
    spacing: Math.sqrt(max(w * h, (w * w + h * h) / 20) / max(island.count, 1)) });
}

/** Carried motes are where their paths have them at the shown moment. */
function placeCarried() {
  for (const { mote, path } of model.carried) {
    const [x, y] = pathAt(path, shown.at_s);
    const { ground } = islandOf(mote);
    const [wx, wy] = [worldX(ground, x), worldY(ground, y)];
    if (wx !== model.wx[mote] || wy !== model.wy[mote]) redraw("scene");
    model.wx[mote] = wx;
    model.wy[mote] = wy;
  }
}

function pathAt(path, t) {
  const next = firstAfter(path, point => point[0], t);
  const [t1, x1, y1] = path[max(next - 1, 0)];
  const [t2, x2, y2] = path[min(next, path.length - 1)];
  const part = t2 > t1 ? (t - t1) / (t2 - t1) : 0;
  return [x1 + part * (x2 - x1), y1 + part * (y2 - y1)];
}

/** Finds motes near a place: cells of the world, each with its motes, in two flat arrays. */
const grid = {
  build() {
    this.cell = max(Math.sqrt((world.width * world.height) / max(model.count, 1)), 1e-6);
    this.columns = floor(world.width / this.cell) + 1;
    this.rows = floor(world.height / this.cell) + 1;
    this.start = new Int32Array(this.columns * this.rows + 1);
    this.items = new Int32Array(model.count);
    const cellOf = i => this.row(model.wy[i]) * this.columns + this.column(model.wx[i]);
    for (let i = 0; i < model.count; ++i) this.start[cellOf(i) + 1] += 1;
    for (let c = 0; c < this.columns * this.rows; ++c) this.start[c + 1] += this.start[c];
    const next = this.start.slice();
    for (let i = 0; i < model.count; ++i) this.items[next[cellOf(i)]++] = i;
  },

  column(x) { return clamp(floor(x / this.cell), 0, this.columns - 1); },
  row(y) { return clamp(floor(y / this.cell), 0, this.rows - 1); },

  /** Calls `visit` with each mote that may be within `r` of a place; with those that are carried, always. */
  near(x, y, r, visit) {
    for (const each of model.carried) visit(each.mote);
    for (let row = this.row(y - r); row <= this.row(y + r); ++row) {
      const first = row * this.columns;
      for (let k = this.start[first + this.column(x - r)]; k < this.start[first + this.column(x + r) + 1]; ++k) visit(this.items[k]);
    }
  },
};

// ---- map: the view

// Screen: CSS pixels of the canvas; screen = world * scale + (ox, oy).
const view = { scale: 1, ox: 0, oy: 0, fitScale: 1, width: 0, height: 0, band: 0, placed: false };

const screenX = x => x * view.scale + view.ox;
const screenY = y => y * view.scale + view.oy;
const mapWidth = () => max(view.width - view.band, 50);
const moteSpot = i => ({ x: screenX(model.wx[i]), y: screenY(model.wy[i]), r: radiusIn(islandOf(i)) });
/** Of its sink, or of the ring to which it is folded. */
const islandSpot = island => ({ x: screenX(island.folded ? island.cx : island.sx), y: screenY(island.folded ? island.cy : island.sy),
  r: island.folded ? island.ring : radiusIn(island) });
const radiusIn = island => round(clamp(island.spacing * view.scale * 0.26, 1.2, 7) * 2) / 2;

function resizeMap() {
  const place = $("map-area").getBoundingClientRect();
  const wasFit = abs(view.scale / view.fitScale - 1) < 1e-6;
  const withBand = model.peers.length && $("band-toggle").getAttribute("aria-pressed") === "true";
  Object.assign(view, { width: place.width, height: place.height, band: withBand ? (place.width > 560 ? 176 : 112) : 0 });
  if (!view.placed || wasFit) fitView();
  redraw("scene");
}

function fitView() {
  if (!view.width || !model.ecology) return;
  const [side, top, bottom] = mapWidth() < 420 ? [14, 54, 60] : [24, 48, 44];
  const [w, h] = [mapWidth() - 2 * side, view.height - top - bottom];
  view.fitScale = max(min(w / world.width, h / world.height), 1e-6);
  Object.assign(view, { scale: view.fitScale, placed: true, ox: side + (w - world.width * view.fitScale) / 2,
    oy: top + (h - world.height * view.fitScale) / 2 });
  redraw("scene");
}

/** Zooms by a factor; what is at (x, y) on the screen stays there. */
function zoom(factor, x = mapWidth() / 2, y = view.height / 2) {
  const most = model.islands.reduce((a, island) => max(a, 120 / island.spacing), view.fitScale * 40);
  const scale = clamp(view.scale * factor, view.fitScale * 0.4, most);
  view.ox = x - ((x - view.ox) * scale) / view.scale;
  view.oy = y - ((y - view.oy) * scale) / view.scale;
  view.scale = scale;
  viewMoved();
}

function pan(dx, dy) {
  view.ox += dx;
  view.oy += dy;
  viewMoved();
}

/** A picture that takes long is only shifted until there is time for a new one. */
function viewMoved() {
  hideTip();
  clearTimeout(scene.timer);
  if (scene.cost_ms < 3) return redraw("scene");
  scene.timer = setTimeout(() => redraw("scene"), 140);
  return redraw("map");
}

function showPlace(x, y, scale) {
  Object.assign(view, { scale, ox: mapWidth() / 2 - x * scale, oy: view.height / 2 - y * scale });
  redraw("scene");
}

function showIsland(island) {
  const fit = 0.8 * min(mapWidth() / island.width, (view.height - 80) / island.height);
  showPlace(island.cx, island.cy, max(fit, (FOLD_PX * 1.1) / island.spacing));
}

function showMote(i) {
  const { spacing } = islandOf(i);
  showPlace(model.wx[i], model.wy[i], spacing * view.scale < FOLD_PX * 3 ? (FOLD_PX * 4) / spacing : view.scale);
}

// ---- map: the picture

// The scene is drawn larger than the screen, once, and shifted while somebody drags it; on it lies what changes with the
// pointer or in time.
const MARGIN_PX = 160;
const FOLD_PX = 5.5; // an island whose motes are nearer to each other than this is folded,
const FOLD_LARGE_PX = 3; // or than this if it is large,
const LARGE_PX = 250; // as this
const LABEL_PX = 26; // motes farther from each other than this have names
const scene = { canvas: document.createElement("canvas"), stale: true, cost_ms: 0, timer: 0, scale: 1, ox: 0, oy: 0 };
const sprites = new Map();

function drawMap() {
  if (!view.placed) return;
  let place = scenePlace();
  if (scene.stale || place.exposed) {
    const started = performance.now();
    Object.assign(scene, { scale: view.scale, ox: view.ox, oy: view.oy, width: view.width + 2 * MARGIN_PX,
      height: view.height + 2 * MARGIN_PX, stale: false });
    drawOn(scene.canvas, scene.width, scene.height, drawScene);
    scene.cost_ms = performance.now() - started;
    place = scenePlace();
  }
  drawOn($("map"), view.width, view.height, () => {
    ctx.drawImage(scene.canvas, place.left, place.top, place.width, place.height);
    drawScaleBar();
    if (view.band) drawBand();
    drawNeighbours();
    drawMarks();
    drawProposal();
    if (frames.wanted()) drawFrames();
  });
  shown.first_picture_ms ||= round(performance.now());
}

/** Where the scene is on the screen now, and whether it does not cover it. */
function scenePlace() {
  const factor = view.scale / scene.scale;
  const [left, top] = [view.ox - (scene.ox + MARGIN_PX) * factor, view.oy - (scene.oy + MARGIN_PX) * factor];
  const [width, height] = [scene.width * factor, scene.height * factor];
  const exposed = left > 0 || top > 0 || left + width < view.width || top + height < view.height || factor > 1.6;
  return { left, top, width, height, exposed };
}

function drawScene() {
  ctx.translate(MARGIN_PX, MARGIN_PX);
  labels.clear();
  const airs = world.airs.filter(air => inView(screenX(air.x), screenY(air.y), screenX(air.x + air.width), screenY(air.y + air.height)));
  for (const air of airs) drawGround(air);
  const islands = airs.flatMap(air => air.islands);
  for (const island of islands) island.folded = isTooSmall(island);
  const folded = islands.filter(island => island.folded);
  const open = islands.filter(island => !island.folded
    && inView(screenX(island.area.x0), screenY(island.area.y0), screenX(island.area.x1), screenY(island.area.y1)));
  if (shown.motes) drawLinks(open);
  for (const draw of [drawMotes, drawSink, drawNames]) for (const island of open) draw(island);
  for (const draw of [drawRing, nameRing]) for (const island of folded) draw(island);
}

const inView = (x0, y0, x1, y1) => x1 > -MARGIN_PX && x0 < view.width + MARGIN_PX && y1 > -MARGIN_PX && y0 < view.height + MARGIN_PX;

function isTooSmall(island) {
  const large = min(island.width, island.height) * view.scale > LARGE_PX;
  return island.count > 2 && island.spacing * view.scale < (large ? FOLD_LARGE_PX : FOLD_PX);
}

function drawGround(air) {
  const ground = box(screenX(air.x), screenY(air.y), air.width * view.scale, air.height * view.scale);
  fill("panel", ground);
  stroke("line", 1, ground);
  if (!air.hasPlan) return;
  const p = model.ecology.plan;
  const place = (x, y) => [screenX(worldX(air, x)), screenY(worldY(air, y))];
  if (p && plan.image?.naturalWidth) {
    ctx.globalAlpha = 0.6;
    ctx.drawImage(plan.image, ...place(p.x_m, p.y_m + planHeight(p)), p.width_m * view.scale, planHeight(p) * view.scale);
    ctx.globalAlpha = 1;
  }
}

/** Lines to parents, one path for each class. */
function drawLinks(islands) {
  const by = $("link-by").value;
  if (by === "none") return;
  const { state } = shown.motes;
  const paths = LINKS.map(() => []);
  for (const island of islands)
    eachMote(island, i => { if (model.parent[i] !== NO_PARENT && state[i] > ABSENT && state[i] < OFF) paths[linkClass(i, by)].push(i); });
  const thin = islands.some(island => island.spacing * view.scale < 14);
  paths.forEach((motes, kind) => {
    const [hue, width, dash] = LINKS[kind];
    stroke(hue, thin ? 0.7 : width, () => { for (const i of motes) lineToParent(i); }, thin ? [] : dash);
  });
}

function lineToParent(i) {
  const from = moteSpot(i);
  const to = model.parent[i] === SINK ? islandSpot(islandOf(i)) : moteSpot(model.parent[i]);
  if (!inView(min(from.x, to.x), min(from.y, to.y), max(from.x, to.x), max(from.y, to.y))) return;
  ctx.moveTo(from.x, from.y);
  ctx.lineTo(to.x, to.y);
}

/** Which of LINKS. The delivery of messages without acknowledgement is unknown: then ETX says more. */
function linkClass(i, by) {
  const { delivery, etx, signal } = shown.motes;
  if (by === "delivery" && isNumber(delivery[i])) return classIn([0.99, 0.95, 0.8], delivery[i]);
  return by === "signal" ? classIn([-70, -80, -88], signal[i]) : classIn([-1.2, -1.6, -3], isNumber(etx[i]) ? -etx[i] : null);
}

function classIn(limits, x) {
  if (!isNumber(x)) return UNKNOWN_LINK;
  const found = limits.findIndex(limit => x >= limit);
  return found < 0 ? limits.length : found;
}

function drawMotes(island) {
  const r = radiusIn(island);
  const pictures = STATES.map((_, code) => sprite(code, r));
  const half = pictures[0].half;
  eachMote(island, i => {
    const [x, y] = [screenX(model.wx[i]), screenY(model.wy[i])];
    if (!inView(x, y, x, y)) return;
    const picture = pictures[shown.motes?.state[i]] || pictures[ABSENT];
    ctx.drawImage(picture.canvas, x - half, y - half, 2 * half, 2 * half);
    if (r > 2.5) labels.occupy(x - r, y - r, x + r, y + r);
  });
}

/** The sign of a state, drawn once for each size. */
function sprite(code, r) {
  const name = code + ":" + r;
  if (!sprites.has(name)) {
    const canvas = document.createElement("canvas");
    const half = ceil(r * 1.3) + 1;
    drawOn(canvas, 2 * half, 2 * half, () => drawSign(code, half, half, r));
    sprites.set(name, { canvas, half });
  }
  return sprites.get(name);
}

function drawSink(island) {
  if (!island.sink) return;
  const { x, y } = islandSpot(island);
  const r = max(radiusIn(island) * 1.15, 4.5);
  fill("sink", box(x - r, y - r, 2 * r, 2 * r));
  stroke("bg", 1.5, box(x - r, y - r, 2 * r, 2 * r));
  labels.occupy(x - r, y - r, x + r, y + r);
  const above = name => label(screenX(island.cx), screenY(island.area.y0) - 6, 0, name, true, [3]);
  for (const name of new Set([labelled(island.name, island.label), island.name])) if (label(x, y, r, name, true) || above(name)) return;
}

function drawNames(island) {
  if (island.spacing * view.scale < LABEL_PX) return;
  eachMote(island, i => {
    const { x, y, r } = moteSpot(i);
    if (inView(x, y, x, y)) label(x, y, r, model.names[i], false);
  });
}

/** An island too small for its motes: a ring of its states, and how many have joined. */
function drawRing(island) {
  const small = min(island.width, island.height) * view.scale * 0.3;
  const r = island.ring = clamp(6 + 2.2 * Math.log2(island.count), 7, max(7, small));
  const { x, y } = islandSpot(island);
  fill("bg", disc(x, y, r));
  let angle = -PI / 2;
  for (const code of [JOINED, ASLEEP, LOST, OFF, 5, ABSENT]) {
    const part = (island.counts[code] / island.count) * 2 * PI;
    if (part) stroke(STATES[code][2], max(3, r * 0.32), () => ctx.arc(x, y, r, angle, angle + part));
    angle += part;
  }
  const outer = r * 1.16;
  labels.occupy(x - outer, y - outer, x + outer, y + outer);
  if (r >= 9) write(joinedIn(island.counts), x, y + 0.5, { hue: "fg", align: "center", font: r < 13 ? "10px" : "12px" });
}

function nameRing(island) {
  const { x, y } = islandSpot(island);
  const wide = island.width * view.scale > 90;
  const joined = wide ? ` ${joinedIn(island.counts)}/${island.count}` : "";
  for (const [name, most] of new Map([[labelled(island.name, island.label), 32], [island.name, 16]]))
    if (label(x, y, island.ring * 1.16 - 1, plain(name, most) + joined, true, [2, 0])) return;
}

function drawScaleBar() {
  const decade = 10 ** floor(Math.log10(110 / view.scale));
  const metres = [5, 2, 1].find(n => n * decade * view.scale <= 110) * decade;
  const right = mapWidth() - 14;
  const y = mapWidth() > 480 ? 26 : 68; // below the tools
  stroke("fg", 1.5, lines([right - metres * view.scale, y], [right, y]));
  write(shortNumber(metres) + " m", right, y - 10, { align: "right" });
}

/** Where the map has room for names: a coarse picture of what is taken. */
const labels = {
  CELL: 2, // pixels

  clear() {
    this.columns = ceil((view.width + 2 * MARGIN_PX) / this.CELL);
    this.rows = ceil((view.height + 2 * MARGIN_PX) / this.CELL);
    this.taken = new Uint8Array(this.columns * this.rows);
  },

  /** Calls for the cells of a box on the screen, as slices of rows. */
  slices(x0, y0, x1, y1, visit) {
    const cell = (x, last) => clamp(floor((x + MARGIN_PX) / this.CELL), 0, last);
    const [c0, c1] = [cell(x0, this.columns - 1), cell(x1, this.columns - 1)];
    for (let r = cell(y0, this.rows - 1); r <= cell(y1, this.rows - 1); ++r) visit(r * this.columns + c0, r * this.columns + c1 + 1);
  },

  occupy(...area) {
    this.slices(...area, (from, to) => this.taken.fill(1, from, to));
  },

  isFree(...area) {
    let free = true;
    this.slices(...area, (from, to) => { free = free && !this.taken.subarray(from, to).includes(1); });
    return free;
  },
};

const widths = new Map(); // of names, in pixels

/** Writes a name right of, left of, below or above a sign, tried in this order. @returns whether there was room. */
function label(x, y, r, text, strong, order = [0, 1, 2, 3]) {
  const words = plain(text, strong ? 40 : 24);
  ctx.font = (strong ? "600 " : "") + "12px system-ui, sans-serif";
  const key = strong + words;
  if (widths.size > 20000) widths.clear();
  if (!widths.has(key)) widths.set(key, ctx.measureText(words).width);
  const w = widths.get(key);
  const places = [[x + r + 3, y], [x - r - 3 - w, y], [x - w / 2, y + r + 9], [x - w / 2, y - r - 9]];
  for (const [left, middle] of order.map(i => places[i])) {
    const cut = (x > 0 && left < 2) || (x < mapWidth() && left + w > mapWidth() - 2);
    if (cut || !labels.isFree(left, middle - 6, left + w, middle + 6)) continue;
    labels.occupy(left, middle - 6, left + w, middle + 6);
    Object.assign(ctx, { lineWidth: 3, lineJoin: "round", strokeStyle: colour.panel, textAlign: "left", textBaseline: "middle" });
    ctx.setLineDash([]);
    ctx.strokeText(words, left, middle);
    ctx.fillStyle = strong ? colour.fg : colour.soft;
    ctx.fillText(words, left, middle);
    return true;
  }
  return false;
}

// ---- map: what lies over the scene

const isMarked = (kind, index) => [pointer.over, shown.chosen].some(x => x?.kind === kind && x.index === index);

/** The neighbours of the mote that is pointed at or chosen, and its line to its parent. */
function drawNeighbours() {
  const mote = [pointer.over, shown.chosen].find(x => x?.kind === "mote")?.index;
  if (mote === undefined || islandOf(mote).folded) return;
  const { x, y } = moteSpot(mote);
  const places = (neighbours.mote === mote ? neighbours.list : []).map(([name]) => placeOf(name, islandOf(mote))).filter(Boolean);
  for (const place of places) stroke("c2", 1.5, lines([x, y], [place.x, place.y]), [2, 3]);
  if (model.parent[mote] !== NO_PARENT) stroke("fg", 3.5, () => lineToParent(mote));
}

/** Where on the screen, and who, somebody is, by a name or address as the server uses it; null: nobody. */
function placeOf(name, island = null) {
  const at = name === "sink" && island ? model.islands.indexOf(island) : model.sinks.get(name);
  if (at !== undefined) return { ...islandSpot(model.islands[at]), kind: "island", index: at, island: model.islands[at] };
  const index = model.byName.get(name) ?? model.byAddress.get(name) ?? model.byName.get(island?.name + "/" + name);
  return index === undefined ? null : { ...moteSpot(index), kind: "mote", index, island: islandOf(index) };
}

/** Rings round what is pointed at and chosen. */
function drawMarks() {
  for (const [target, width] of [[pointer.over, 1.5], [shown.chosen, 2.5]]) {
    if (!target || target.kind === "peer") continue;
    const island = target.kind === "mote" ? islandOf(target.index) : model.islands[target.index];
    const { x, y, r } = target.kind === "mote" && !island.folded ? moteSpot(target.index) : islandSpot(island);
    stroke("fg", width, disc(x, y, r + 5));
  }
}

/** Frames in transit: a dot from sender to receiver; a growing ring is a broadcast. */
function drawFrames() {
  for (const [start, length, from, to, received] of frames.list) {
    const part = (shown.at_s - start) / max(length, frames.least_s());
    if (part < 0 || part > 1) continue;
    const a = placeOf(from);
    const b = to ? placeOf(to) : null;
    if (!a || a.island.folded) continue;
    const hue = received ? "c2" : "bad";
    ctx.globalAlpha = b ? 1 : 1 - part;
    if (b) fill(hue, disc(a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), 4));
    else stroke(hue, 2, disc(a.x, a.y, 4 + 36 * part));
    if (b && !received && part > 0.8) drawSign(OFF, b.x, b.y, 6);
  }
  ctx.globalAlpha = 1;
}

// ---- map: the PEIS band beside it

const band = { step: 0, top: 0, rows: new Map() };
const CABLES_MOST = 12; // of more gateways, only the cable of what is pointed at is drawn

const peerX = () => mapWidth() + (view.band > 120 ? 44 : 30);
const peerY = peer => band.top + (band.rows.get(peer) + 0.5) * band.step;

function drawBand() {
  const n = model.peerOrder.length;
  band.step = min(34, (view.height - 50) / n);
  band.top = 36 + (view.height - 50 - band.step * n) * 0.15;
  band.rows = new Map(model.peerOrder.map((peer, row) => [peer, row]));
  fill("bg", box(mapWidth(), 0, view.band, view.height));
  stroke("line", 1, lines([mapWidth() + 0.5, 0], [mapWidth() + 0.5, view.height]));
  write(`PEIS, ${n} peers`, mapWidth() + 10, 18);
  model.peers.forEach((peer, at) => peer.islands.forEach(island => drawCable(at, island)));
  for (const pair of model.links) drawPeerLink(...pair);
  for (const peer of model.peerOrder) drawPeer(peer);
}

/** From a sink to its gateway. */
function drawCable(peer, at) {
  const marked = isMarked("peer", peer) || isMarked("island", at)
    || [pointer.over, shown.chosen].some(x => x?.kind === "mote" && model.island[x.index] === at);
  if (!marked && model.islands.length > CABLES_MOST) return;
  const { x, y, r } = islandSpot(model.islands[at]);
  stroke("sink", marked ? 2.5 : 1.2, () => {
    ctx.moveTo(peerX() - 7, peerY(peer));
    ctx.bezierCurveTo(mapWidth() - 30, peerY(peer), max(x + 40, mapWidth() - 90), y, x + r, y);
  }, [6, 3]);
}

function drawPeerLink(a, b) {
  const marked = isMarked("peer", a) || isMarked("peer", b);
  const far = abs(band.rows.get(a) - band.rows.get(b)) > 1;
  const x = peerX() - (far ? 1.3 * min(peerX() - mapWidth() - 6, 6 + abs(peerY(a) - peerY(b)) * 0.22) : 0);
  stroke(marked ? "fg" : "soft", marked ? 2.2 : 1.2, () => {
    ctx.moveTo(peerX(), peerY(a));
    ctx.bezierCurveTo(x, peerY(a), x, peerY(b), peerX(), peerY(b));
  });
}

function drawPeer(peer) {
  const [x, y] = [peerX(), peerY(peer)];
  const r = clamp(band.step * 0.3, 1.5, 7);
  const { gateway, name } = model.peers[peer];
  const corners = range(7).map(k => [x + r * Math.cos((k * PI) / 3), y + r * Math.sin((k * PI) / 3)]);
  const shape = gateway ? lines(...corners) : disc(x, y, r * 0.85);
  const marked = isMarked("peer", peer);
  fill(gateway ? "sink" : "bg", shape);
  stroke(marked ? "fg" : gateway ? "sink" : "good", marked ? 3 : 2, shape);
  if (!marked && band.rows.get(peer) % ceil(14 / band.step)) return;
  let words = plain(name, 40);
  while (words.length > 2 && ctx.measureText(words).width > view.width - x - 16) words = words.slice(0, -2) + "…";
  write(words, x + 12, y, { hue: marked ? "fg" : "soft" });
}

// ---- map: the pointer

const pointer = { over: null, down: new Map(), moved: 0, spread: 0, timer: 0, mote: -1 }; // mote: that is dragged
let proposal = null; // another position of a mote: {mote, x, y}, in metres
let neighbours = { mote: -1, list: [] }; // of the mote that was pointed at last: [[name, etx], …]

/** What is at a place of the canvas: {kind: "mote", "island" or "peer", index}, or null. */
function targetAt(x, y) {
  if (view.band && x > mapWidth()) {
    const peer = model.peerOrder[floor((y - band.top) / band.step)];
    return peer === undefined ? null : { kind: "peer", index: peer };
  }
  const away = ({ x: x1, y: y1 }) => hypot(x1 - x, y1 - y);
  let [best, found] = [13, null]; // pixels
  model.islands.forEach((island, index) => {
    const spot = islandSpot(island);
    if (away(spot) - (island.folded ? spot.r : 0) < best) [best, found] = [away(spot), { kind: "island", index }];
  });
  grid.near((x - view.ox) / view.scale, (y - view.oy) / view.scale, best / view.scale, index => {
    if (!islandOf(index).folded && away(moteSpot(index)) < best) [best, found] = [away(moteSpot(index)), { kind: "mote", index }];
  });
  return found;
}

const sameTarget = (a, b) => a?.kind === b?.kind && a?.index === b?.index;

function pointAt(event) {
  const over = model.ecology && event.type !== "pointerleave" ? targetAt(...placeInMap(event)) : null;
  if (!sameTarget(over, pointer.over)) {
    pointer.over = over;
    $("map").classList.toggle("over", Boolean(over));
    redraw("map");
    clearTimeout(pointer.timer);
    if (over?.kind === "mote") pointer.timer = setTimeout(() => askNeighbours(over.index), 120);
  }
  if (over) showTip(event, tipLines(over));
  else hideTip();
}

async function askNeighbours(mote) {
  const answer = await ask({ ask: "mote", address: addressOf(mote), at_s: shown.at_s }, "mote");
  if (!answer) return;
  neighbours = { mote, list: answer.neighbours || [] };
  redraw("map");
}

function tipLines({ kind, index: i }) {
  if (kind === "peer") return [model.peers[i].name, `${model.peers[i].gateway ? "gateway" : "peer"} ${model.peers[i].id}, ${model.peers[i].links.length} links`];
  if (kind === "island") {
    const { name, counts, count, folded } = model.islands[i];
    return [name, `${joinedIn(counts)} of ${count} joined`, folded ? "click: zoom in" : "sink"];
  }
  const { motes } = shown;
  if (!motes) return [fullName(i)];
  const parent = model.parent[i];
  const route = parent === NO_PARENT ? [] : [`by ${parent === SINK ? "the sink" : model.names[parent]}, hops ${motes.hops[i] ?? "–"}`,
    `ETX ${etxText(motes.etx[i])}, ${isNumber(motes.signal[i]) ? motes.signal[i] + " dBm" : "no signal"}`];
  return [fullName(i), stateLabel(i), ...route, `arrived ${shareText(motes.delivery[i])}`];
}

function showTip({ clientX, clientY }, texts) {
  const tip = $("tip");
  tip.replaceChildren(...texts.map(text => make("div", plain(text, 120))));
  tip.hidden = false;
  tip.style.left = clamp(clientX + 14, 4, innerWidth - tip.offsetWidth - 4) + "px";
  tip.style.top = clamp(clientY + 14, 4, innerHeight - tip.offsetHeight - 4) + "px";
}

function hideTip() {
  $("tip").hidden = true;
}

function placeInMap({ clientX, clientY }) {
  const place = $("map").getBoundingClientRect();
  return [clientX - place.left, clientY - place.top];
}

function listenToMap() {
  const map = $("map");
  on(map, "pointerdown", event => {
    pointer.down.set(event.pointerId, placeInMap(event));
    const target = model.ecology ? targetAt(...placeInMap(event)) : null;
    const isChosen = target?.kind === "mote" && sameTarget(target, shown.chosen) && pointer.down.size === 1;
    Object.assign(pointer, { moved: 0, spread: 0, mote: isChosen ? target.index : -1 });
    capture(map, event);
  });
  on(map, "pointermove", event => (pointer.down.has(event.pointerId) ? drag(event.pointerId, placeInMap(event)) : pointAt(event)));
  on(map, "pointerup pointercancel", event => {
    const wasDown = pointer.down.delete(event.pointerId);
    map.classList.remove("dragged");
    if (event.type === "pointerup" && wasDown && pointer.moved < 5 && !pointer.down.size) clickMap(...placeInMap(event));
    else if (pointer.mote >= 0) choose({ kind: "mote", index: pointer.mote });
    pointer.mote = -1;
  });
  on(map, "pointerleave", pointAt);
  on(map, "wheel", event => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...placeInMap(event));
  }, { passive: false });
}

/** Moves outside are reported too, as long as the pointer is down. */
function capture(canvas, event) {
  try { canvas.setPointerCapture(event.pointerId); } catch { /* the pointer is gone already */ }
}

/** One pointer shifts the map, two zoom it. */
function drag(id, at) {
  const before = pointer.down.get(id);
  pointer.down.set(id, at);
  pointer.moved += hypot(at[0] - before[0], at[1] - before[1]);
  if (pointer.moved < 5) return;
  $("map").classList.add("dragged");
  const [a, b] = [...pointer.down.values()];
  if (!b && pointer.mote >= 0) return propose(pointer.mote, (at[0] - view.ox) / view.scale, (at[1] - view.oy) / view.scale);
  if (!b) return pan(at[0] - before[0], at[1] - before[1]);
  const spread = hypot(a[0] - b[0], a[1] - b[1]);
  if (pointer.spread) zoom(spread / pointer.spread, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
  pointer.spread = spread;
}

/** Another position of a mote, given in the world; it is only shown, and written as TOML. */
function propose(mote, wx, wy) {
  const { ground } = islandOf(mote);
  const metres = x => Number(x.toFixed(2));
  proposal = { mote, wx, wy, x: metres(wx - ground.x + ground.left), y: metres(ground.y + ground.top - wy) };
  redraw("map");
  refreshTab();
}

/** Alt and an arrow: the selected mote's proposed position goes a hundredth of the ground on. */
function nudge([dx, dy]) {
  if (shown.chosen?.kind !== "mote") return;
  const mote = shown.chosen.index;
  const from = proposal?.mote === mote ? proposal : { wx: model.wx[mote], wy: model.wy[mote] };
  const step = islandOf(mote).ground.width / 100;
  propose(mote, from.wx + step * Math.sign(dx), from.wy + step * Math.sign(dy));
  put("said", `${proposal.x}, ${proposal.y} m`);
}

function drawProposal() {
  if (!proposal) return;
  const from = moteSpot(proposal.mote);
  const [x, y] = [screenX(proposal.wx), screenY(proposal.wy)];
  stroke("fg", 1.5, lines([from.x, from.y], [x, y]), [4, 3]);
  stroke("fg", 2, disc(x, y, from.r + 2));
  write(`${proposal.x}, ${proposal.y} m`, x + from.r + 6, y, { hue: "fg" });
}

const shellWord = text => "'" + plain(text, 1e4).replaceAll("'", "'\\''") + "'";

/** The proposed position as lines of the file, and as an option of the command. */
function proposalParts(i) {
  if (proposal?.mote !== i) return [];
  const value = `[${proposal.x}, ${proposal.y}]`;
  const island = islandOf(i).name;
  const lines = `# mote ${model.ids[i]} of island ${island}, at ${shortNumber(model.x[i])}, ${shortNumber(model.y[i])} m so far\n`
    + `[[island.mote]]\nid = ${model.ids[i]}\nposition_m = ${value}`;
  const part = name => (/^[A-Za-z0-9_-]+$/.test(name) ? name : JSON.stringify(name));
  const option = "--set " + shellWord(`island.${part(island)}.mote.${part(model.names[i])}.position_m=${value}`);
  const hasName = model.names[i] !== `${model.types[i]}-${model.ids[i]}`; // else the file has no name for it
  const cancel = () => {
    proposal = null;
    redraw("map");
    refreshTab();
  };
  const code = text => Object.assign(make("pre.value", { tabindex: 0 }), { textContent: plainLines(text) });
  return [make("h3", "Proposed position"), make("p.soft.small", "The run stays as it is. In the file (keep a third number, its height):"), code(lines),
    ...(hasName ? [make("p.soft.small", "or added to the command of the run:"), code(option)] : []), button("discard", cancel, { id: "proposal-discard" })];
}

function clickMap(x, y) {
  const target = model.ecology ? targetAt(x, y) : null;
  const island = target?.kind === "island" ? model.islands[target.index] : null;
  if (island?.folded) showIsland(island);
  hideTip();
  choose(target);
}

// ---- legend

function showLegend() {
  const keys = STATES.map(([, text], code) => make("span.key", signPicture(code), text, make("b")));
  $("legend").replaceChildren(...keys);
  $("help-signs").replaceChildren(...STATES.map(([, text], code) => make("span.key", signPicture(code), text)),
    make("span.key", swatch("sink"), "sink; as a hexagon: its gateway"));
  $("energy-legend").replaceChildren(...Object.entries(ENERGY_COLOURS).map(([name, hue]) => make("span.key", swatch(hue), radioWord(name))));
  showLegendCounts();
}

const radioWord = name => (name === "off" ? "radio off" : name);

function signPicture(code) {
  const canvas = make("canvas.sign-picture", { "aria-hidden": "true" });
  drawOn(canvas, 16, 16, () => drawSign(code, 8, 8, 5.5));
  return canvas;
}

function swatch(hue) {
  const square = make("span.swatch");
  square.style.background = `var(--${hue})`;
  return square;
}

function showLegendCounts() {
  [...$("legend").children].forEach((key, code) => {
    key.lastChild.textContent = countText(shown.counts[code]);
    key.hidden = shown.counts[code] === 0;
  });
}

// ---- time line

const TIME_HEIGHT = 118;
const LANES = { faults: 12, events: 30, top: 42, bottom: 98 };
const TIME_STEPS = [0.01, 0.05, 0.1, 0.5, 1, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600, 43200, 86400, 604800];
// What is no loss, but is counted beside losses, is hidden at first.
const timeLine = { base: document.createElement("canvas"), stale: true, width: 0, length: 0, hover: null, causes: [],
  hidden: new Set(["radio/filtered", "radio/duplicate", "radio/off"]) };

const timeLeft = () => (timeLine.width > 500 ? 54 : 10);
const timeSpan = () => timeLine.width - timeLeft() - 12;
const timeX = t => timeLeft() + (t / runLength()) * timeSpan();
const timeAtX = x => clamp((x - timeLeft()) / timeSpan(), 0, 1) * runLength();

/** The causes that lost most: keys to switch them off and on. */
function showCauses() {
  const total = cause => series.lost[cause][series.lost[cause].length - 1] || 0;
  timeLine.causes = Object.keys(series.lost).filter(total)
    .sort((a, b) => timeLine.hidden.has(a) - timeLine.hidden.has(b) || total(b) - total(a)).slice(0, SERIES_COLOURS.length);
  $("causes").replaceChildren(...timeLine.causes.map((cause, k) => button(swatch(SERIES_COLOURS[k]), () => toggleCause(cause),
    { "aria-pressed": !timeLine.hidden.has(cause), title: `${cause}: ${countText(total(cause))} lost so far` })));
  timeLine.causes.forEach((cause, k) => $("causes").children[k].append(plain(cause, 30)));
  redraw("timeBase");
}

function toggleCause(cause) {
  if (!timeLine.hidden.delete(cause)) timeLine.hidden.add(cause);
  showCauses();
}

function drawTimeLine() {
  const canvas = $("time-line");
  const width = canvas.clientWidth;
  if (!width) return;
  if (timeLine.stale || timeLine.width !== width || timeLine.length !== runLength()) {
    Object.assign(timeLine, { width, length: runLength(), stale: false });
    drawOn(timeLine.base, width, TIME_HEIGHT, drawTimeBase);
  }
  drawOn(canvas, width, TIME_HEIGHT, drawCursor);
  showTime();
}

function drawCursor() {
  ctx.drawImage(timeLine.base, 0, 0, timeLine.width, TIME_HEIGHT);
  ctx.globalAlpha = 0.7;
  fill("bg", box(timeX(run.now), 0, timeX(runLength()) - timeX(run.now), LANES.bottom)); // not yet
  ctx.globalAlpha = 1;
  if (timeLine.hover !== null) fill("soft", box(timeLine.hover - 0.5, 0, 1, LANES.bottom));
  const x = timeX(shown.at_s);
  fill("fg", box(x - 1, 0, 2, LANES.bottom + 2));
  fill("fg", lines([x - 6, LANES.bottom + 9], [x + 6, LANES.bottom + 9], [x, LANES.bottom]));
}

/** All that does not move with the cursor. */
function drawTimeBase() {
  fill("panel", box(timeLeft(), 0, timeSpan(), LANES.bottom));
  drawTimeAxis();
  drawLosses();
  drawEventMarks();
  if (timeLeft() < 50) return;
  for (const [text, y] of [["faults", LANES.faults], ["events", LANES.events], ["losses", (LANES.top + LANES.bottom) / 2]]) write(text, 2, y);
}

const timeStep = (length_s, width) => TIME_STEPS.find(x => x >= (length_s * 85) / width) || length_s;

function drawTimeAxis() {
  const step = timeStep(runLength(), timeLine.width);
  for (let k = 0; k * step <= runLength() * 1.0001; ++k) {
    const x = round(timeX(k * step)) + 0.5;
    stroke("line", 1, lines([x, 0], [x, LANES.bottom + 3]));
    writeWithin(timeText(k * step, step < 1 ? 2 : 0), x, LANES.bottom + 13, timeLine.width);
  }
}

/** A label of an axis, in the middle of `x`, but not cut by the edges. */
function writeWithin(text, x, y, width) {
  ctx.font = "12px system-ui, sans-serif";
  const half = ctx.measureText(text).width / 2;
  write(text, clamp(x, half + 2, width - half - 2), y, { align: "center" });
}

/** Losses between samples, stacked by cause. */
function drawLosses() {
  const { times } = series;
  const causes = timeLine.causes.filter(cause => !timeLine.hidden.has(cause));
  const lost = causes.map(cause => series.lost[cause].map((x, i, all) => max(0, x - (all[i - 1] || 0))));
  const most = times.reduce((a, _, i) => max(a, lost.reduce((sum, each) => sum + each[i], 0)), 1);
  const unit = (LANES.bottom - LANES.top) / most;
  const below = new Float64Array(times.length);
  lost.forEach((each, k) => fill(SERIES_COLOURS[timeLine.causes.indexOf(causes[k])], () => each.forEach((n, i) => {
    if (!n) return;
    const x = timeX(times[i - 1] || 0);
    ctx.rect(x, LANES.bottom - (below[i] + n) * unit, max(timeX(times[i]) - x, 1), n * unit);
    below[i] += n;
  })));
}

const EVENT_MARKS = { // in the order in which they lie over each other
  event: x => fill("soft", box(x - 0.75, LANES.events - 6, 1.5, 12)),
  expectation: x => stroke("c2", 2, disc(x, LANES.faults, 4)),
  fault: x => fill("poor", lines([x, LANES.faults - 6], [x + 6, LANES.faults + 5], [x - 6, LANES.faults + 5])),
  violation: x => {
    fill("bad", lines([x, LANES.faults - 7], [x + 6, LANES.faults], [x, LANES.faults + 7], [x - 6, LANES.faults]));
    fill("bad", box(x - 0.75, LANES.faults, 1.5, LANES.bottom - LANES.faults));
  },
};

/** At most one of a class for each pixel. */
function drawEventMarks() {
  for (const [kind, draw] of Object.entries(EVENT_MARKS))
    for (const x of new Set(events.filter(each => each.kind === kind).map(each => round(timeX(each.t))))) draw(x);
}

/** The event nearest to a time, within a few pixels. */
function eventNear(t) {
  const after = firstAfter(events, eventTime, t);
  const away = x => abs(timeX(x.t) - timeX(t));
  return [events[after - 1], events[after]].filter(x => x && away(x) < 5).sort((a, b) => away(a) - away(b))[0];
}

function listenToTimeLine() {
  const canvas = $("time-line");
  let held = false;
  const x = event => event.clientX - canvas.getBoundingClientRect().left;
  on(canvas, "pointerdown", event => {
    held = true;
    capture(canvas, event);
  });
  on(canvas, "pointerdown pointermove", event => {
    timeLine.hover = held ? null : x(event);
    const t = timeAtX(x(event));
    if (held) showAt(t);
    redraw("time");
    const near = eventNear(t);
    showTip({ clientX: event.clientX, clientY: event.clientY - 80 }, [timeText(t), ...(near ? [`${EVENT_SIGNS[near.kind]} ${plain(labelledWho(near.who), 60)} ${near.what}`] : [])]);
  });
  on(canvas, "pointerup pointercancel", () => { held = false; });
  on(canvas, "pointerleave", () => {
    timeLine.hover = null;
    hideTip();
    redraw("time");
  });
}

function showTime() {
  if (document.activeElement !== $("at")) $("at").value = timeText(shown.at_s, shown.playing && shown.speed <= 0.1 ? 3 : 1);
  assign($("time-line"), { "aria-valuemax": runLength().toFixed(1), "aria-valuenow": shown.at_s.toFixed(1), "aria-valuetext": timeText(shown.at_s) });
  put("play", shown.playing ? "❚❚" : "▶");
  $("play").setAttribute("aria-label", shown.playing ? "Pause" : "Play");
  put("live", run.ended ? "▶| end" : "● live");
  assign($("live"), { "aria-pressed": run.ended ? null : shown.follow, title: run.ended ? "To the end (End)" : "Follow the newest (End)" });
  put("length", "of " + timeText(runLength()) + dayTime());
  if (shown.tab === "events") showCurrentEvent();
}

// ---- header

function showEcology() {
  const x = model.ecology;
  document.title = plain(x.name, 60) + " – Rubicon";
  put("name", plain(x.name));
  put("command", plain(x.command));
  $("tab-control").hidden = !x.control;
  if (!x.control && shown.tab === "control") showTab("events");
  if (x.control) proposeFault("crash mote");
  resizeMap();
  showStatus();
}

function showStatus() {
  const [text, kind] = statusText();
  if ($("status").textContent !== text) put("status", text);
  $("status").className = "badge " + kind;
  put("length", "of " + timeText(runLength()) + dayTime());
  if (!model.ecology) return;
  const facts = [`seed ${model.ecology.seed}`, model.ecology.mode, `now ${timeText(run.now)}`, ...(run.events ? [`${countText(run.events)} events`] : [])];
  if (run.running && run.speed) facts.push(`${run.speed < 10 ? run.speed.toFixed(1) : countText(run.speed)}x`);
  put("run-facts", facts.join(" · "));
}

/** The time of day at the shown moment, of a run that starts at another than midnight. */
function dayTime() {
  const start_s = model.ecology?.start_s;
  if (!start_s) return "";
  const s = floor(start_s + shown.at_s) % 86400;
  return ` · clock ${[floor(s / 3600), floor(s / 60) % 60, s % 60].map(x => String(x).padStart(2, "0")).join(":")}`;
}

function statusText() {
  if (connection.open) return run.running ? ["running", "running"] : [run.ended ? "run ended" : "connected", ""];
  if (!connection.was) return ["connecting", ""];
  const wait_s = max(0, ceil((connection.again_at - performance.now()) / 1000));
  return [`${run.ended ? "run ended, " : ""}connection lost, again in ${wait_s} s`, "lost"];
}

// ---- long lists

/** A list of which only the rows in view exist. `fillRow(item, index)` gives a row's children, `mark(item, index)` its attributes
 * (class: beside "item"), `clicked(item)` is called for a click. */
class List {
  constructor(id, rowHeight, fillRow, clicked, mark = () => ({})) {
    Object.assign(this, { element: $(id), rowHeight, fillRow, clicked, mark, items: [], rows: new Map(), inner: make("div") });
    this.element.append(this.inner);
    on(this.element, "scroll", () => this.show());
    on(this.element, "keydown", event => this.onKey(event));
    new ResizeObserver(() => this.show()).observe(this.element);
  }

  set(items) {
    this.items = items;
    this.inner.style.height = items.length * this.rowHeight + "px";
    this.show(true);
  }

  /** Makes the rows in view; `anew`: fills those too that are there. */
  show(anew = false) {
    const first = max(0, floor(this.element.scrollTop / this.rowHeight) - 4);
    const last = min(this.items.length, first + ceil(this.element.clientHeight / this.rowHeight) + 9);
    for (const [index, row] of this.rows)
      if (index < first || index >= last) {
        row.remove();
        this.rows.delete(index);
      }
    for (let i = first; i < last; ++i)
      if (anew || !this.rows.has(i)) this.showRow(i);
  }

  showRow(i) {
    if (!this.rows.has(i)) {
      const row = button("", () => this.clicked(this.items[i]));
      row.style.height = this.rowHeight + "px";
      row.style.top = i * this.rowHeight + "px";
      row.index = i;
      this.rows.set(i, row);
      this.inner.append(row);
    }
    const row = this.rows.get(i);
    row.replaceChildren(...this.fillRow(this.items[i], i));
    const { class: kind = "", ...attributes } = this.mark(this.items[i], i);
    row.className = "item " + kind;
    assign(row, attributes);
  }

  /** Brings a row into view unless somebody is at work in the list. */
  reveal(index, force = false) {
    if (!force && (this.element.matches(":hover") || this.element.contains(document.activeElement))) return;
    const top = index * this.rowHeight;
    const { scrollTop, clientHeight } = this.element;
    if (top < scrollTop || top + this.rowHeight > scrollTop + clientHeight) this.element.scrollTop = top - clientHeight / 2;
  }

  onKey(event) {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
    const from = document.activeElement.index;
    if (!step || from === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const index = clamp(from + step, 0, this.items.length - 1);
    this.reveal(index, true);
    this.show();
    this.rows.get(index)?.focus();
  }
}

/** A text in one line that may be cut; the whole of it is its title. */
const cell = (kind, text) => make("span.text" + kind, { title: plain(text) }, plain(text, 200));

/** The same, but what is cut is not its end: "writes kitchen.fan.sw… = on". */
function withTail(kind, text) {
  const whole = plain(text, 200);
  const at = max(whole.lastIndexOf(" = "), whole.lastIndexOf(" to "), whole.length - 14);
  const [head, tail] = whole.length > 22 && whole.length - at <= 20 ? [whole.slice(0, at), whole.slice(at)] : [whole, ""];
  return make("span.parted" + kind, { title: plain(text) }, make("span.text", head), make("span.tail", tail));
}

// ---- tabs

const tabs = {}; // by name: {refresh, list}
const panelOf = tab => $(tab.id.replace("tab", "panel"));

function showTab(name) {
  if (name !== shown.tab) closeExplain();
  shown.tab = name;
  for (const each of $("tabs").children) {
    const here = each.id === "tab-" + name;
    each.setAttribute("aria-selected", here);
    each.tabIndex = here ? 0 : -1;
    panelOf(each).hidden = !here;
    if (here) each.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
  refreshTab();
}

const refreshTab = throttled(250, () => tabs[shown.tab].refresh());

function listenToTabs() {
  for (const each of $("tabs").children) {
    on(each, "click", () => {
      showTab(each.id.slice(4));
      $("side").scrollIntoView(); // on a telephone it is below
    });
    assign(panelOf(each), { "aria-labelledby": each.id, role: "tabpanel" });
    assign(each, { role: "tab" });
  }
  on($("tabs"), "keydown", event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const all = [...$("tabs").children].filter(x => !x.hidden);
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
  });
}

const matches = (needle, ...texts) => !needle || texts.some(text => String(text ?? "").toLowerCase().includes(needle));
const needleOf = id => $(id).value.trim().toLowerCase();

// ---- tab: events

function startEvents() {
  const row = x => [cell(".when", timeText(x.t)), make("span.sign." + x.kind, EVENT_SIGNS[x.kind]), cell(".who", labelledWho(x.who)), withTail(".what." + x.kind, x.what)];
  const clicked = x => {
    showAt(x.t);
    chooseByName(x.who);
  };
  const mark = (x, i) => ({ class: i === tabs.events.current ? "chosen" : x.t > shown.at_s ? "later" : "" });
  tabs.events = { list: new List("event-list", 26, row, clicked, mark), current: -1, refresh: showEvents };
  on($("event-filter"), "input", showEvents);
  on($("event-class"), "change", showEvents);
}

function showEvents() {
  const kind = $("event-class").value;
  const needle = needleOf("event-filter");
  const found = events.filter(x => (!kind || x.kind === kind) && (!needle || matches(needle, x.who, labelledWho(x.who), x.what)));
  put("event-count", (found.length < events.length ? countText(found.length) + " of " : "") + countText(events.length) + " events");
  tabs.events.list.set(found);
  showCurrentEvent();
}

/** Marks the newest event that has happened at the shown moment. */
function showCurrentEvent() {
  const { list, current } = tabs.events;
  const now = firstAfter(list.items, eventTime, shown.at_s + 1e-6) - 1;
  if (now === current) return;
  tabs.events.current = now;
  list.show(true);
  if (now >= 0) list.reveal(now);
}

/** Chooses who an event is about, if it is a mote or a peer, and stays on this tab. */
function chooseByName(name) {
  const [first, second] = name.split("/");
  const mote = model.byName.get(name) ?? model.byName.get(first + "/" + second);
  const peer = model.peers.findIndex(x => x.name === first);
  if (mote !== undefined) setChosen({ kind: "mote", index: mote });
  else if (peer >= 0) setChosen({ kind: "peer", index: peer });
}

// ---- tab: tuples

const tuples = { list: [], leftOut: 0, turned: new Set(), open: true, chosen: null };
const curves = new Map(); // by tupleName(): {points, asked_ms}

const tupleName = (owner, key) => owner + "\n" + key;

const askTuples = latest(async () => {
  const answer = await ask({ ask: "tuples", at_s: shown.at_s }, "tuples");
  if (!answer) return;
  Object.assign(tuples, { list: answer.tuples || [], leftOut: answer.left_out || 0 });
  if (shown.tab === "tuples") showTuples();
  else if (shown.tab === "proxies") showProxies();
  else if (shown.tab === "curves") refreshChart();
});

function startTuples() {
  const list = new List("tuple-list", 24, tupleRow, clickTuple, tupleMark);
  tabs.tuples = { list, refresh: askTuples };
  on($("tuple-filter"), "input", showTuples);
  on($("tuple-fold"), "click", () => {
    tuples.open = !tuples.open;
    tuples.turned.clear();
    showTuples();
  });
}

/** The tree of owners and parts of keys. */
function tupleTree(list) {
  const root = { children: new Map() };
  for (const [owner, key, value, changed] of list) {
    let node = root;
    let path = owner;
    [owner, ...key.split(".")].forEach((label, depth) => {
      path = depth ? tupleName(path, label) : owner;
      if (!node.children.has(label)) node.children.set(label, { label, path, depth, children: new Map(), tuple: null });
      node = node.children.get(label);
    });
    node.tuple = { owner, key, value, changed };
  }
  return root;
}

function flatten(node, rows, allOpen) {
  for (const each of node.children.values()) {
    const branches = each.children.size > 0;
    const open = branches && (allOpen || tuples.turned.has(each.path) !== tuples.open);
    rows.push({ ...each, branches, open });
    if (open) flatten(each, rows, allOpen);
  }
  return rows;
}

function showTuples() {
  const needle = needleOf("tuple-filter");
  const found = tuples.list.filter(([owner, key, value]) => matches(needle, owner, key, value));
  const more = tuples.leftOut ? `, ${countText(tuples.leftOut)} more are omitted` : "";
  put("tuple-count", `${countText(found.length)} tuples at ${timeText(shown.at_s)}${more}`);
  tabs.tuples.list.set(flatten(tupleTree(found), [], Boolean(needle)));
  if (tuples.chosen) showTupleDetail();
}

function tupleRow({ label: text, depth, branches, open, tuple }) {
  const twist = make("span.twist", branches ? (open ? "▾" : "▸") : "");
  twist.style.marginLeft = depth * 12 + "px";
  const name = cell(depth ? ".tree-name" : ".tree-name.tree-owner", text);
  if (!tuple) return [twist, name];
  const spark = make("canvas.spark", { "aria-hidden": "true" });
  withCurve(tuple, points => drawCurve(spark, points, 70, 18));
  return [twist, name, cell(".tree-value", tuple.value), spark];
}

function tupleMark({ tuple, branches, open }) {
  const chosen = tuple && tuple.owner === tuples.chosen?.owner && tuple.key === tuples.chosen.key;
  return { class: chosen ? "chosen" : "", "aria-expanded": branches ? open : null };
}

function foldTuples({ path }) {
  if (!tuples.turned.delete(path)) tuples.turned.add(path);
  showTuples();
}

function clickTuple(row) {
  if (!row.tuple) return foldTuples(row);
  const { owner, key } = row.tuple;
  tuples.chosen = { owner, key };
  const value = make("input", { id: "tuple-new", type: "text", "aria-label": "New value", placeholder: "new value" });
  const outcome = make("p.small", { id: "tuple-outcome", role: "status" });
  const set = async () => {
    const { good, text } = await setTuple(owner, key, value.value);
    outcome.className = good ? "small good" : "small bad";
    outcome.textContent = plain(good ? `✓ ${value.value}: ${text}` : `✕ ${value.value}: refused: ${text}`, 300);
  };
  const control = mayControl() ? [value, button("set", set, { id: "tuple-set" })] : [];
  $("tuple-detail").replaceChildren(make("h2", key), make("p.soft.small", "of " + owner, make("span", { id: "tuple-changed" })),
    make("pre.value", { id: "tuple-value", tabindex: 0 }), make("canvas.curve", { id: "tuple-curve" }),
    make("div.row", button("explain", () => explain({ ask: "explain_tuple", owner, key, at_s: shown.at_s }, key), { id: "tuple-explain",
      disabled: hasMessages() ? null : "", title: hasMessages() ? "Where this value came from" : "needs a record: --record FILE" }),
      button("chart", () => chartTuple(owner, key), { id: "tuple-chart", title: "Lay its curve into the chart" }), ...control), outcome);
  $("tuple-detail").hidden = false;
  return showTuples();
}

function showTupleDetail() {
  const { owner, key } = tuples.chosen;
  const found = tuples.list.find(x => x[0] === owner && x[1] === key);
  put("tuple-value", found ? plainLines(found[2]) : "(not set at this moment)");
  put("tuple-changed", found ? `, set at ${timeText(found[3])}` : "");
  const canvas = $("tuple-curve");
  withCurve({ owner, key }, points => {
    canvas.hidden = points.length < 2;
    drawCurve(canvas, points, canvas.clientWidth, 84, true);
  });
}

/** Calls with the points of a tuple's curve, now or when they are there. */
function withCurve({ owner, key }, then) {
  const name = tupleName(owner, key);
  const known = curves.get(name);
  if (known) then(known.points);
  if (known && (!run.running || performance.now() - known.asked_ms < 4000)) return;
  askLazily({ ask: "curve", owner, key }, "curve", answer => {
    const points = (answer?.points || []).filter(([t, v]) => isNumber(t) && isNumber(v));
    curves.set(name, { points, asked_ms: performance.now() });
    then(points);
  });
}

/** A curve of steps; a line stands at the shown moment. */
function drawCurve(canvas, points, width, height, withNumbers = false, length_s = runLength()) {
  const [low, high] = points.reduce(([a, b], [, v]) => [min(a, v), max(b, v)], [Infinity, -Infinity]);
  const left = withNumbers ? 62 : 1;
  const x = t => left + (t / length_s) * (width - left - 2);
  const y = v => height - 3 - (high > low ? (v - low) / (high - low) : 0.5) * (height - 6);
  drawOn(canvas, width, height, () => {
    if (points.length < 2) return;
    stroke("c0", 1.3, lines(...points.flatMap(([t, v], i) => [[x(t), y(points[max(i - 1, 0)][1])], [x(t), y(v)]])));
    fill("soft", box(x(shown.at_s), 0, 1, height));
    if (!withNumbers) return;
    write(shortNumber(high), left - 5, 9, { align: "right" });
    if (high > low) write(shortNumber(low), left - 5, height - 8, { align: "right" });
  });
}

// ---- tab: proxies

const PROXY_FACTS = ["class", "id", "island", "status", "description"];
const INPUT_PARTS = ["words", "range", "deadline", "outcome"]; // readings have units and latencies too
const CARDS_MOST = 300;
function startProxies() {
  tabs.proxies = { refresh: throttled(700, askTuples) }; // cards have many canvases
  on($("proxy-filter"), "input", showProxies);
}

/** Proxies are recognised by their tuples: PREFIX.class and PREFIX.status, readings with units, inputs with words. */
function proxiesOf(list) {
  const found = new Map();
  for (const [owner, key] of list)
    if (key.endsWith(".class")) found.set(tupleName(owner, key.slice(0, -6)), { owner, prefix: key.slice(0, -6), facts: {}, fields: new Map(), inputs: new Map() });
  for (const [owner, key, value, changed_s] of list) {
    const parts = key.split(".");
    for (const n of [1, 2]) {
      const proxy = found.get(tupleName(owner, parts.slice(0, -n).join(".")));
      if (proxy) addToProxy(proxy, parts.slice(-n), value, changed_s);
    }
  }
  for (const proxy of found.values())
    for (const [name, input] of proxy.inputs) {
      proxy.inputs.set(name, { ...proxy.fields.get(name), ...input });
      proxy.fields.delete(name);
    }
  return [...found.values()].filter(x => "status" in x.facts).sort((a, b) => (a.prefix < b.prefix ? -1 : 1));
}

function addToProxy({ facts, fields, inputs }, [name, part], value, changed_s) {
  const keep = (map, what) => map.set(name, { ...map.get(name), [what]: value, [what + "_s"]: changed_s });
  if (name === "status" && part) facts["status." + part] = value;
  else if (!part && PROXY_FACTS.includes(name)) facts[name] = value;
  else if (!part || part === "unit") keep(fields, part || "value");
  else if (INPUT_PARTS.includes(part)) keep(inputs, part);
}

function showProxies() {
  const needle = needleOf("proxy-filter");
  const found = proxiesOf(tuples.list).filter(x => matches(needle, x.prefix, x.facts.class, x.facts.status));
  const more = found.length > CARDS_MOST ? `; the first ${CARDS_MOST} are shown, filter for others` : "";
  put("proxy-count", `${countText(found.length)} proxies at ${timeText(shown.at_s)}${more}`);
  const cards = $("proxy-cards");
  if (cards.querySelector("input:focus, select:focus")) return; // somebody types
  const focused = cards.contains(document.activeElement) ? document.activeElement.dataset.id : undefined;
  const rooms = new Map();
  for (const x of found.slice(0, CARDS_MOST)) rooms.set(roomOf(x), [...(rooms.get(roomOf(x)) || []), x]);
  cards.replaceChildren(...[...rooms].sort(([a], [b]) => (a < b ? -1 : 1)).flatMap(([room, list]) => [
    make("h2", `${plain(room, 60)} `, make("span.soft.small", String(list.length))),
    make("div.cards", ...list.map(x => make("article.card", { "aria-label": x.prefix }, ...cardParts(x))))]));
  if (focused !== undefined) [...cards.querySelectorAll("[data-id]")].find(x => x.dataset.id === focused)?.focus();
}

/** Where it stands: its island, or what its name begins with. */
const roomOf = ({ prefix, facts }) => facts.island || prefix.split(".")[0];

function cardParts({ owner, prefix, facts, fields, inputs }) {
  const good = facts.status === "active";
  const cause = facts["status.cause"];
  const state = make(good ? "span.good" : "span.bad", `${good ? "●" : "○"} ${facts.status}${!good && cause && cause !== "none" ? ` (${cause})` : ""} `);
  const room = roomOf({ prefix, facts });
  return [make("h3", { title: prefix }, prefix.startsWith(room + ".") ? prefix.slice(room.length + 1) : prefix),
    make("div.small", state, make("span.soft", plain(facts.class, 40))),
    ...[...fields].filter(([, x]) => x.value !== undefined).map(([name, x]) => reading(owner, prefix + "." + name, name, x)),
    ...[...inputs].flatMap(([name, x]) => [make("div.acts", make("span.soft", name), ...inputControls(owner, prefix + "." + name, x)),
      requestState(owner, prefix + "." + name, x)])];
}

/** A reading with its unit and its history; a click lays it into the chart. */
function reading(owner, key, name, x) {
  const spark = make("canvas.spark", { "aria-hidden": "true" });
  spark.hidden = true;
  withCurve({ owner, key }, points => {
    spark.hidden = points.length < 2;
    drawCurve(spark, points, 160, 18, false, max(run.now, 1e-3));
  });
  const value = plain(x.value, 300) + (x.unit ? " " + plain(x.unit, 20) : "");
  return make("button.reading", { title: `${plain(key, 200)}, set at ${timeText(x.value_s)}: click for its curve`, "data-id": "curve " + owner + key,
    onclick: () => chartTuple(owner, key, x.unit) }, make("span.text.soft", name), make("span.text.now", value), spark);
}

/** A switch, words to choose from, a slider, or a text: what fits the input. */
function inputControls(owner, key, x) {
  const send = value => requestInput(owner, key, value);
  if (!mayControl()) return [make("span.now", plain(x.value ?? "–", 60))];
  const common = word => ({ "data-key": key, "data-id": owner + key + " " + word });
  const words = (x.words || "").split(" ").filter(Boolean).slice(0, 40);
  if (words.length === 2 && words.includes("on") && words.includes("off") && !x.range) {
    const isOn = x.value === "on";
    return [make("button.switch", { role: "switch", "aria-checked": isOn, "aria-label": key, ...common(""), onclick: () => send(isOn ? "off" : "on") }, isOn ? "on" : "off")];
  }
  const parts = words.length > 4
    ? [make("select", { "aria-label": key, ...common(""), onchange: event => send(event.target.value) },
      ...(words.includes(x.value) ? [] : [make("option", { value: "", disabled: "" }, "–")]), ...options(words, x.value))]
    : words.map(word => button(word, () => send(word), { "aria-pressed": word === x.value, ...common(word) }));
  const [low, high] = (x.range || "").split(" ").map(Number);
  if (x.range && isNumber(low) && isNumber(high)) parts.push(...slider(key, x, low, high, send, common("range")));
  if (parts.length) return parts;
  const value = make("input", { type: "text", "aria-label": "Value for " + key, value: x.value ?? "" });
  return [value, button("set", () => send(value.value), common("set"))];
}

function slider(key, x, low, high, send, common) {
  const unit = x.unit ? " " + plain(x.unit, 20) : "";
  const now = Number(x.value ?? low);
  const number = make("output", `${isNumber(now) ? now : "–"}${unit}`);
  const step = high - low >= 20 ? 1 : (high - low) / 100;
  return [make("input", { type: "range", min: low, max: high, step, value: isNumber(now) ? now : low, "aria-label": key, ...common,
    oninput: event => { number.textContent = event.target.value + unit; },
    onchange: event => {
      send(event.target.value);
      event.target.blur();
    } }), number, make("span.soft.small", `${low} to ${high}${unit}`)];
}

const requests = new Map(); // by tupleName() of inputs: {value, at_s, refused}
const OUTCOMES_BAD = /failed|unreachable|refused|superseded|timeout/;

/** What has become of the newest request: sent, acknowledged, or refused and why. */
function requestState(owner, key, x) {
  const request = requests.get(tupleName(owner, key));
  const say = (kind, text) => make("div.small.request" + kind, plain(text, 300));
  if (request?.refused) return say(".bad", `✕ ${request.value}: refused: ${request.refused}`);
  if (request && !(x.outcome_s >= request.at_s)) {
    const most = isNumber(Number(x.deadline)) && x.deadline ? `; answered within ${shortNumber(Number(x.deadline))} s` : "";
    return say(".soft", `→ ${request.value}: sent${most}`);
  }
  if (!x.outcome) return say(".soft", "no request yet");
  const bad = OUTCOMES_BAD.test(x.outcome);
  return say(bad ? ".bad" : ".soft", `${bad ? "✕" : /acknowledged/.test(x.outcome) ? "✓" : "→"} ${x.outcome}, ${timeText(x.outcome_s)}`);
}

async function requestInput(owner, key, value) {
  requests.set(tupleName(owner, key), { value, at_s: run.now });
  const answer = await setTuple(owner, key, value);
  if (!answer.good) put("said", plain(`${value}: refused: ${answer.text}`, 200));
  if (!answer.good) requests.set(tupleName(owner, key), { value, at_s: run.now, refused: answer.text });
  refreshTab();
}

// ---- tab: curves

const CHART_HEIGHT = 250;
const CHART_FILE_OCTETS_MAX = 64e6;
const CURVES_MOST = 8;
const CURVE_COLOURS = ["c0", "c1", "c2", "c3", "c4", "c5", "fg", "soft"];
const FILE_DASHES = [[7, 3], [2, 3], [9, 3, 2, 3], [4, 4]];
// Curves of any quantities over one time axis, one scale a unit; from tables of other runs the same quantities.
const chart = { curves: [], from_s: 0, to_s: Infinity, hover_s: null, files: [], down: null };

function startCurves() {
  tabs.curves = { refresh: () => (tuples.list.length && !run.running ? refreshChart() : askTuples()) };
  on($("curve-add"), "input keydown", addTyped);
  on($("curve-file"), "change", async () => {
    for (const file of $("curve-file").files) await layFile(file);
    $("curve-file").value = "";
    showChart();
  });
  for (const [id, act] of Object.entries({ "curve-in": () => zoomChart(0.5), "curve-out": () => zoomChart(2), "curve-all": showAllOfChart, "curve-clear": clearChart }))
    on($(id), "click", act);
  listenToChart($("chart"));
}

function listenToChart(canvas) {
  const timeAt = event => chartTimeAt(event.clientX - canvas.getBoundingClientRect().left);
  on(canvas, "pointerdown", event => {
    chart.down = { x: event.clientX, moved: 0 };
    capture(canvas, event);
  });
  on(canvas, "pointermove", event => {
    if (chart.down) panChart(chartTimeAt(chart.down.x) - chartTimeAt(event.clientX), abs(event.clientX - chart.down.x), event.clientX);
    else chart.hover_s = timeAt(event);
    showChart();
  });
  on(canvas, "pointerup", event => {
    if (chart.down && chart.down.moved < 4) showAt(timeAt(event));
    chart.down = null;
  });
  on(canvas, "pointerleave pointercancel", () => {
    Object.assign(chart, { hover_s: null, down: null });
    showChart();
  });
  on(canvas, "wheel", event => {
    event.preventDefault();
    zoomChart(Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), timeAt(event));
  }, { passive: false });
  on(canvas, "keydown", event => {
    const width = chartSpan()[1] - chartSpan()[0];
    const act = { ArrowLeft: () => panChart(-width / 8), ArrowRight: () => panChart(width / 8), "+": () => zoomChart(0.5), "=": () => zoomChart(0.5),
      "-": () => zoomChart(2), 0: showAllOfChart }[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
    showChart();
  });
}

const chartSpan = () => [max(chart.from_s, 0), min(chart.to_s, runLength())];
const chartRight = () => $("chart").clientWidth - (chart.units?.length > 1 ? 56 : 14);

function chartTimeAt(x) {
  const [from, to] = chartSpan();
  return from + clamp((x - 56) / max(chartRight() - 56, 1), 0, 1) * (to - from);
}

function panChart(by_s, moved_px = 0, x = 0) {
  const [from, to] = chartSpan();
  const by = clamp(by_s, -from, runLength() - to);
  Object.assign(chart, { from_s: from + by, to_s: to + by });
  if (chart.down) Object.assign(chart.down, { x, moved: chart.down.moved + moved_px });
}

/** By a factor of the time that is seen; `at` stays where it is. */
function zoomChart(factor, at = chart.hover_s ?? (chartSpan()[0] + chartSpan()[1]) / 2) {
  const [from, to] = chartSpan();
  const width = clamp((to - from) * factor, min(0.1, runLength()), runLength());
  chart.from_s = clamp(at - ((at - from) * width) / (to - from), 0, runLength() - width);
  chart.to_s = chart.from_s + width;
  showChart();
}

function showAllOfChart() {
  Object.assign(chart, { from_s: 0, to_s: Infinity });
  showChart();
}

function clearChart() {
  Object.assign(chart, { curves: [], files: [] });
  showAllOfChart();
}

const pointsOf = (answer, name) => (answer?.[name] || []).filter(([t, v]) => isNumber(t) && isNumber(v));

/** Of a tuple: `load` asks for its points, `of` finds those of another run. */
function tupleQuantity(owner, key, unit) {
  const known = unit ?? tuples.list.find(x => x[0] === owner && x[1] === key + ".unit")?.[2];
  return { label: key, unit: plain(known || "", 20), load: async () => pointsOf(await ask({ ask: "curve", owner, key }, "curve"), "points"),
    of: file => file.tuples.get(tupleName(owner, key)) };
}

const labelledMote = i => labelled(fullName(i), islandOf(i).labels.get(model.names[i]));

const chargeQuantity = i => ({ label: `charge used by ${labelledMote(i)}`, unit: "mAh", of: file => file.charge.get(fullName(i)),
  load: async () => pointsOf(await ask({ ask: "mote", address: addressOf(i), at_s: run.now }, "mote"), "used") });

const seriesQuantity = (label, unit, values) => ({ label, unit, load: async () => series.times.map((t, i) => [t, values()?.[i] ?? 0]), of: () => undefined });

/** Those that there are, with the typed text in their name. */
function quantities(needle) {
  const number = value => value !== "" && isNumber(Number(value));
  return [...tuples.list.filter(([, key, value]) => number(value) && matches(needle, key)).map(([owner, key]) => tupleQuantity(owner, key)),
    ...Object.keys(series.lost).map(cause => seriesQuantity(`lost ${cause}`, "lost", () => series.lost[cause])),
    seriesQuantity("charge used by all motes", "mAh", () => series.used_mah),
    ...range(model.count).filter(i => matches(needle, "charge used by " + labelledMote(i))).slice(0, 40).map(chargeQuantity)]
    .filter(x => matches(needle, x.label)).slice(0, 40);
}

function addTyped(event) {
  const typed = $("curve-add").value;
  const found = quantities(needleOf("curve-add"));
  $("curve-names").replaceChildren(...found.map(x => make("option", { value: x.label })));
  const exact = found.find(x => x.label === typed) || (event.key === "Enter" && found[0]);
  const picked = event.type === "input" && (event.inputType ?? "insertReplacementText") === "insertReplacementText";
  put("curve-note", typed.trim() && !found.length ? "no quantity of this name" : "");
  if (!exact || !(picked || event.key === "Enter")) return;
  $("curve-add").value = "";
  addCurve(exact);
}

/** Lays a tuple's curve into the chart, and shows it. */
function chartTuple(owner, key, unit) {
  addCurve(tupleQuantity(owner, key, unit));
  showTab("curves");
}

function addCurve(quantity) {
  if (chart.curves.some(x => x.label === quantity.label)) return;
  if (chart.curves.length >= CURVES_MOST) chart.curves.shift();
  const hue = CURVE_COLOURS.find(name => !chart.curves.some(x => x.hue === name));
  chart.curves.push({ ...quantity, hue, points: [], asked_ms: -Infinity });
  refreshChart();
}

const refreshChart = latest(async () => {
  for (const each of chart.curves) {
    const age_ms = performance.now() - each.asked_ms;
    if (age_ms < 4000 || (!run.running && isNumber(each.asked_ms))) continue;
    each.points = await each.load();
    each.asked_ms = performance.now();
  }
  showChart();
});

/** Rows of a table in CSV (RFC 4180). */
function* csvRows(text) {
  let row = [];
  for (const [, cellText, end] of text.matchAll(/("(?:[^"]|"")*"|[^,\r\n]*)(,|\r?\n|$)/g)) {
    row.push(cellText.startsWith('"') ? cellText.slice(1, -1).replaceAll('""', '"') : cellText);
    if (end === ",") continue;
    if (row.length > 1) yield row;
    row = [];
  }
}

/** A table of `--csv` of another run, tuples.csv or energy.csv. It stays in the browser. */
async function layFile(file) {
  const note = text => put("curve-note", plain(`${file.name}: ${text}`, 200));
  if (file.size > CHART_FILE_OCTETS_MAX) return note("longer than 64 MB");
  const laid = { name: `run ${chart.files.length + 2}`, tuples: new Map(), charge: new Map() };
  const add = (map, name, t, value) => {
    if (value === "" || !isNumber(Number(value))) return;
    if (!map.has(name)) map.set(name, []);
    map.get(name).push([Number(t), Number(value)]);
  };
  const rows = csvRows(await file.text());
  const columns = rows.next().value || [];
  const at = Object.fromEntries(columns.map((name, i) => [name, i]));
  if (!("time_s" in at) || !("key" in at || "used_mah" in at)) return note("neither tuples.csv nor energy.csv of --csv");
  for (const row of rows)
    if ("key" in at) add(laid.tuples, tupleName(row[at.owner], row[at.key]), row[at.time_s], row[at.value]);
    else add(laid.charge, `${row[at.island]}/${row[at.mote]}`, row[at.time_s], row[at.used_mah]);
  chart.files.push(laid);
  return note(`laid over as ${laid.name}: the dashed curves`);
}

/** What is drawn: the curves, and after each the same of other runs. */
const chartLines = () => chart.curves.flatMap(curve => [{ curve, points: curve.points, dash: [] },
  ...chart.files.map((file, k) => ({ curve, points: curve.of(file) || [], dash: FILE_DASHES[k % FILE_DASHES.length] }))]);

const indexAt = (points, t) => firstAfter(points, point => point[0], t) - 1;
const valueAt = (points, t) => points[indexAt(points, t)]?.[1];

function showChart() {
  if (shown.tab !== "curves") return;
  const all = chartLines();
  chart.units = [...new Set(chart.curves.map(x => x.unit))];
  const canvas = $("chart");
  drawOn(canvas, canvas.clientWidth, CHART_HEIGHT, () => drawChart(all));
  const t = chart.hover_s ?? shown.at_s;
  put("chart-at", chart.curves.length ? `at ${timeText(t)}` : "Add two or more quantities to compare them, from here, from Tuples or from Proxies.");
  const text = x => (isNumber(x) ? shortNumber(x) : "–");
  const legend = $("chart-legend");
  const focused = [...legend.querySelectorAll("button")].indexOf(document.activeElement);
  legend.replaceChildren(...chart.curves.map(curve => make("div.row", swatch(curve.hue), make("span.text", { title: curve.label }, curve.label),
    make("span.space"), make("span.now", `${text(valueAt(curve.points, t))} ${curve.unit}`),
    ...chart.files.map(file => make("span.soft", `${file.name}: ${text(valueAt(curve.of(file) || [], t))}`)),
    button("×", () => {
      chart.curves = chart.curves.filter(x => x !== curve);
      showChart();
    }, { "aria-label": "Remove " + plain(curve.label, 100) }))));
  const buttons = legend.querySelectorAll("button");
  if (focused >= 0) buttons[min(focused, buttons.length - 1)]?.focus();
}

/** The least and the greatest value of a unit in the time that is seen, with a little room. */
function unitScale(all, unit, [from, to]) {
  let [low, high] = [Infinity, -Infinity];
  for (const { curve, points } of all)
    if (curve.unit === unit)
      for (let i = max(indexAt(points, from), 0); i < points.length && points[i][0] <= to; ++i) {
        low = min(low, points[i][1]);
        high = max(high, points[i][1]);
      }
  if (low > high) return [0, 1];
  const room = (high - low) * 0.05 || abs(high) * 0.05 || 1;
  return [low - room, high + room];
}

function niceStep(width) {
  const decade = 10 ** floor(Math.log10(width));
  return [1, 2, 5, 10].find(n => n * decade >= width) * decade;
}

function drawChart(all) {
  const span = chartSpan();
  const [from, to] = span;
  const [left, right, top, bottom] = [56, chartRight(), 18, CHART_HEIGHT - 22];
  const x = t => left + ((t - from) / max(to - from, 1e-9)) * (right - left);
  fill("panel", box(left, top, right - left, bottom - top));
  const step = timeStep(to - from, right - left);
  for (let t = ceil(from / step) * step; t <= to * 1.0001; t += step) {
    stroke("line", 1, lines([round(x(t)) + 0.5, top], [round(x(t)) + 0.5, bottom]));
    writeWithin(timeText(t, step < 1 ? 2 : 0), x(t), bottom + 12, $("chart").clientWidth);
  }
  for (const [k, unit] of chart.units.entries()) {
    const [low, high] = unitScale(all, unit, span);
    const y = v => bottom - ((v - low) / (high - low)) * (bottom - top);
    if (k < 2) drawChartScale(k, unit, low, high, y, k ? right + 4 : left - 5);
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top - 2, right - left, bottom - top + 4);
    ctx.clip();
    for (const { curve, points, dash } of all) if (curve.unit === unit) drawChartLine(points, curve.hue, dash, span, x, y);
    ctx.restore();
  }
  for (const t of [shown.at_s, chart.hover_s]) if (t !== null && t >= from && t <= to) fill(t === chart.hover_s ? "soft" : "fg", box(x(t), top, 1, bottom - top));
}

function drawChartScale(k, unit, low, high, y, at) {
  const step = niceStep((high - low) / 4);
  write(plain(unit, 12) || "value", at, 8, { align: k ? "left" : "right" });
  for (let v = ceil(low / step) * step; v <= high; v += step) write(shortNumber(Number(v.toPrecision(6))), at, y(v), { align: k ? "left" : "right" });
}

/** In steps; of very many points those that can be told apart. */
function drawChartLine(points, hue, dash, [from, to], x, y) {
  stroke(hue, 1.6, () => {
    for (let i = max(indexAt(points, from), 0), last; i < points.length && (!i || points[i - 1][0] <= to); ++i) {
      const [t, v] = points[i];
      if (last !== undefined) ctx.lineTo(x(t), y(last));
      ctx.lineTo(x(t), y(v));
      last = v;
      if (i === points.length - 1) ctx.lineTo(x(min(run.now, to)), y(v));
    }
  }, dash);
}

// ---- tab: energy

const energyOf = new Map(); // by mote: {energy, sample}

function startEnergy() {
  const list = new List("energy-list", 26, energyRow, index => choose({ kind: "mote", index }), () => ({ class: "energy-row" }));
  tabs.energy = { list, refresh: showEnergy };
}

function showEnergy() {
  if (!shown.motes) return;
  const { hours, used_mah: used } = shown.motes;
  const left = i => hours[i] ?? 1e12;
  const order = range(model.count).sort((a, b) => left(a) - left(b) || (used[b] || 0) - (used[a] || 0));
  put("energy-sum", `${chargeText(usedByAll())} used by ${countText(model.count)} motes at ${timeText(shown.at_s)}; highest consumption first`);
  tabs.energy.list.set(order);
}

const usedByAll = () => (shown.motes?.used_mah || []).reduce((a, b) => a + (b || 0), 0);

function energyRow(i) {
  const why = make("span.text");
  const known = energyOf.get(i);
  if (known) why.append(...energyBar(known.energy));
  const sample = shown.sample_s;
  if (known?.sample !== sample)
    askLazily({ ask: "mote", address: addressOf(i), at_s: shown.at_s }, "mote", answer => {
      if (!answer) return;
      energyOf.set(i, { energy: answer.energy, sample });
      why.replaceChildren(...energyBar(answer.energy));
    });
  return [cell("", fullName(i)), make("span", hoursText(shown.motes.hours[i])), make("span", chargeText(shown.motes.used_mah[i])), why];
}

const energyParts = energy => [...(energy?.radio || []), ["processor", energy?.processor || 0]];

/** What a mote's charge was used for, as a bar. */
function energyBar(energy) {
  const parts = energyParts(energy);
  const sum = parts.reduce((a, [, mah]) => a + mah, 0);
  if (!sum) return [];
  const forwarded = isNumber(energy.forwarded_share) ? `; forwarded for others: ${shareText(energy.forwarded_share)}` : "";
  const title = parts.map(([name, mah]) => `${radioWord(name)} ${shareText(mah / sum)}`).join(", ") + forwarded;
  return [make("span.bar", { title, role: "img", "aria-label": title }, ...parts.map(([name, mah]) => {
    const part = make("i");
    part.style.width = (100 * mah) / sum + "%";
    part.style.background = `var(--${ENERGY_COLOURS[name] || "soft"})`;
    return part;
  }))];
}

// ---- tab: messages

const messages = { list: [], total: 0, why: "", ready: false };
const MESSAGE_SIGNS = { lost: "✕", open: "…", arrived: "✓" };
const NO_RECORD = "This run is not recorded, so the outcomes of messages are unknown. "
  + "Start it with --record FILE to see them here, to explain values, and to see frames in transit.";

function startMessages() {
  const refresh = throttled(1500, () => (grows(messages) || !messages.ready ? askMessages() : null));
  tabs.messages = { list: new List("message-list", 42, messageRow, explainMessage), refresh };
  on($("message-which"), "change", askMessages);
  on($("message-again"), "click", askMessages);
  on($("message-filter"), "input", showMessages);
}

/** Of a run that goes on messages are known as of some time. */
const grows = answer => isNumber(answer.as_of_s);
const asOf = answer => (grows(answer) ? " as of " + timeText(answer.as_of_s) : "");

const askMessages = latest(async () => {
  const lost = $("message-which").value === "lost";
  const answer = hasMessages() ? await ask({ ask: "messages", lost, limit: 1000 }, "messages") : { ready: false, why: NO_RECORD };
  if (!answer) return;
  Object.assign(messages, { as_of_s: null }, answer, { list: answer.messages || [] });
  showMessages();
});

function showMessages() {
  const needle = needleOf("message-filter");
  const found = messages.list.filter(x => matches(needle, x.name, x.from, x.to, x.outcome));
  const count = messages.ready ? `${countText(found.length)} shown of ${countText(messages.total)}${asOf(messages)}. ` : "";
  put("message-count", count + plain(messages.why));
  tabs.messages.list.set(found);
}

function messageRow(x) {
  const kind = x.class === "lost" ? ".bad" : ".soft";
  return [cell(".when", timeText(x.sent_s)), make("span.sign" + kind, { "aria-label": x.class }, MESSAGE_SIGNS[x.class] || "·"),
    make("span.two", cell("", `${plain(x.name, 80)} → ${x.to}`), cell(kind, x.outcome))];
}

const explainMessage = x => explain({ ask: "explain", message: x.name }, x.name);

const explained = { question: null, grows: false };

/** @param anew it is open, and may have gone on */
async function explain(question, title, anew = false) {
  const answer = await ask(question);
  if (!answer || (anew && explained.question !== question)) return;
  Object.assign(explained, { question, grows: run.running || grows(answer) });
  shown.explained = title;
  put("explain-title", plain(title) + asOf(answer));
  put("explain-text", plainLines(answer.text));
  $("explain").hidden = false;
  if (!anew) $("explain").scrollIntoView({ block: "nearest" });
}

function closeExplain() {
  $("explain").hidden = true;
  explained.question = null;
  shown.explained = "";
}

// ---- tab: what is chosen

function setChosen(target) {
  closeExplain();
  shown.chosen = target;
  if (target?.kind === "mote") askNeighbours(target.index);
  redraw("map");
}

/** Chooses, and shows what is known of it. */
function choose(target) {
  setChosen(target);
  $("details").scrollTop = 0;
  if (target) showTab("details");
  else refreshTab();
}

function nameOf({ kind, index }) {
  if (kind === "mote") return fullName(index);
  return kind === "peer" ? model.peers[index].name : model.islands[index].name;
}

const refreshDetails = latest(async () => {
  const target = shown.chosen;
  const describe = { mote: moteParts, peer: peerParts, island: islandParts }[target?.kind];
  const parts = describe ? await describe(target.index) : [make("p.soft", "Click a mote, a sink, a gateway or a peer on the map.")];
  if (!sameTarget(target, shown.chosen)) return;
  const scrolled = $("details").scrollTop;
  $("details").replaceChildren(...parts);
  $("details").scrollTop = scrolled;
  for (const canvas of $("details").querySelectorAll("canvas.curve")) drawCurve(canvas, canvas.points, canvas.clientWidth, 84, true);
});

const factList = facts => make("dl.facts", ...facts.flatMap(([name, value]) => [make("dt", name), make("dd", value)]));
const chip = kind => index => button(plain(nameOf({ kind, index }), 60), () => choose({ kind, index }));
const chips = (kind, indices) => make("div.chips", ...indices.map(chip(kind)));

function faultButton(text, kind, who) {
  const propose = () => {
    proposeFault(kind, who);
    showTab("control");
  };
  return mayControl() ? button(text, propose, { id: "fault-this" }) : null;
}


async function moteParts(i) {
  const address = addressOf(i);
  const [answer, sent] = await Promise.all([ask({ ask: "mote", address, at_s: shown.at_s }, "mote"), messagesOf(address)]);
  return [make("h2", labelledMote(i)), make("p.soft.small", `mote ${address}, ${stateLabel(i)} at ${timeText(shown.at_s)}`),
    faultButton("crash this mote…", "crash mote", fullName(i)), ...proposalParts(i), factList(answer?.facts || []),
    ...energyDetails(answer), ...neighbourDetails(answer?.neighbours || [], islandOf(i)), ...sent].filter(Boolean);
}

function energyDetails(answer) {
  if (!answer) return [];
  const parts = [make("h3", "Energy"), ...energyBar(answer.energy), factList(energyParts(answer.energy).map(([name, mah]) => [radioWord(name), chargeText(mah)]))];
  if (isNumber(answer.energy?.forwarded_share)) parts.push(make("p.small", `${shareText(answer.energy.forwarded_share)} of its transmissions was forwarded for others`));
  if (answer.used?.length > 1) {
    const canvas = make("canvas.curve", { role: "img", "aria-label": "Charge used over time, mAh" });
    canvas.points = answer.used;
    parts.push(make("p.soft.small", "used, mAh"), canvas);
  }
  return parts;
}

function neighbourDetails(list, island) {
  const rows = list.map(([name, etx]) => {
    const place = placeOf(name, island);
    return make("tr", make("td", place ? button(name, () => choose({ kind: place.kind, index: place.index }), { class: "link" }) : name), make("td", etxText(etx)));
  });
  return [make("h3", `Neighbours (${rows.length})`), make("table", make("tr", make("th", "neighbour"), make("th", "ETX")), ...rows)];
}

async function messagesOf(of) {
  const answer = hasMessages() ? await ask({ ask: "messages", of, limit: 40 }, "messages") : { why: NO_RECORD };
  const found = answer?.messages || [];
  return [make("h3", "Messages from and to it, lost ones first"),
    make("p.soft.small", answer?.ready ? `${countText(found.length)} of ${countText(answer.total)}${asOf(answer)}. ${answer.why}` : answer?.why),
    ...found.map(x => make("button.message.row", { onclick: () => explainMessage(x) }, ...messageRow(x)))];
}

async function peerParts(index) {
  const peer = model.peers[index];
  const [answer, sent] = await Promise.all([ask({ ask: "peer", name: peer.name, at_s: shown.at_s }, "peer"), messagesOf(peer.name)]);
  const about = events.filter(x => x.t <= shown.at_s && (x.who === peer.name || x.who.startsWith(peer.name + "/"))).slice(-12).reverse();
  const seeTuples = () => {
    $("tuple-filter").value = peer.name;
    showTab("tuples");
  };
  return [make("h2", labelled(peer.name, peer.label)), make("p.soft.small", `${peer.gateway ? "gateway" : "PEIS peer"} ${peer.id}${peer.host ? " on " + peer.host : ""}`),
    make("div.row", button("its tuples", seeTuples, { id: "peer-tuples" }), faultButton("kill this peer…", "kill peer", peer.name)),
    factList(answer?.facts || []), make("h3", `Configured links (${peer.links.length})`), chips("peer", peer.links),
    make("h3", "Open links, packages waiting"), factList(answer?.links || []),
    ...(peer.islands.length ? [make("h3", "Cable to the sink of"), chips("island", peer.islands)] : []),
    make("h3", `Newest of ${countText(answer?.tuples)} tuples`), factList(answer?.newest || []), make("h3", "Newest events"),
    make("table", ...about.map(x => make("tr", make("td.soft", timeText(x.t)), make("td." + x.kind, x.what)))), about.length ? "" : "none", ...sent];
}

function islandParts(index) {
  const island = model.islands[index];
  const gateways = [...model.peers.keys()].filter(i => island.gateways.includes(model.peers[i].name));
  const motes = range(min(island.count, 200)).map(k => island.first + k);
  return [make("h2", labelled(island.name, island.label)), make("p.soft.small", `island ${island.id}, ${countText(island.count)} motes, at ${timeText(shown.at_s)}`),
    factList(STATES.map(([, text], code) => [text, countText(island.counts[code])])), make("h3", "Gateways"), chips("peer", gateways),
    make("h3", island.count > 200 ? "Motes, the first 200" : "Motes"), make("div.chips", ...motes.map(i => button(plain(model.names[i], 60), () => choose({ kind: "mote", index: i }))))];
}

// ---- tab: control

const FAULTS = { // and changes, that may happen at any moment: whom, and what has to be said
  "crash mote": ["mote", "crash mote WHO for 10s"],
  "crash sink": ["island", "crash sink WHO for 10s"],
  "battery ends": ["mote", "battery_end mote WHO"],
  unplug: ["island", "unplug island WHO for 30s"],
  "kill peer": ["peer", "kill peer WHO for 20s"],
  "power off": ["peer", "power_off peer WHO for 20s"],
  pause: ["peer", "pause peer WHO for 10s"],
  "cut a PEIS link": ["link", "link_loss loss 100% peers WHO for 30s"],
  "PEIS loses packages": [null, "link_loss loss 50% for 30s"],
  "radio loses frames": ["island", "radio_loss loss 50% island WHO for 30s"],
  "a second peer": ["peer", "duplicate_id peer WHO for 30s"],
  "clock is set": ["mote", "clock_step mote WHO by 5s"],
  "another rate": ["mote", "rate mote WHO period 5s"],
  "another radio link": ["mote", "link from WHO to SINK loss 50%"],
  "debug log of": ["mote", "debug of mote/WHO"],
};

function startControl() {
  tabs.control = { refresh: () => {} };
  $("fault-kind").replaceChildren(...options(Object.keys(FAULTS)));
  on($("fault-kind"), "change", () => proposeFault($("fault-kind").value));
  on($("fault-who"), "change", composeFault);
  const doFault = () => post({ ask: "fault", sentence: $("fault-sentence").value.trim() }, $("fault-sentence").value);
  on($("fault-do"), "click", doFault);
  on($("fault-sentence"), "keydown", event => { if (event.key === "Enter") doFault(); });
}

const options = (names, chosen) => names.map(name => make("option", { value: name, selected: name === chosen ? "" : null }, plain(name, 60)));

/** Whom a fault may concern, as they are called in sentences. */
function victims(whom) {
  if (whom === "link") return model.links.map(pair => JSON.stringify(pair.map(i => model.peers[i].name)));
  const count = { mote: model.count, island: model.islands.length, peer: model.peers.length }[whom] || 0;
  return range(min(count, 2000)).map(index => nameOf({ kind: whom, index }));
}

/** Offers whom it may concern: `who`, or who is chosen, or the first. */
function proposeFault(kind, who = shown.chosen && nameOf(shown.chosen)) {
  const names = victims(FAULTS[kind][0]);
  $("fault-kind").value = kind;
  $("fault-who").replaceChildren(...options(names));
  $("fault-who").disabled = !names.length;
  if (names.includes(who)) $("fault-who").value = who;
  composeFault();
}

/** The sentence may be changed by hand before it is sent. */
function composeFault() {
  const who = $("fault-who").value;
  const sink = who.replace(/\/.*/, "/sink");
  $("fault-sentence").value = FAULTS[$("fault-kind").value][1].replace("WHO", () => who).replace("SINK", () => sink);
}

const setTuple = (owner, key, value) => post({ ask: "set", owner, key, value }, `${owner}: ${key} = ${value}`);

/** Sends a request that changes the run, and lists the answer. */
async function post(question, title) {
  const answer = await ask(question);
  const good = answer?.kind === "done" && answer.ok;
  const text = answer ? answer.text || (good ? "done" : "refused") : "the connection is lost";
  $("answers").prepend(make(good ? "li" : "li.bad", make("div.soft", `${timeText(run.now)}  ${plain(title, 300)}`), (good ? "✓ " : "✕ ") + text));
  while ($("answers").children.length > 50) $("answers").lastChild.remove();
  put("said", plain(text, 200));
  refreshTab();
  return { good, text };
}

// ---- search

const FOUND_MOST = 12;

function findTargets(needle) {
  const found = [];
  for (const [kind, list] of [["peer", model.peers], ["island", model.islands], ["mote", model.names]])
    for (let index = 0; index < list.length && found.length < FOUND_MOST; ++index)
      if (matches(needle, nameOf({ kind, index }), kind === "mote" ? addressOf(index) : kind)) found.push({ kind, index });
  return found;
}

/** Proposes what has the typed text in its name; goes to what is chosen of it. */
function searched(event) {
  const found = findTargets(needleOf("search") || "\n");
  $("found").replaceChildren(...found.map(x => make("option", { value: nameOf(x) })));
  const nobody = needleOf("search") && !found.length;
  $("found-none").hidden = !nobody;
  put("found-none", nobody ? "nobody of this name: motes, islands and peers are searched" : "");
  const exact = found.find(x => nameOf(x) === $("search").value) || (event.key === "Enter" && found[0]);
  const picked = event.type === "input" && (event.inputType ?? "insertReplacementText") === "insertReplacementText";
  if (!exact || !(picked || event.key === "Enter")) return;
  $("search").value = "";
  $("search").blur();
  if (exact.kind === "mote") showMote(exact.index);
  else if (exact.kind === "island") showIsland(model.islands[exact.index]);
  choose(exact);
  $("side").scrollIntoView();
}

// ---- keyboard

const KEYS = {
  " ": () => setPlaying(!shown.playing),
  ArrowLeft: event => (event.shiftKey ? stepTime(-1) : eventBefore()),
  ArrowRight: event => (event.shiftKey ? stepTime(1) : nextEvent()),
  ArrowUp: () => changeSpeed(1),
  ArrowDown: () => changeSpeed(-1),
  Home: () => showAt(0),
  End: goLive,
  "+": () => zoom(1.4),
  "=": () => zoom(1.4),
  "-": () => zoom(1 / 1.4),
  0: fitView,
  "?": () => $("help").showModal(),
  "/": () => $("search").focus(),
};
const MAP_KEYS = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };

function onKey(event) {
  if (event.altKey && event.target.id === "map" && MAP_KEYS[event.key]) {
    event.preventDefault();
    return nudge(MAP_KEYS[event.key].map(x => -x));
  }
  if (event.ctrlKey || event.metaKey || event.altKey || $("help").open) return;
  if (event.key === "Escape") return escape(event.target);
  if (event.target.matches("input, select") || (event.key === " " && event.target.matches("button"))) return;
  const shift = event.target.id === "map" && !event.shiftKey ? MAP_KEYS[event.key] : null;
  if (!shift && !KEYS[event.key]) return;
  event.preventDefault();
  if (shift) pan(...shift);
  else KEYS[event.key](event);
}

/** Closes what is open, one thing at a time. */
function escape(target) {
  if (target.matches("input")) {
    if (target.id === "search") target.value = "";
    $("found-none").hidden = true;
    target.blur();
  } else if (!$("explain").hidden) closeExplain();
  else if (shown.tab === "tuples" && tuples.chosen) {
    tuples.chosen = null;
    $("tuple-detail").hidden = true;
    showTuples();
  } else choose(null);
}

// ---- start

function listenToTools() {
  const clicks = {
    "zoom-in": KEYS["+"], "zoom-out": KEYS["-"], "zoom-fit": fitView, theme: () => setTheme(isDark() ? "light" : "dark"), "help-open": KEYS["?"],
    "help-close": () => $("help").close(), "hint-close": closeHint, "explain-close": closeExplain, "to-start": KEYS.Home, "event-back": eventBefore,
    "event-next": nextEvent, play: KEYS[" "], live: goLive,
    "band-toggle": () => {
      $("band-toggle").setAttribute("aria-pressed", $("band-toggle").getAttribute("aria-pressed") !== "true");
      resizeMap();
    },
  };
  for (const [id, clicked] of Object.entries(clicks)) on($(id), "click", clicked);
  on($("link-by"), "change", () => redraw("scene"));
  $("speed").replaceChildren(...SPEEDS.map(x => make("option", { value: x }, x + "x")));
  on($("speed"), "change", () => setSpeed(Number($("speed").value)));
  on($("at"), "change", () => {
    const t = $("at").value.split(":").reduce((sum, x) => sum * 60 + Number(x), 0); // "90", "1:30", "1:02:03.5"
    if (isNumber(t)) showAt(t);
    $("at").blur();
  });
  on($("search"), "input keydown", searched);
  on(document, "keydown", onKey);
}

/** Shown until it is closed once, in this browser; where it keeps nothing, each time. */
function showHint() {
  let known = false;
  try { known = localStorage.getItem("rubicon-hint") === "known"; } catch { /* it keeps nothing */ }
  $("hint").hidden = known;
}

function closeHint() {
  $("hint").hidden = true;
  try { localStorage.setItem("rubicon-hint", "known"); } catch { /* likewise */ }
}

/** For tests of this page: what it shows, to read only. */
window.rubicon = Object.freeze({
  shown: () => ({
    ...shown, counts: Object.fromEntries(STATES.map(([name], code) => [name, shown.counts[code]])), motes: model.count,
    islands: model.islands.length, folded: model.islands.filter(x => x.folded).length, peers: model.peers.length,
    selected: shown.chosen && { kind: shown.chosen.kind, name: nameOf(shown.chosen) }, events: events.length,
    tuples: tuples.list.length, used_mah: usedByAll(), connected: connection.open, running: run.running, now_s: run.now,
    run_events: run.events, control: mayControl(), messages: hasMessages(), zoom: view.scale / view.fitScale, dark: isDark(),
    frames: frames.list.length, fps: frameTimes.length, scene_ms: scene.cost_ms,
  }),
  /** Where a mote or a sink is in the window, in CSS pixels; null if there is none of this name. */
  place: name => {
    const found = placeOf(name);
    const map = $("map").getBoundingClientRect();
    return found && { x: map.left + found.x, y: map.top + found.y };
  },
});

function start() {
  for (const each of [startEvents, startTuples, startProxies, startCurves, startEnergy, startMessages, startControl]) each();
  tabs.details = { refresh: refreshDetails };
  for (const each of [listenToMap, listenToTimeLine, listenToTabs, listenToTools]) each();
  for (const each of document.querySelectorAll("[title]:not([aria-label])")) each.setAttribute("aria-label", each.title);
  if (innerWidth < 560) $("band-toggle").setAttribute("aria-pressed", "false");
  setSpeed(1);
  setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  showTab("events");
  showHint();
  new ResizeObserver(resizeMap).observe($("map-area"));
  new ResizeObserver(() => redraw("time")).observe($("time-line"));
  new ResizeObserver(showChart).observe($("chart"));
  setInterval(() => {
    showStatus();
    if (shown.tab === "messages") refreshTab(); // more of the record may be read by now
    if (explained.question && explained.grows) explain(explained.question, shown.explained, true);
  }, 1500);
  connect();
}

start();
