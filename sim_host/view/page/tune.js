// Settings: each a write over SDO by the server, read back, dated, undone with one key.
const $ = (id) => document.getElementById(id);
const number = (value) => (typeof value === "number" ? String(Number(value.toPrecision(7))) : "");

export class Tune {
  constructor(ask) {
    this.ask = ask;
    for (const name of ["walk", "stop", "reset", "zero", "restart"]) $(`do-${name}`).onclick = () => this.request(name);
    $("undo").onclick = () => this.undo();
    $("find-setting").oninput = () => this.filter();
    $("speed").oninput = () => { $("speed-value").textContent = `${Number($("speed").value).toFixed(3)} rad/s`; };
    $("speed").onchange = () => this.write("commands.desired_apex_speed", Number($("speed").value));
  }

  hello(told) {
    this.may = told.control;
    this.tickS = told.subject.tick_s;
    $("control").hidden = !told.control;
    $("read-only").hidden = told.control;
    $("do-restart").hidden = !told.can_restart;
    $("changes").replaceChildren();
    if (told.control) this.offer(told.settings || [], told);
  }

  offer(settings, told) {
    this.settings = new Map(settings.map((one) => [one.name, one]));
    const speed = $("speed");
    speed.step = 0.005;
    speed.min = Math.ceil((told.subject.lowest_speed_rad_s ?? 0) / 0.005) * 0.005;
    speed.max = told.subject.highest_speed_rad_s ?? 2;
    $("settings").replaceChildren(...settings.map((one) => this.setting(one)));
    this.show();
  }

  setting(one) {
    const box = document.createElement("div"), label = document.createElement("label"), row = document.createElement("div");
    const input = document.createElement("input"), button = document.createElement("button"), help = document.createElement("small");
    box.className = "setting";
    label.textContent = `${one.name.split(".").pop()}${one.unit ? `, ${one.unit}` : ""}`;
    label.htmlFor = input.id = `set-${one.name}`;
    input.type = "number";
    input.step = "any";
    if (one.low !== undefined) { input.min = one.low; input.max = one.high; }
    input.disabled = button.disabled = one.access !== "rw";
    button.textContent = "Write";
    button.setAttribute("aria-label", `Write ${one.name}`);
    const write = () => this.write(one.name, Number(input.value));
    button.onclick = write;
    input.onkeydown = (event) => { if (event.key === "Enter") write(); };
    help.textContent = `${one.meaning}${one.low !== undefined ? `; ${number(one.low)} to ${number(one.high)}` : ""}`;
    help.id = `help-${one.name}`;
    input.setAttribute("aria-describedby", help.id);
    row.className = "row";
    row.append(input, button);
    box.append(label, row, help);
    one.help = help;
    one.box = box;
    one.input = input;
    return box;
  }

  show() {
    for (const one of this.settings.values()) if (document.activeElement !== one.input) one.input.value = number(one.value);
    const speed = this.settings.get("commands.desired_apex_speed");
    $("speed").disabled = typeof speed?.value !== "number"; // what is not known yet is not moved
    if (speed && typeof speed.value === "number" && document.activeElement !== $("speed")) $("speed").value = speed.value;
    $("speed-value").textContent = speed ? `${number(speed.value)} rad/s` : "";
  }

  filter() {
    const words = $("find-setting").value.toLowerCase().split(/\s+/);
    for (const one of this.settings.values()) {
      const text = `${one.name} ${one.meaning} ${one.words || ""}`.toLowerCase();
      one.box.hidden = !words.every((word) => text.includes(word));
    }
  }

  write(name, value) {
    if (!Number.isFinite(value)) return this.say("This is no number.", true);
    this.ask({ do: "write", name, value });
    this.say(`${name}: asked for ${number(value)} …`);
  }

  undo() { if (this.may) this.ask({ do: "undo" }); }

  request(what) {
    if (!this.may) return;
    $("request-outcome").textContent = `${what} …`;
    this.ask({ do: "request", what });
  }

  say(text, isBad) {
    $("write-outcome").textContent = text;
    $("write-outcome").className = isBad ? "danger" : "";
  }

  event(event, tickS, isOld) {
    if (event.kind === "settled" || event.kind === "unsettled") $("speed-verdict").textContent = event.text;
    if (event.kind !== "write" || !event.name) return;
    const item = document.createElement("li"), time = document.createElement("small");
    time.textContent = `${(event.tick * tickS).toFixed(2)} s `;
    item.append(time, `${event.name} = ${typeof event.value === "number" ? number(event.value) : event.value}, client ${event.client}${event.done ? "" : ": refused"}`);
    $("changes").prepend(item);
    while ($("changes").children.length > 200) $("changes").lastChild.remove();
    if (isOld || !event.done) return;
    if (event.name === "commands.desired_apex_speed") $("speed-verdict").textContent = "The speed has not settled yet.";
    const one = this.settings?.get(event.name); // another tool's change is seen, too
    if (one && typeof event.value === "number" && one.value === undefined) one.value = event.value;
  }

  message(told) {
    if (told.type === "values") {
      for (const [name, value] of Object.entries(told.values)) if (this.settings?.has(name)) this.settings.get(name).value = value;
      for (const [name, [low, high]] of Object.entries(told.bus || {})) {
        const one = this.settings?.get(name);
        if (one) one.help.textContent = `${one.meaning}; this walker bears ${low === null ? "at most" : `${number(low)} to`} ${number(high)}`;
      }
      if (this.settings) this.show();
    } else if (told.type === "written") {
      this.say(`${told.name}: ${number(told.before)} → ${number(told.value)} ${told.unit || ""}, read back ${number(told.read)}${told.note ? `. ${told.note}` : ""}`);
    } else if (told.type === "undo") {
      $("undo").disabled = !told.name;
      $("undo").textContent = told.name ? `Undo ${told.name.split(".").pop()}: back to ${number(told.value)}` : "Undo the last change";
    } else if (told.type === "request") {
      $("request-outcome").textContent = `${told.what}: ${told.text}`;
    } else if (told.type === "verdict") {
      $("speed-verdict").textContent = told.text;
    } else if (told.type === "counters") {
      $("counters").replaceChildren(...Object.entries(told.values).flatMap(([name, value]) => {
        const dt = document.createElement("dt"), dd = document.createElement("dd");
        dt.textContent = name;
        dd.textContent = value;
        return [dt, dd];
      }));
    } else if (told.type === "refused") {
      if (["write", "undo"].includes(told.do)) this.say(told.text, true);
      else if (told.do === "request") $("request-outcome").textContent = told.text;
    }
  }
}
