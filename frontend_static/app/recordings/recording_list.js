import { arrange, element, setText } from "../element.js";
import { rest } from "../session/rest.js";
import { AskDialog } from "./ask_dialog.js";
import { ImportDialog } from "./import_dialog.js";
import { RecordingRow } from "./recording_row.js";
import { addressOf } from "./samples.js";
import { counted, durationWords, nameOf, sizeWords } from "./words.js";

const PAGE = 50;
const MOST = 500; // that the server lists at once
const NEWEST = 3; // looked at again and again: one may be under way
const LOOK_AGAIN_MS = 3000;
const TYPING_MS = 250;
const HEADINGS = ["", "Link", "Error", "Recording", "Started", "Length", "Peak error", "RMS error", "Peak torque", "Events", "Tags and note"];
const EMPTY = {
  none: "No recordings yet. Every run of the session is recorded: press ▶ above, or import a CSV file.",
  off: "Recording is switched off (VSSEA_RECORDING): switch it on and start again, or import a CSV file.",
  found: "No recording fits this search. Shorten it, or take the filters away.",
};

/** All recordings, newest first. */
export class RecordingList {
  #rows = new Map();
  #order = [];
  #timer = null;
  #typing = null;
  #asked = 0;

  /** @param {object} session @param {(id: string, overlays: string[]) => void} open */
  constructor(session, open) {
    this.open = (id) => open(id, [...this.chosen].filter((other) => other !== id));
    this.chosen = new Set();
    this.ask = new AskDialog();
    this.importing = new ImportDialog(session, (recording) => this.open(recording.id));
    session.addEventListener("recordings", () => this.root.hidden || this.load());
    this.search = element("input", { type: "search", "aria-label": "Search", placeholder: "Search names, notes, tags, scenarios", input: () => this.#typed() });
    this.starred = element("button", { type: "button", class: "chip", "aria-pressed": "false", click: () => this.#toggleStarred() }, "★ starred");
    this.origin = element(
      "select",
      { "aria-label": "Origin", change: () => this.load() },
      ...[["all origins", ""], ["live", "live"], ["imported", "import"], ["simulated", "simulation"]].map(([text, value]) => new Option(text, value)),
    );
    this.compare = element("button", { type: "button", hidden: true, click: () => this.#compare() });
    this.disk = element("span", { class: "disk-words" });
    this.meter = element("meter", { min: 0, max: 1, "aria-label": "Share of the disk quota used" });
    this.recorder = element("p", { class: "recorder-words", role: "status" });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.body = element("tbody", { keydown: (event) => this.#key(event), focusin: (event) => this.#focused(event.target.closest("tr")) });
    this.table = element(
      "table",
      { class: "recordings", "aria-label": "Recordings" },
      element("thead", {}, element("tr", {}, ...HEADINGS.map((text) => element(text ? "th" : "td", text ? { scope: "col" } : {}, text)))),
      this.body,
    );
    this.empty = element("p", { class: "empty", hidden: true });
    this.more = element("button", { type: "button", class: "more", hidden: true, click: () => this.#more() }, "Load more");
    this.root = element(
      "div",
      { class: "recording-list" },
      element("div", { class: "recordings-head", role: "search" }, this.search, this.starred, this.origin, this.compare, element("button", { type: "button", click: () => this.importing.choose() }, "Import CSV…"), this.recorder, element("span", { class: "disk" }, this.disk, this.meter)),
      this.problem,
      element("div", { class: "list-scroll", tabindex: "-1" }, this.table, this.empty, this.more),
    );
  }

  /** Look again and again while the list is shown. */
  set isShown(isShown) {
    this.root.hidden = !isShown;
    clearTimeout(this.#timer);
    if (isShown) this.load();
  }

  /** Read the first page anew. */
  async load() {
    clearTimeout(this.#timer);
    const asked = (this.#asked += 1);
    const answer = await this.#get({ limit: Math.min(MOST, Math.max(PAGE, this.#order.length)) });
    if (asked !== this.#asked) return;
    if (answer) this.#show(answer);
    this.#timer = setTimeout(() => this.#watch(), LOOK_AGAIN_MS);
  }

  /** Space in the list chooses the row that has the focus. @returns {boolean} whether there is one */
  chooseFocused() {
    const row = document.activeElement?.closest?.(".recordings tbody tr");
    const own = row && this.#rows.get(row.dataset.id);
    if (own) this.#choose(own.recording, !this.chosen.has(own.recording.id));
    return Boolean(own);
  }

  async #watch() {
    if (this.root.hidden) return;
    const asked = this.#asked;
    const answer = await this.#get({ limit: NEWEST });
    if (this.root.hidden || asked !== this.#asked) return;
    const fresh = answer?.recordings ?? [];
    const ids = fresh.map(({ id }) => id);
    for (const recording of fresh) this.#take(recording);
    if (answer) this.#arrange([...ids, ...this.#order.filter((id) => !ids.includes(id))]);
    this.#timer = setTimeout(() => this.#watch(), LOOK_AGAIN_MS);
  }

  async #more() {
    const answer = await this.#get({ limit: PAGE, before: this.#order.at(-1) });
    if (!answer) return;
    for (const recording of answer.recordings) this.#take(recording);
    this.#arrange([...this.#order, ...answer.recordings.map(({ id }) => id)]);
    this.more.hidden = !answer.more;
  }

  async #get(query) {
    const filters = { search: this.search.value.trim(), starred: this.#isStarred ? "true" : "", origin: this.origin.value };
    const given = Object.entries({ ...filters, ...query }).filter(([, value]) => value);
    try {
      const answer = await rest("GET", `/api/recordings?${new URLSearchParams(given)}`);
      this.#say(answer.trouble ?? "");
      this.#tellDisk(answer);
      return answer;
    } catch (refusal) {
      this.#say(refusal.message);
      return null;
    }
  }

  get #isStarred() {
    return this.starred.getAttribute("aria-pressed") === "true";
  }

  #show({ recordings, more }) {
    for (const recording of recordings) this.#take(recording);
    this.#arrange(recordings.map(({ id }) => id));
    this.more.hidden = !more;
  }

  #take(recording) {
    const known = this.#rows.get(recording.id);
    if (known) known.show(recording);
    else this.#rows.set(recording.id, this.#row(recording));
  }

  #row(recording) {
    return new RecordingRow(recording, {
      open: ({ id }) => this.open(id),
      choose: (which, isChosen) => this.#choose(which, isChosen),
      star: ({ id, starred }) => this.#change(id, { starred: !starred }),
      rename: (which) => this.#rename(which),
      note: (which) => this.#note(which),
      remove: (which) => this.#remove(which),
    });
  }

  #arrange(ids) {
    this.#order = ids;
    const rows = ids.map((id) => this.#rows.get(id));
    arrange(this.body, rows.map(({ root }) => root));
    const reachable = rows.find(({ root }) => root.tabIndex === 0) ?? rows[0];
    for (const row of rows) row.isReachable = row === reachable;
    const isFiltered = this.search.value.trim() || this.#isStarred || this.origin.value;
    this.empty.hidden = rows.length > 0;
    this.table.hidden = rows.length === 0;
    setText(this.empty, isFiltered ? EMPTY.found : this.recorderState === "off" ? EMPTY.off : EMPTY.none);
  }

  #tellDisk({ disk, recorder }) {
    this.recorderState = recorder?.state;
    setText(this.recorder, recorder?.sentence ?? "");
    this.recorder.classList.toggle("is-warning", recorder?.state === "stopped" || recorder?.lost > 0);
    if (!disk) return;
    setText(this.disk, `${sizeWords(disk.used_bytes)} of ${sizeWords(disk.quota_bytes)}, ${sizeWords(disk.free_bytes)} free`);
    this.meter.value = disk.quota_bytes ? disk.used_bytes / disk.quota_bytes : 0;
  }

  #choose({ id }, isChosen) {
    if (isChosen) this.chosen.add(id);
    else this.chosen.delete(id);
    this.#rows.get(id).isChosen = isChosen;
    this.compare.hidden = this.chosen.size < 2;
    setText(this.compare, `Compare ${this.chosen.size}`);
  }

  #compare() {
    const newest = this.#order.find((id) => this.chosen.has(id)) ?? [...this.chosen][0];
    this.open(newest);
  }

  async #rename(recording) {
    const name = await this.ask.line("Rename the recording", recording.name, "Rename");
    if (name !== null) this.#change(recording.id, { name: name.trim() });
  }

  async #note(recording) {
    const note = await this.ask.note(`Note on ${nameOf(recording)}`, recording.note, "Save");
    if (note !== null) this.#change(recording.id, { note });
  }

  async #remove(recording) {
    const text = `${contents(recording)} It cannot be brought back.`;
    if (!(await this.ask.sure(`Delete ${nameOf(recording)}?`, text, "Delete"))) return;
    try {
      await rest("DELETE", addressOf(recording.id));
      this.#choose(recording, false);
      this.#say("");
      await this.load();
    } catch (refusal) {
      this.#say(refusal.message);
    }
  }

  async #change(id, changes) {
    try {
      await rest("PATCH", addressOf(id), changes);
      this.#say("");
    } catch (refusal) {
      this.#say(refusal.message);
    }
    await this.load();
  }

  #toggleStarred() {
    this.starred.setAttribute("aria-pressed", String(!this.#isStarred));
    this.load();
  }

  #typed() {
    clearTimeout(this.#typing);
    this.#typing = setTimeout(() => this.load(), TYPING_MS);
  }

  #focused(row) {
    for (const id of this.#order) this.#rows.get(id).isReachable = this.#rows.get(id).root === row;
  }

  #key(event) {
    if (event.target.tagName !== "TR") return;
    const rows = this.#order.map((id) => this.#rows.get(id).root);
    const at = rows.indexOf(event.target);
    const to = { ArrowUp: at - 1, ArrowDown: at + 1, Home: 0, End: rows.length - 1, PageDown: at + 10, PageUp: at - 10 }[event.key];
    if (event.key === "Enter") this.open(event.target.dataset.id);
    else if (to === undefined) return;
    else rows[Math.max(0, Math.min(rows.length - 1, to))].focus();
    event.preventDefault();
  }

  #say(text) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }
}

function contents({ duration_s, size_bytes, events }) {
  return `${durationWords(duration_s)} of samples (${sizeWords(size_bytes)}), ${counted(events, "event")}.`;
}
