// Trials: recorded by the server, reported, exported, compared.
const $ = (id) => document.getElementById(id);

export class Keep {
  constructor(ask, fetch) {
    Object.assign(this, { ask, fetch, recording: false, chosen: new Set() });
    $("record").onclick = () => this.toggle();
    $("compare").onclick = () => this.open(`/compare?a=${encodeURIComponent([...this.chosen][0])}&b=${encodeURIComponent([...this.chosen][1])}`);
  }

  hello(told) {
    this.isLive = told.mode === "live";
    $("record").disabled = !this.isLive || told.trials === undefined;
    this.list(told.trials || []);
    this.state(told.recorder);
  }

  toggle() {
    if (!this.isLive) return;
    this.ask({ do: "record", on: !this.recording, subject: $("subject-code").value, note: $("trial-note").value });
  }

  state(recorder) {
    this.recording = Boolean(recorder);
    $("record").setAttribute("aria-pressed", String(this.recording));
    $("record").textContent = this.recording ? "End the recording" : "Record";
    $("record-state").textContent = recorder ? `Recording into ${recorder.folder}${recorder.note ? `. ${recorder.note}` : ""}` : "";
  }

  list(trials) {
    $("trials").tBodies[0].replaceChildren(...trials.map((trial) => this.row(trial)));
  }

  row(trial) {
    const row = document.createElement("tr");
    const cells = Array.from({ length: 4 }, () => row.insertCell());
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = this.chosen.has(trial.name);
    box.setAttribute("aria-label", `Compare ${trial.name}`);
    box.onchange = () => {
      this.chosen[box.checked ? "add" : "delete"](trial.name);
      $("compare").disabled = this.chosen.size !== 2;
    };
    cells[0].append(box);
    cells[1].textContent = trial.name;
    cells[2].textContent = trial.seconds === null ? "–" : `${trial.seconds.toFixed(1)} s`;
    if (!trial.complete) {
      cells[2].append(" incomplete");
      cells[2].className = "incomplete";
    }
    const name = encodeURIComponent(trial.name);
    const report = document.createElement("button");
    report.textContent = "Report";
    report.setAttribute("aria-label", `Report of ${trial.name}`);
    report.onclick = () => this.open(`/report?trial=${name}`);
    cells[3].append(report);
    for (const kind of ["csv", "parquet", "mcap"]) {
      const button = document.createElement("button");
      button.textContent = kind;
      button.setAttribute("aria-label", `Export ${trial.name} as ${kind}`);
      button.onclick = async () => {
        await this.save(`/export?trial=${name}&kind=${kind}`, `${trial.name}.${kind}`);
        if (kind === "csv") { await this.save(`/export?trial=${name}&kind=json`, `${trial.name}.csv.json`); } // what it is of
      };
      cells[3].append(" ", button);
    }
    return row;
  }

  // A report in a dialogue of this page: an image of a document, without scripts.
  async open(path) {
    $("keep-outcome").textContent = "is being made …";
    try {
      const html = await this.fetch(path, "text");
      const dialog = document.createElement("dialog"), close = document.createElement("button"), body = document.createElement("div");
      const parsed = new DOMParser().parseFromString(html, "text/html");
      const link = document.createElement("a");
      close.textContent = "Close";
      close.onclick = () => dialog.close();
      dialog.onclose = () => dialog.remove();
      link.href = URL.createObjectURL(new Blob([html], { type: "text/html" }));
      link.download = "report.html";
      link.textContent = "Save as a file";
      body.className = "report";
      body.append(...parsed.body.childNodes);
      dialog.append(close, " ", link, body);
      document.body.append(dialog);
      dialog.showModal();
      $("keep-outcome").textContent = "";
    } catch (error) { $("keep-outcome").textContent = error.message; }
  }

  async save(path, name) {
    $("keep-outcome").textContent = `${name} is being made …`;
    try {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(await this.fetch(path));
      link.download = name;
      link.click();
      $("keep-outcome").textContent = `${name} is saved where this browser saves files.`;
    } catch (error) { $("keep-outcome").textContent = error.message; }
  }

  event() {}

  message(told) {
    if (told.type === "recorder") this.state(told.recorder);
    else if (told.type === "trials") this.list(told.trials);
    else if (told.type === "refused" && ["record", "mark"].includes(told.do)) $("keep-outcome").textContent = told.text;
  }
}
