// The steps of commissioning: the server runs them, and tells what was found and what a person's hands have to do.
const $ = (id) => document.getElementById(id);

export class Setup {
  constructor(ask, openPage) {
    this.ask = ask;
    $("setup-stand").onchange = () => this.show();
    $("setup-interrupt").onclick = () => this.deed("interrupt");
    $("setup-yes").onclick = () => this.deed("answer", { yes: true });
    $("setup-no").onclick = () => this.deed("answer", { yes: false });
    $("setup-page").onclick = () => openPage("/commissioning");
  }

  deed(deed, more = {}) {
    $("setup-outcome").textContent = "";
    this.ask({ do: "commission", deed, ...more });
  }

  hello(told) {
    $("setup").hidden = $("setup-link").hidden = !told.commissioning;
    if (told.commissioning) this.take(told.commissioning);
  }

  message(told) {
    if (told.type === "commissioning") this.take(told);
    else if (told.type === "refused" && told.do === "commission") $("setup-outcome").textContent = told.text;
  }

  take(told) {
    this.told = told;
    $("setup-why").textContent = told.why || told.trouble || "";
    $("setup-all").hidden = Boolean(told.why || told.trouble);
    this.show();
  }

  show() {
    const told = this.told;
    if (!told) return;
    $("setup-now").hidden = !told.running;
    $("setup-step").textContent = told.running || "";
    $("setup-words").textContent = told.words;
    $("setup-question").textContent = told.question;
    $("setup-answers").hidden = !told.question;
    $("setup-page").disabled = !told.has_page;
    $("setup-folder").textContent = told.has_page ? `Results, device file and page are in ${told.folder}.` : "";
    $("setup-lines").replaceChildren(...told.lines.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
    const focused = document.activeElement?.id;
    $("setup-steps").replaceChildren(...told.steps.map((step) => this.row(step)));
    if (focused?.startsWith("setup-")) $(focused)?.focus();
  }

  row(step) {
    const item = document.createElement("li"), name = document.createElement("b"), verdict = document.createElement("span");
    const line = (text, kind) => item.append(Object.assign(document.createElement(kind === "found" ? "div" : "small"),
      { textContent: text, className: kind }));
    name.textContent = step.name;
    verdict.textContent = step.verdict;
    verdict.className = `verdict ${step.verdict.split(" ")[0]}`;
    item.append(name, " ", verdict, " ", this.button(step, "run", step.verdict === "not done" ? "Run" : "Run again"), " ",
      this.button(step, "skip", "Skip"));
    line(step.shows, "shows");
    if (step.comes_first) line(`first: ${step.comes_first}`, "first");
    if (step.done) line(step.done, "done");
    for (const found of step.found) line(`Found: ${found}`, "found");
    if (step.reason) line(step.reason, "reason");
    return item;
  }

  button(step, deed, text) {
    const button = document.createElement("button");
    button.id = `setup-${deed}-${step.name}`;
    button.textContent = text;
    button.setAttribute("aria-label", `${text} ${step.name}`);
    button.disabled = Boolean(this.told.running) || (deed === "run" && (!$("setup-stand").checked || Boolean(step.comes_first)));
    button.onclick = () => this.deed(deed, { step: step.name, in_stand: $("setup-stand").checked, reason: $("setup-reason").value });
    return button;
  }
}
