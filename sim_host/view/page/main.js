// The page: what comes in, where in time it stands, what is drawn.
import { Charts, StepCharts } from "./charts.js";
import { Figure } from "./figure.js";
import { Keep } from "./keep.js";
import { Link } from "./link.js";
import { Setup } from "./setup.js";
import { Store } from "./store.js";
import { Tune } from "./tune.js";
import { EventList, showFacts, showFinding, showState, showValues } from "./words.js";

const $ = (id) => document.getElementById(id);
const DRAW_MS = 30, AHEAD = 1500, BACK_S = 12;

const page = {
  hello: null, store: null, paused: false, head: 0, windowS: 10, zoom: null, rate: 1, playedAt: 0, asked: -1, dirty: true,
  draw: { drawn: 0, within: 0, worst: 0, lags: [] }, pending: [], lastDraw: 0,
  skipped: 0, hellos: 0, // messages that were left out for this browser; how often it began
};
const figure = new Figure($("figure"));
const steps = new StepCharts($("chart-speed"), $("chart-r0"), (step) => goTo(step.tick));
const list = new EventList($("event-list"), (tick) => goTo(tick));
let charts;
const tune = new Tune((what) => link.ask(what));
const keep = new Keep((what) => link.ask(what), (...a) => link.fetch(...a));
const setup = new Setup((what) => link.ask(what), (path) => keep.open(path));

// ---- what comes in -------------------------------------------------------------------

function hello(message) {
  page.hello = message;
  page.hellos++;
  const isFirst = !page.store;
  if (isFirst) {
    page.store = new Store(message.signals);
    charts = new Charts($("charts"), $("choices"), zoomTo, message.subject.is_person);
    charts.offer(message.signals);
  }
  $("link").textContent = message.over && message.mode === "live" ? "the walk is over" : "connected";
  $("link").className = "good";
  $("source").textContent = message.source;
  $("rate-label").hidden = message.mode !== "replay";
  document.title = `afo view: ${message.source}`;
  tune.hello(message);
  keep.hello(message);
  setup.hello(message);
  trouble(message.trouble);
  begin(message.walk);
  for (const event of message.events) take(event, true);
  showState(message);
  page.total = message.tick;
  if (message.mode === "replay") {
    page.paused = true;
    goTo(Math.min(page.total - 1, Math.round(2 / tickS())));
  } else {
    page.paused = false;
    link.ask({ do: "range", first: Math.max(0, message.tick - 30000), last: message.tick });
  }
  pressed();
}

function begin(walk) {
  page.store.clear(walk);
  page.asked = -1;
  figure.clear();
  steps.clear();
  list.clear();
  page.states = [];
  page.findings = [];
  page.zoom = null;
}

function take(event, isOld) {
  if (event.kind === "step") steps.add(event);
  if (event.kind === "push" || event.kind === "strike") figure.event(event, page.store);
  if (event.kind === "state") {
    page.states.push(event);
    if (!isOld && page.hello.mode === "live") showState(event);
  }
  if (event.kind === "finding") {
    page.findings.push(event);
    if (page.hello.mode === "live") showFinding(event, lookAt);
  }
  list.add(event, tickS());
  tune.event(event, tickS(), isOld);
  keep.event(event);
}

function message(told) {
  if (told.type === "hello") hello(told);
  else if (told.type === "event") { if (told.walk === page.store.walk) take(told, false); }
  else if (told.type === "begin") { begin(told.walk); page.paused = false; pressed(); }
  else if (told.type === "trouble") trouble(told.text);
  else if (told.type === "over") $("link").textContent = "the walk is over";
  else if (told.type === "skipped") page.skipped += told.messages, trouble("This browser was too slow: some ticks are missing here. The record is whole.");
  else { tune.message(told); keep.message(told); setup.message(told); }
}

