// Values, facts, state and events in words.
const $ = (id) => document.getElementById(id);
const fixed = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}` : "–");

export function showState(told) {
  const stop = told.emergency_stop ? "emergency stop pressed" : "";
  $("state").textContent = told.state + (stop ? `, ${stop}` : "");
  $("state").className = `pill ${told.state.split(" ")[0]}`;
  $("state-text").textContent = told.state_text;
  const isFault = told.fault_number > 0;
  $("fault").hidden = !isFault;
  $("fault-name").textContent = isFault ? `Fault: ${told.fault.name}.` : "";
  $("fault-what").textContent = isFault ? told.fault.what : "";
  $("fault-todo").textContent = isFault ? told.fault.todo : "";
  if (!isFault) $("fault-before").replaceChildren();
}

// onChoose: gets the seconds that a finding begins with.
export function showFinding(told, onChoose) {
  $("fault-before").replaceChildren(...(told?.notes || []).map((note) => {
    const item = document.createElement("li"), button = document.createElement("button");
    button.textContent = note;
    button.onclick = () => onChoose(parseFloat(note));
    item.append(button);
    return item;
  }));
}

function phase(store, tick, side) {
  const v = (name) => store.value(name, tick);
  const stands = v("stance") === (side === "left" ? 0 : 1), both = v("double_support") === 1;
  if (both) return stands ? "landed, both down" : v(`spring_force_${side}`) > 0 ? "push-off" : "both down";
  return stands ? "stance" : "swing";
}

function latch(store, tick, side) {
  const closed = store.value(`latch_closed_${side}`, tick), armed = store.value(`latch_armed_${side}`, tick) === 1;
  const words = closed === 1 ? "closed" : closed === 0 ? "open" : "unknown";
  return armed ? `${words}, armed` : words;
}

const VALUES = [
  ["phase", phase], ["latch", latch],
  ["leg", (s, t, side) => fixed((s.value(`leg_angle_${side}`, t) * 180) / Math.PI, 1, "°")],
  ["precompression", (s, t, side) => fixed(1000 * s.value(`motor_${side}`, t), 1, "mm")],
  ["commanded", (s, t, side) => fixed(1000 * s.value(`target_${side}`, t), 1, "mm")],
  ["ankle", (s, t, side) => fixed(1000 * s.value(`ankle_${side}`, t), 1, "mm")],
  ["spring force", (s, t, side) => fixed(s.value(`spring_force_${side}`, t), 2, "N")],
  ["drive", (s, t, side) => `${fixed(s.value(`temperature_${side}`, t), 0, "°C")}, ${fixed(s.value(`supply_${side}`, t), 1, "V")}`],
];

let valuesAt = 0;
export function showValues(store, tick) {
  const now = performance.now();
  if (now - valuesAt < 100) return; // nobody reads faster
  valuesAt = now;
  const body = $("values-legs");
  if (body.children.length !== VALUES.length) {
    body.replaceChildren(...VALUES.map(([name]) => {
      const row = document.createElement("tr");
      row.append(...["th", "td", "td"].map((tag) => document.createElement(tag)));
      row.children[0].textContent = name;
      row.children[0].scope = "row";
      return row;
    }));
  }
  VALUES.forEach(([, text], i) => ["left", "right"].forEach((side, k) => {
    const words = text(store, tick, side), cell = body.children[i].children[k + 1];
    if (cell.textContent !== words) cell.textContent = words;
  }));
}

let missed = 0, factsTick = 0;
function missedTicks(store, tick, tickS) {
  if (tick < factsTick) { factsTick = tick; missed = 0; }
  for (let t = Math.max(factsTick, store.first); t < tick; t++) {
    const period = store.value("period", t);
    if (period > 1500 * tickS) missed += Math.round(period / 1000 / tickS) - 1;
  }
  factsTick = tick;
  return missed;
}

let factsAt = 0;
export function showFacts(store, tick, subject, steps) {
  const lost = missedTicks(store, tick, subject.tick_s);
  const now = performance.now();
  if (now - factsAt < 200) return;
  factsAt = now;
  let last = null;
  for (let i = steps.length - 1; i >= 0 && !last; i--) if (steps[i].tick <= tick) last = steps[i];
  const length = subject.parameters.leg_length_m, mass = subject.parameters.torso_mass_kg + 2 * subject.parameters.leg_mass_kg;
  let load = 0;
  for (let t = tick - 100; t < tick; t++) load += store.value("bus_load", t) / 100 || 0;
  const facts = [
    ["step", last ? `${last.number} (${last.side ? "right" : "left"})` : "–"],
    ["apex speed", last ? `${fixed(last.speed_rad_s, 3, "rad/s")} (${fixed(last.speed_rad_s * length, 2, "m/s at the hip")})` : "–"],
    ["asked for", last ? fixed(last.command_rad_s, 3, "rad/s") : "–"],
    ["r0 wanted", last ? fixed(1000 * last.r0_m, 1, "mm") : "–"],
    ["walking speed", last?.speed_m_s ? fixed(last.speed_m_s, 2, "m/s") : "–"],
    ["cadence", last?.cadence ? fixed(last.cadence, 0, "steps/min") : "–"],
    ["push energy", last?.push_J != null ? `${last.push_J.toPrecision(3)} J a step, ${fixed(last.push_J / mass, 3, "J/kg")}` : "–"],
    ["bus load", fixed(load, 0, "%")],
    ["missed ticks", String(lost)],
  ];
  $("facts").replaceChildren(...facts.flatMap(([name, text]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name;
    dd.textContent = text;
    return [dt, dd];
  }));
}

const SIDE = ["left", "right"];
const TEXT = {
  state: (e) => (e.fault_number ? `${e.state}: ${e.fault.name}. ${e.fault.what} ${e.fault.todo}` : e.state),
  emergency: (e) => e.text,
  boot: (e) => e.text,
  mark: (e) => `mark ${e.number}${e.text ? `: ${e.text}` : ""}`,
  settled: (e) => e.text,
  unsettled: (e) => e.text,
  write: (e) => `${e.name} = ${typeof e.value === "number" ? Number(e.value.toPrecision(6)) : e.value}, client ${e.client}${e.done ? "" : ": refused"}`,
  finding: (e) => `before the fault "${e.fault}": ${e.notes.length ? e.notes.join("; ") : "nothing unusual was seen"}`,
};

export class EventList {
  constructor(list, onChoose) {
    this.list = list;
    this.onChoose = onChoose;
  }

  clear() { this.list.replaceChildren(); }

  add(event, tickS) {
    const text = TEXT[event.kind]?.(event, SIDE);
    if (!text) return;
    const item = document.createElement("li"), button = document.createElement("button"), time = document.createElement("small");
    time.textContent = `${(event.tick * tickS).toFixed(2)} s `;
    button.append(time, text);
    button.dataset.kind = event.kind;
    button.className = event.fault_number || (event.kind === "emergency" && !event.over) || ["finding", "unsettled"].includes(event.kind) ? "bad" : "";
    button.onclick = () => this.onChoose(event.tick);
    item.append(button);
    this.list.prepend(item);
    while (this.list.children.length > 500) this.list.lastChild.remove();
  }
}
