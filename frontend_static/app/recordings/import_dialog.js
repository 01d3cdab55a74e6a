import { element, setText } from "../element.js";
import { compact, inputText, readNumber } from "../quantity.js";
import { Refusal } from "../session/refusal.js";

const BY_UNIT = "unit";
const FACTORS = [
  ["as it is", 1],
  ["° → rad", Math.PI / 180],
  ["mrad → rad", 1e-3],
  ["ms → s", 1e-3],
  ["turns → rad", 2 * Math.PI],
  ["mN·m → N·m", 1e-3],
];
const TIME_LIMIT_MS = 120_000;

/** Reads a CSV file as a recording: first what would be read, where headings can be told what they mean. */
export class ImportDialog {
  #text = "";
  #columns = {};

  /** @param {object} session that knows the channels @param {(recording: object) => void} imported */
  constructor(session, imported) {
    this.session = session;
    this.imported = imported;
    this.file = element("input", { type: "file", accept: ".csv,text/csv,text/plain", hidden: true, "aria-label": "CSV file", change: () => this.#read() });
    this.name = element("input", { type: "text", "aria-label": "Name of the recording", autocomplete: "off" });
    this.summary = element("p", { role: "status" });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.body = element("tbody");
    this.save = element("button", { type: "button", click: () => this.#import() }, "Import");
    this.dialog = element(
      "dialog",
      { class: "import-dialog", "aria-labelledby": "import-title" },
      element("h2", { id: "import-title" }, "Import a recording"),
      element("div", { class: "form-row" }, element("span", { class: "form-name" }, "name"), this.name),
      this.summary,
      element(
        "div",
        { class: "import-columns" },
        element("table", {}, element("thead", {}, element("tr", {}, ...["Heading", "Is", "Factor"].map((text) => element("th", { scope: "col" }, text)))), this.body),
      ),
      this.problem,
      element("menu", {}, element("button", { type: "button", click: () => this.dialog.close() }, "Cancel"), this.save),
    );
    document.body.append(this.dialog, this.file);
  }

  choose() {
    this.file.value = "";
    this.file.click();
  }

  async #read() {
    const [file] = this.file.files;
    if (!file) return;
    this.#text = await file.text();
    this.#columns = {};
    this.name.value = file.name.replace(/\.[^.]*$/, "");
    this.body.replaceChildren();
    this.dialog.show();
    await this.#preview();
  }

  async #preview() {
    this.save.disabled = true;
    try {
      const preview = await this.#send(true);
      this.#show(preview);
      this.save.disabled = false;
      this.#say("");
    } catch (refusal) {
      if (!this.body.childElementCount) this.#show({ columns: [], ignored: this.#ownHeadings() });
      this.#say(refusal.message);
    }
  }

  async #import() {
    this.save.disabled = true;
    try {
      const recording = await this.#send(false);
      this.dialog.close();
      this.imported(recording);
    } catch (refusal) {
      this.#say(refusal.message);
      this.save.disabled = false;
    }
  }

  async #send(isDryRun) {
    const query = new URLSearchParams({ name: this.name.value.trim() });
    if (isDryRun) query.set("dry_run", "true");
    if (Object.keys(this.#columns).length) query.set("columns", JSON.stringify(this.#columns));
    const response = await fetch(`/api/recordings/import?${query}`, {
      method: "POST",
      headers: { "content-type": "text/csv" },
      body: this.#text,
      signal: AbortSignal.timeout(TIME_LIMIT_MS),
    }).catch(() => null);
    const answer = await response?.json().catch(() => null);
    if (!response?.ok) throw new Refusal(answer ?? { detail: "The server did not take the file." });
    return answer;
  }

  #ownHeadings() {
    const [first] = this.#text.split(/\r?\n/, 1);
    return first.split(/[,;\t]/).map((heading) => heading.trim().replace(/^"(.*)"$/, "$1"));
  }

  #show(preview) {
    setText(this.summary, preview.rows === undefined ? "" : spanWords(preview));
    if (this.body.childElementCount) return;
    const left = preview.ignored.map((heading) => ({ heading, channel: null, factor: null }));
    this.body.replaceChildren(...[...preview.columns, ...left].map((column) => this.#line(column)));
  }

  #line({ heading, channel, factor: found }) {
    const is = element("select", { "aria-label": `${heading} is` }, new Option("leave out", ""), new Option("time [s]", "time"));
    const channels = [...this.session.channels.values()].filter(({ name }) => name !== "time");
    is.append(...channels.map(({ name, label, unit }) => new Option(`${label}${unit ? ` [${unit}]` : ""}`, name)));
    is.value = channel ?? "";
    const by = element("select", { "aria-label": `factor of ${heading}` }, new Option("by its unit", BY_UNIT), ...FACTORS.map(([text, value]) => new Option(text, value)), new Option("other…", "other"));
    const own = element("input", { type: "text", class: "number", "aria-label": `other factor of ${heading}`, hidden: true, value: "1" });
    const known = FACTORS.find(([, value]) => Math.abs(value - found) <= 1e-9 * value);
    by.value = found === null ? BY_UNIT : known ? String(known[1]) : "other";
    own.hidden = by.value !== "other";
    own.value = inputText(found ?? 1);
    const change = () => {
      own.hidden = by.value !== "other";
      const value = by.value === "other" ? readNumber(own.value) : Number(by.value);
      const factor = by.value === BY_UNIT ? {} : { factor: value };
      this.#columns[heading] = is.value ? { channel: is.value, ...factor } : { channel: null };
      this.#preview();
    };
    for (const control of [is, by, own]) control.addEventListener("change", change);
    return element("tr", {}, element("th", { scope: "row" }, heading), element("td", {}, is), element("td", {}, by, own));
  }

  #say(text) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }
}

function spanWords({ rows, from_s, to_s, period_s, even, derived }) {
  const apart = `${compact(1e3 * period_s)} ms apart${even ? "" : ", not evenly"}`;
  const more = derived.length ? ` ${derived.join(", ")} is computed.` : "";
  return `${rows} samples from ${compact(from_s)} to ${compact(to_s)} s, ${apart}.${more}`;
}