function rows(buffer) {
  const taken = page.store.take(buffer);
  if (!taken) return;
  if (page.hello.mode === "live" && taken.first + taken.rows >= page.store.next) {
    if (Date.now() - taken.stamp < 60000) page.pending.push({ rows: taken.rows, stamp: taken.stamp });
    page.total = page.store.next;
  }
  page.dirty = true;
}

function trouble(text) {
  $("trouble").hidden = !text;
  $("trouble").textContent = text || "";
}

const link = new Link({ message, rows, lost() {
  $("link").textContent = "no connection: what is seen is old. The walk goes on without this page.";
  $("link").className = "bad";
} });

// ---- time -------------------------------------------------------------------------------

const tickS = () => page.hello?.subject.tick_s ?? 0.001;

function goTo(tick) {
  page.paused = true;
  page.head = Math.max(0, Math.min(page.total - 1, Math.round(tick)));
  if (page.zoom) page.zoom = null;
  need();
  pressed();
  page.dirty = true;
}

const lookAt = (seconds) => goTo(seconds / tickS());

// Replay: asks for the ticks around the head that are not here.
function need() {
  if (page.hello.mode !== "replay") return;
  const store = page.store, back = Math.round((Math.max(BACK_S, page.windowS + 1)) / tickS());
  const from = Math.max(0, page.head - back), to = Math.min(page.total, page.head + AHEAD + Math.round(page.windowS / 2 / tickS()));
  if (store.next < 0 || page.head < store.first || from < store.first && store.first > 0 || page.head > store.next + 100) {
    if (page.asked === from) return;
    store.clear(store.walk);
    page.asked = from;
    link.ask({ do: "range", first: from, last: to });
  } else if (to > store.next && page.askedTo !== to && store.next < page.total) {
    page.askedTo = to;
    link.ask({ do: "range", first: store.next, last: Math.min(page.total, to + 1000) });
  }
}

function zoomTo(fromS, toS) {
  page.zoom = [Math.round(fromS / tickS()), Math.round(toS / tickS())];
  page.paused = true;
  page.head = Math.min(page.zoom[1], page.total - 1);
  pressed();
  page.dirty = true;
}

function pause() {
  page.paused = !page.paused;
  if (!page.paused) {
    page.zoom = null;
    page.playedAt = performance.now();
    if (page.hello.mode === "replay" && page.head >= page.total - 2) goTo(0), page.paused = false;
  } else page.head = Math.max(0, page.hello.mode === "live" ? page.store.next - 1 : page.head);
  pressed();
  page.dirty = true;
}

function pressed() {
  $("pause").setAttribute("aria-pressed", String(page.paused));
  $("pause").textContent = page.paused ? "Go on" : "Pause";
}

function advance(now) {
  if (page.hello.mode === "live") {
    if (!page.paused) page.head = page.store.next - 1;
  } else if (!page.paused) {
    page.head = Math.min(page.total - 1, page.head + ((now - page.playedAt) * page.rate) / 1000 / tickS());
    page.playedAt = now;
    if (page.head >= page.total - 1) { page.paused = true; pressed(); }
    page.dirty = true;
    need();
  }
}

// ---- drawing --------------------------------------------------------------------------------

function frame(now) {
  requestAnimationFrame(frame);
  if (!page.store || page.store.next < 0) return;
  if (now - page.lastDraw < DRAW_MS) return;
  advance(now);
  if (!page.dirty) return;
  page.dirty = false;
  page.lastDraw = now;
  const head = Math.floor(page.head), span = Math.round(page.windowS / tickS());
  const [from, to] = page.zoom || window_(head, span);
  charts.draw(page.store, from, to, tickS());
  figure.draw(page.store, head, page.hello.subject.parameters.leg_length_m);
  if (page.hello.mode === "replay") stateAt(head);
  showValues(page.store, head);
  showFacts(page.store, head, page.hello.subject, steps.steps);
  if (steps.dirty && now - (page.stepsAt || 0) > 250) { page.stepsAt = now; steps.draw(); }
  slider(head);
  count();
}

