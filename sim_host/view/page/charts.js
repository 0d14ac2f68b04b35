// Signals by tick, a chart for each group, and the steps.
/* global uPlot */
const GROUPS = { legs: "Legs", springs: "Springs and motors", force: "Force", speed: "Apex speed", latch: "Latch, feet, drive",
  state: "State", bus: "Bus", drive: "Drives", person: "Person", figure: "Way" };
const CHOSEN = ["leg_angle_left", "leg_angle_right", "leg_rate_left", "leg_rate_right", "ankle_left", "ankle_right",
  "motor_left", "motor_right", "target_left", "target_right", "r0_wanted", "spring_force_left", "spring_force_right",
  "speed_measured", "speed_commanded", "latch_closed_left", "latch_closed_right", "latch_armed_left", "latch_armed_right",
  "double_support"];
const PERSON = ["moment_left", "moment_right", "power_left", "power_right"];
const HEIGHT = 150;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function colour(name, seen) {
  const side = name.endsWith("_left") ? "left" : name.endsWith("_right") ? "right" : "shared";
  seen[side] = (seen[side] || 0) + 1;
  return { stroke: css(`--${side}${seen[side] % 2 ? "" : "2"}`), dash: seen[side] > 2 ? [6, 3] : undefined };
}

const show = (unit) => (_, v) => (v === null || v === undefined ? "–" : `${Number(v.toPrecision(5))} ${unit}`);

// Flags and states lie between 0 and a few: their axis begins at 0 and has room above.
const flags = (_, low, high) => [Math.min(0, low ?? 0) - 0.1, Math.max(1, high ?? 1) + 0.1];

// Not narrower than two percent of the values: what is steady is drawn as steady.
const wide = (_, low, high) => {
  if (low === null || low === undefined) return [0, 1];
  const middle = (low + high) / 2, half = Math.max(0.55 * (high - low), 0.01 * Math.max(Math.abs(low), Math.abs(high)), 1e-6);
  return [middle - half, middle + half];
};
const brief = (_, splits) => splits.map((v) => String(Number(v.toPrecision(5))));

export class Charts {
  constructor(box, choices, onZoom, isPerson) {
    Object.assign(this, { box, choices, onZoom, plots: [], chosen: new Set(CHOSEN) });
    if (isPerson) for (const name of PERSON) this.chosen.add(name);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    new ResizeObserver(() => this.resize()).observe(box);
  }

  offer(signals) {
    this.signals = signals;
    this.choices.replaceChildren(...signals.map((signal) => {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.name = signal.name;
      box.checked = this.chosen.has(signal.name);
      box.onchange = () => { this.chosen[box.checked ? "add" : "delete"](signal.name); this.build(); };
      label.append(box, `${signal.name}${signal.unit ? `, ${signal.unit}` : ""}`);
      label.title = signal.help;
      return label;
    }));
    this.build();
  }

  build() {
    if (!this.signals) return;
    for (const plot of this.plots) plot.chart.destroy();
    this.box.replaceChildren();
    this.plots = Object.keys(GROUPS).flatMap((group) => {
      const signals = this.signals.filter((one) => one.group === group && this.chosen.has(one.name));
      return signals.length ? [this.plot(group, signals)] : [];
    });
  }

  plot(group, signals) {
    const seen = {};
    const units = [...new Set(signals.map((one) => one.unit))];
    const axis = { stroke: css("--text"), grid: { stroke: css("--grid") }, ticks: { stroke: css("--grid") }, font: "11px system-ui" };
    const chart = new uPlot({
      title: GROUPS[group], width: Math.max(this.box.clientWidth, 200), height: HEIGHT,
      cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
      scales: { x: { time: false }, ...Object.fromEntries(units.map((unit) => [unit || "1", { range: unit ? wide : flags }])) },
      axes: [{ ...axis, size: 26, values: (_, splits) => splits.map((v) => `${Number(v.toFixed(3))} s`) },
        ...units.slice(0, 2).map((unit, i) => ({ ...axis, values: brief, scale: unit || "1", side: i ? 1 : 3, size: 62, label: unit,
          labelSize: 16, labelFont: "11px system-ui", grid: { show: i === 0, stroke: css("--grid") } }))],
      series: [{ label: "time", value: (_, v) => (v === null ? "–" : `${v.toFixed(3)} s`) }, ...signals.map((signal) => ({
        label: signal.name, scale: signal.unit || "1", width: 1.25, points: { show: false }, value: show(signal.unit),
        ...colour(signal.name, seen) }))],
      hooks: { setSelect: [(plot) => {
        if (plot.select.width < 8) return;
        this.onZoom(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
        plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      }] },
    }, [[0], ...signals.map(() => [null])], this.box);
    return { chart, names: signals.map((one) => one.name) };
  }

  resize() {
    const width = Math.max(this.box.clientWidth, 200);
    for (const { chart } of this.plots) if (chart.width !== width) chart.setSize({ width, height: HEIGHT });
  }

  draw(store, from, to, tickS) {
    for (const { chart, names } of this.plots) {
      const data = store.window(names, from, to, Math.max(chart.width / 1.5, 100), tickS);
      chart.batch(() => {
        chart.setData(data, false);
        chart.setScale("x", { min: from * tickS, max: to * tickS });
      });
    }
  }
}

export class StepCharts {
  constructor(speedBox, r0Box, onStep) {
    Object.assign(this, { speedBox, r0Box, onStep, steps: [] });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    new ResizeObserver(() => {
      for (const chart of [this.speed, this.r0]) {
        const width = Math.max(chart.root.parentElement.clientWidth, 160);
        if (chart.width !== width) chart.setSize({ width, height: 170 });
      }
    }).observe(speedBox);
    this.build();
  }

  build() {
    this.speed?.destroy();
    this.r0?.destroy();
    const axis = { stroke: css("--text"), grid: { stroke: css("--grid") }, ticks: { stroke: css("--grid") }, font: "11px system-ui" };
    const one = (box, title, unit, labels) => new uPlot({
      title, width: Math.max(box.clientWidth, 160), height: 170, scales: { x: { time: false } }, cursor: { sync: { key: "steps" } },
      axes: [{ ...axis, size: 26 }, { ...axis, label: unit, size: 58, labelSize: 16, labelFont: "11px system-ui" }],
      series: [{ label: "step" }, ...labels.map(([label, name, dash]) => ({ label, stroke: css(name), width: 1.5, dash,
        points: { show: true, size: 4 }, value: show(unit) }))] }, [[], ...labels.map(() => [])], box);
    this.speed = one(this.speedBox, "Apex speed by step", "rad/s", [["measured", "--left"], ["asked for", "--right", [5, 3]]]);
    this.r0 = one(this.r0Box, "Precompression by step", "m", [["r0 wanted", "--left"], ["given at the push", "--right"]]);
    for (const chart of [this.speed, this.r0]) {
      chart.over.addEventListener("click", () => {
        const step = this.steps[chart.cursor.idx];
        if (step) this.onStep(step);
      });
    }
    this.draw();
  }

  add(step) {
    this.steps.push(step);
    if (this.steps.length > 5000) this.steps.shift();
    this.dirty = true;
  }

  clear() { this.steps = []; this.dirty = true; }

  draw() {
    const x = this.steps.map((step) => step.number);
    this.speed.setData([x, this.steps.map((s) => s.speed_rad_s), this.steps.map((s) => s.command_rad_s)]);
    this.r0.setData([x, this.steps.map((s) => s.r0_m), this.steps.map((s) => s.push_m)]);
    this.dirty = false;
  }
}
