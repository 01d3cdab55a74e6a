import { arrange, element, setText } from "../element.js";
import { fixed, readNumber } from "../quantity.js";
import { CommitBox } from "../parameters/commit_box.js";
import { rest } from "../session/rest.js";
import { anchorChoices } from "./anchors.js";
import { LIVE } from "./overlays.js";
import { nameOf } from "./words.js";

const OFFERED = 100;

/** Which recordings lie over the open one, where they are aligned, and how their tunings differ. */
export class OverlayPanel {
  #lines = new Map();

  constructor(comparison) {
    this.comparison = comparison;
    this.add = element("select", {
      "aria-label": "Lay another recording over this one",
      pointerenter: () => this.offer(),
      change: () => this.#add(),
    });
    this.align = element("select", { "aria-label": "Align at", change: () => comparison.align(this.align.value) });
    this.alignRow = element("div", { class: "form-row", hidden: true }, element("span", { class: "form-name" }, "align at"), this.align);
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.list = element("ol", { class: "overlay-list" });
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "Compare" },
      element("h2", {}, "Compare"),
      element("div", { class: "form-row" }, this.add),
      this.alignRow,
      this.list,
      this.problem,
    );
    comparison.addEventListener("change", () => this.#show());
    this.#fill([]);
  }

  /** Offer what there is now. */
  async offer() {
    try {
      const { recordings } = await rest("GET", `/api/recordings?limit=${OFFERED}`);
      this.#fill(recordings);
    } catch (refusal) {
      this.say(refusal.message);
    }
  }

  #fill(recordings) {
    const { facts } = this.comparison;
    const others = recordings.filter(({ id }) => id !== facts?.id);
    const ids = others.map(({ id }) => id).join();
    if (ids === this.offered) return;
    this.offered = ids;
    this.add.replaceChildren(
      new Option("Lay over this…", ""),
      new Option("live: what runs now", LIVE),
      ...others.map((each) => new Option(nameOf(each), each.id)),
    );
    this.add.value = "";
  }

  async #add() {
    const id = this.add.value;
    this.add.value = "";
    if (!id) return;
    this.say("");
    await this.comparison.add(id).catch((refusal) => this.say(refusal.message));
  }

  #show() {
    const { overlays, facts, anchor } = this.comparison;
    this.alignRow.hidden = overlays.length === 0;
    if (facts && this.shown !== facts) {
      this.align.replaceChildren(...anchorChoices(facts).map(({ value, text }) => new Option(text, value)));
      this.offer();
    }
    this.shown = facts;
    this.align.value = anchor;
    for (const overlay of overlays) {
      if (!this.#lines.has(overlay.key)) this.#lines.set(overlay.key, new OverlayLine(this.comparison, overlay.key));
      this.#lines.get(overlay.key).show(overlay);
    }
    arrange(this.list, overlays.map(({ key }) => this.#lines.get(key).root));
  }

  /** Say why something could not be laid over it. */
  say(text) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }
}

class OverlayLine {
  constructor(comparison, id) {
    this.number = element("span", { class: "overlay-number" });
    this.swatch = swatch();
    this.name = element("span", { class: "overlay-name" });
    this.box = new CommitBox("Shift by hand, s", (text) => {
      const seconds = readNumber(text);
      this.box.refused(Number.isNaN(seconds));
      if (!Number.isNaN(seconds)) comparison.move(id, seconds);
    });
    this.box.root.classList.add("number");
    this.words = element("p", { class: "overlay-words" });
    const remove = element("button", { type: "button", class: "quiet", "aria-label": "Take it away", title: "Take it away", click: () => comparison.remove(id) }, "✕");
    this.root = element(
      "li",
      {},
      element("div", { class: "form-row" }, this.swatch, this.number, this.name, remove),
      element("div", { class: "form-row" }, element("span", { class: "form-name" }, "by hand"), this.box.root, element("span", { class: "form-unit" }, "s")),
      this.words,
    );
  }

  show(overlay) {
    setText(this.number, overlay.label);
    setText(this.name, overlay.name);
    this.name.title = `${overlay.name}, moved by ${fixed(overlay.shift, 3)} s`;
    this.box.show(String(overlay.byHand));
    showDash(this.swatch, overlay.dash);
    setText(this.words, [overlay.problem, overlay.difference?.join("; ") ?? "Its tuning is being compared."].filter(Boolean).join(" "));
  }
}

/** A short line that shows how a run's lines are dashed. */
export function swatch() {
  const box = element("span", { class: "dash-swatch" });
  box.innerHTML = '<svg width="26" height="6" aria-hidden="true"><line x1="0" y1="3" x2="26" y2="3"/></svg>';
  return box;
}

export function showDash(box, dash) {
  box.querySelector("line").setAttribute("stroke-dasharray", dash.join(" "));
}