// In a replay the state is that of the time which is seen.
function stateAt(tick) {
  let state = null;
  for (const one of page.states) if (one.tick <= tick) state = one;
  if (!state || state === page.shown) return;
  showState(page.shown = state);
  if (state.fault_number) showFinding(page.findings.filter((one) => one.tick <= tick).pop(), lookAt);
}

// Live the newest tick is at the right edge; in a replay what follows is seen, too.
function window_(head, span) {
  const ahead = page.hello.mode === "replay" ? Math.round(span / 4) : 0;
  const to = Math.max(head + 1 + ahead, Math.min(span, 2000));
  return [Math.max(0, to - span), to];
}

function slider(head) {
  const bar = $("slider"), live = page.hello.mode === "live";
  bar.min = live ? Math.max(0, page.total - 30000) : 0;
  bar.max = Math.max(page.total - 1, 1);
  if (document.activeElement !== bar || !page.paused) bar.value = head;
  const text = `${(head * tickS()).toFixed(2)} s of ${(page.total * tickS()).toFixed(1)} s`;
  $("clock").textContent = text;
  bar.setAttribute("aria-valuetext", text);
}

// How late each tick was on the screen, by the wall clock of this machine.
function count() {
  if (page.paused && page.hello.mode === "live") { page.pending = []; return; }
  const now = Date.now();
  for (const { rows: n, stamp } of page.pending) {
    const lag = now - stamp;
    page.draw.drawn += n;
    if (lag <= 100) page.draw.within += n;
    page.draw.worst = Math.max(page.draw.worst, lag);
  }
  page.pending = [];
}

// ---- keys and buttons -------------------------------------------------------------------------

function shift(seconds) { goTo(Math.floor(page.paused ? page.head : page.store.next - 1) + seconds / tickS()); }

function setWindow(seconds) {
  page.windowS = seconds;
  page.zoom = null;
  page.dirty = true;
  $("window").value = String(seconds);
  if (page.hello) need();
}

const WINDOWS = [1, 3, 10, 30];
const KEYS = {
  " ": pause, m: mark, r: () => keep.toggle(), z: () => tune.undo(), s: () => tune.request("stop"),
  ArrowLeft: (e) => shift(e.shiftKey ? -1 : -0.1), ArrowRight: (e) => shift(e.shiftKey ? 1 : 0.1),
  "+": () => setWindow(WINDOWS[Math.max(0, WINDOWS.indexOf(page.windowS) - 1)]),
  "-": () => setWindow(WINDOWS[Math.min(3, WINDOWS.indexOf(page.windowS) + 1)]),
  Home: () => goTo(page.hello.mode === "live" ? page.store.first : 0),
  End: () => { goTo(page.total - 1); if (page.hello.mode === "live") pause(); },
  Escape: () => { page.zoom = null; page.dirty = true; },
};

document.addEventListener("keydown", (event) => {
  const typing = event.target.matches("input:not([type=range]):not([type=checkbox]), select, textarea");
  const own = event.target.matches("input[type=range]") && event.key.match(/^(Arrow|Home|End|Page)/);
  const presses = event.target.matches("button, summary, a, input[type=checkbox]") && event.key === " ";
  if (!page.hello || document.querySelector("dialog[open]") || typing || own || presses || event.ctrlKey || event.altKey || event.metaKey) return;
  const deed = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (deed) { event.preventDefault(); deed(event); }
});

function mark() {
  link.ask({ do: "mark", text: $("mark-text").value });
  $("mark-text").value = "";
}

$("pause").onclick = pause;
$("mark").onclick = mark;
$("mark-text").onkeydown = (event) => { if (event.key === "Enter") mark(); };
$("slider").oninput = () => goTo(Number($("slider").value));
$("window").onchange = () => setWindow(Number($("window").value));
$("rate").onchange = () => { page.rate = Number($("rate").value); };
$("unzoom").onclick = () => KEYS.Escape();

window.afo = page; // for those who look from the console, and for the tests
requestAnimationFrame(frame);
